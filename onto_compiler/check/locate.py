"""From findings to problems: the file, line and column of each, with names as the file itself writes them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import cast
from urllib.parse import urlsplit

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Store

import ontology
from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.problems import Problem, Span, near
from onto_compiler.rdf import RDF, shorten
from onto_compiler.sources import graph_of
from onto_compiler.terms import Term, show
from onto_compiler.turtle.source_map import Located, SourceMap, canonical, map_text

__all__ = ["locate"]

_TYPE = NamedNode(RDF + "type")
_SLOT = re.compile(r"\{(\w+)\}")


def locate(model: Model, findings: Iterable[Finding]) -> tuple[Problem, ...]:
    """The problems of the reported files, in file order; findings that lie in the background are left out."""
    maps: dict[Path, SourceMap] = {}
    placed: dict[tuple[Problem, bool], Finding] = {}
    specific: set[tuple[Path, Term | None, Term | None, Term | None]] = set()
    waiting = []
    for finding in findings:
        for path in _paths(model, finding):
            if path not in maps:
                maps[path] = map_text(model.text(path), str(path), path.as_uri())
            key = (path, finding.subject, finding.predicate, finding.object)
            waiting.append((key, finding, maps[path]))
            if not finding.general:
                specific.add(key)
    for key, finding, source_map in waiting:
        if not (finding.general and key in specific):
            placed.setdefault((_problem(model, finding, source_map), finding.general), finding)
    return tuple(sorted({problem for problem, _ in placed}))


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


def _problem(model: Model, finding: Finding, source_map: SourceMap) -> Problem:
    span = _span(model, finding, source_map)
    names = {name: _shown(value, source_map) for name, value in finding.values.items()}
    for name in ("subject", "predicate", "object"):
        names.setdefault(name, _shown(getattr(finding, name) or "", source_map))

    def fill(template: str) -> str:
        return _SLOT.sub(lambda match: names.get(match[1], ""), template)

    hint = fill(finding.hint)
    if finding.near:
        own = names.get(finding.near, "")
        meant = _meant(own, sorted(_declared(model, source_map) - {own}))
        hint = f"{meant} Otherwise: {hint}" if meant else hint
    found = Problem.at(span, finding.code, fill(finding.message), hint, finding.severity)
    return found if finding.result is None else replace(found, result=finding.result)


def _meant(own: str, declared: list[str]) -> str:
    """The same local name under another prefix, or else a similar one under the same prefix."""
    prefix, _, local = own.partition(":")
    same = [name for name in declared if name.partition(":")[2].lower() == local.lower()]
    if same:
        return f"did you mean `{same[0]}`?"
    similar = near(local, [name.partition(":")[2] for name in declared if name.partition(":")[0] == prefix])
    return similar.replace("`", f"`{prefix}:", 1)


def _declared(model: Model, source_map: SourceMap) -> set[str]:
    rows = model.rows("SELECT DISTINCT ?term WHERE { ?term a ?any FILTER isIRI(?term) }")
    return {_shown(row["term"], source_map) for row in rows}


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


def _span(model: Model, finding: Finding, source_map: SourceMap) -> Span:
    file = source_map.source.file
    if finding.subject is None:
        return Span(file)
    for predicate, object_, part in _narrowings(finding):
        triples = source_map.find(finding.subject, predicate, object_)
        if isinstance(finding.subject, BlankNode) and len(triples) > 1:
            triples = _only(model, finding.subject, triples, source_map) or triples
        if not triples:
            continue
        if part == "object":
            token = triples[0].at_object
            if finding.inside is not None and token.kind == "string":
                return source_map.inside(token, *finding.inside)
            return source_map.span(token)
        return source_map.span(triples[-1].at_predicate if part == "predicate" else triples[0].at_subject)
    return Span(file)


def _only(model: Model, subject: BlankNode, triples: list[Located], source_map: SourceMap) -> list[Located]:
    """Those of ``triples`` whose blank subject has the same surroundings as the store's ``subject``."""
    graph = graph_of(Path(source_map.source.file))
    wanted = _surroundings(model.store, subject, graph)
    local = Store()
    own = NamedNode(graph.value)
    for triple in source_map.triples:
        local.add(Quad(triple.subject, triple.predicate, triple.object, own))
    return [triple for triple in triples if _surroundings(local, triple.subject, own) == wanted]


def _surroundings(store: Store, node: Term, graph: NamedNode, depth: int = 3) -> frozenset[object]:
    """A description of ``node`` that two parses of one file agree on."""
    described: set[object] = set()
    for quad in store.quads_for_pattern(node, None, None, graph):  # type: ignore[arg-type]
        value = quad.object
        if isinstance(value, BlankNode):
            described.add((quad.predicate, _surroundings(store, value, graph, depth - 1) if depth else "blank"))
        else:
            described.add((quad.predicate, canonical(cast("Term", value))))
    for quad in store.quads_for_pattern(None, None, node, graph):
        above = quad.subject
        described.add(("of", quad.predicate, above if isinstance(above, NamedNode) else "blank"))
    return frozenset(described)
