"""From findings to problems: the file, line and column of each, with names as the file itself writes them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from urllib.parse import urlsplit

from pyoxigraph import BlankNode, Literal, NamedNode

import ontology
from onto_compiler.check.blanks import same_blanks
from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.problems import Problem, Span, near
from onto_compiler.rdf import RDF, shorten
from onto_compiler.sources import graph_of
from onto_compiler.terms import Term, show
from onto_compiler.turtle.source_map import Located, SourceMap, map_text

__all__ = ["locate"]

_TYPE = NamedNode(RDF + "type")
_COMPARISONS = 200_000  # of misspelt names with declared ones: a second or two
_SLOT = re.compile(r"\{(\w+)\}")


def locate(model: Model, findings: Iterable[Finding]) -> tuple[Problem, ...]:
    """The problems of the reported files, in file order; findings that lie in the background are left out."""
    places: dict[Path, _Places] = {}
    found: set[Problem] = set()
    specific: set[tuple[Path, Term | None, Term | None, Term | None]] = set()
    waiting = []
    for finding in findings:
        for path in _paths(model, finding):
            key = (path, finding.subject, finding.predicate, finding.object)
            waiting.append((key, finding))
            if not finding.general:
                specific.add(key)
    for key, finding in waiting:
        path = key[0]
        if not (finding.general and key in specific):
            if path not in places:
                places[path] = _Places(model, path)
            found.add(places[path].problem(finding))
    return tuple(sorted(found))


def _paths(model: Model, finding: Finding) -> Iterator[Path]:
    """The reported files that hold the triple, or else its subject where the triple stands nowhere."""
    if finding.subject is None:
        if finding.graph is not None and finding.graph in model.graphs:
            yield model.graphs[finding.graph]
        return
    graphs = [finding.graph] if finding.graph is not None else list(model.graphs)
    for predicate, object_, _ in _narrowings(finding):
        everywhere = model.store.quads_for_pattern(finding.subject, predicate, object_, None)  # type: ignore[arg-type]
        holders = {quad.graph_name for quad in everywhere}
        if holders:
            yield from (model.graphs[graph] for graph in graphs if graph in holders and graph in model.graphs)
            return


def _narrowings(finding: Finding) -> Iterator[tuple[Term | None, Term | None, str]]:
    """Predicate, object and the part to point at, from the narrowest place to the widest."""
    if finding.object is not None:
        yield finding.predicate, finding.object, "object"
    if finding.predicate is not None:
        yield finding.predicate, None, "predicate"
    yield _TYPE, None, "subject"  # where a term is declared rather than mentioned
    yield None, None, "subject"


@dataclass
class _Places:
    """Where the findings of one file stand, and how its terms are written."""

    model: Model
    path: Path
    _meant: dict[str, str] = field(default_factory=dict)
    _compared: int = 0

    @cached_property
    def map(self) -> SourceMap:
        return map_text(self.model.text(self.path), str(self.path), self.path.as_uri())

    @cached_property
    def blanks(self) -> dict[BlankNode, BlankNode]:
        """The blank nodes of the store as the source map names them."""
        graph = graph_of(self.path)
        return same_blanks((quad for quad in self.model.written if quad.graph_name == graph), self.map.triples)

    @cached_property
    def declared(self) -> dict[str, list[str]]:
        """Every name that has a type, as this file writes it, by its local part in lower case."""
        rows = self.model.rows("SELECT DISTINCT ?term WHERE { ?term a ?any FILTER isIRI(?term) }")
        found: dict[str, list[str]] = {}
        for name in sorted({_shown(row["term"], self.map) for row in rows}):
            found.setdefault(name.partition(":")[2].lower(), []).append(name)
        return found

    @cached_property
    def beside(self) -> dict[str, list[str]]:
        """The local parts of those names, by their prefix."""
        found: dict[str, list[str]] = {}
        for name in sorted(name for names in self.declared.values() for name in names):
            prefix, _, local = name.partition(":")
            found.setdefault(prefix, []).append(local)
        return found

    def problem(self, finding: Finding) -> Problem:
        """The finding as a problem of this file."""
        names = {name: _shown(value, self.map) for name, value in finding.values.items()}
        for name in ("subject", "predicate", "object"):
            names.setdefault(name, _shown(getattr(finding, name) or "", self.map))

        def fill(template: str) -> str:
            return _SLOT.sub(lambda match: names.get(match[1], ""), template)

        hint = fill(finding.hint)
        if finding.near:
            meant = self.meant(names.get(finding.near, ""))
            hint = f"{meant} Otherwise: {hint}" if meant else hint
        found = Problem.at(self.span(finding), finding.code, fill(finding.message), hint, finding.severity)
        return found if finding.result is None else replace(found, result=finding.result)

    def meant(self, own: str) -> str:
        """What ``own``, which nothing declares, may be meant for; nothing any more after very many comparisons."""
        if own not in self._meant:
            prefix, _, local = own.partition(":")
            same = [name for name in self.declared.get(local.lower(), ()) if name != own]
            if same:
                self._meant[own] = f"did you mean `{same[0]}`?"
            elif self._compared <= _COMPARISONS:
                beside = self.beside.get(prefix, [])
                self._compared += len(beside)
                similar = near(local, [name for name in beside if name != local])
                self._meant[own] = similar.replace("`", f"`{prefix}:", 1)
        return self._meant.get(own, "")

    def span(self, finding: Finding) -> Span:
        """The narrowest place that the finding has in this file."""
        if finding.subject is not None:
            for predicate, object_, part in _narrowings(finding):
                triples = self.map.find(self._own(finding.subject), predicate, self._own(object_))
                if triples:
                    return self._part(finding, triples, part)
        return Span(str(self.path))

    def _own(self, term: Term | None) -> Term | None:
        return self.blanks.get(term, term) if isinstance(term, BlankNode) else term

    def _part(self, finding: Finding, triples: list[Located], part: str) -> Span:
        if part != "object":
            return self.map.span(triples[-1].at_predicate if part == "predicate" else triples[0].at_subject)
        token = triples[0].at_object
        if finding.inside is not None and token.kind == "string":
            return self.map.inside(token, *finding.inside)
        return self.map.span(token)


def _shown(value: Term | str, source_map: SourceMap) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, NamedNode):
        if value.value.startswith("file:") and (path := _path_of(value)).is_file():
            return _named(path)
        for prefix in source_map.declared:
            if value.value.startswith(prefix.namespace) and len(value.value) > len(prefix.namespace):
                return f"{prefix.name}:{value.value[len(prefix.namespace) :]}"
        return shorten(value.value)
    return value.value if isinstance(value, Literal) else show(value, _declared_in(source_map))


def _declared_in(source_map: SourceMap) -> Iterator[tuple[str, str]]:
    return ((prefix.name, prefix.namespace) for prefix in source_map.declared)


def _path_of(graph: NamedNode) -> Path:
    """The file whose triples a graph holds."""
    from urllib.request import url2pathname  # noqa: PLC0415 - slow to import, and few problems name another file

    return Path(url2pathname(urlsplit(graph.value).path))


def _named(path: Path) -> str:
    """The display name of a file: a shipped one by its name, another relative to the current folder."""
    shipped = Path(ontology.__file__).parent
    for above in (shipped, Path.cwd()):
        if path.is_relative_to(above):
            return path.relative_to(above).as_posix()
    return str(path)
