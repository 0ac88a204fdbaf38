"""House style: which findings only concern a project's own terms, and what is said of terms of others.

Own are the shipped namespaces, those that the settings name, and those of every file that builds on a shipped ontology:
its header imports one, or it has no header and uses a term of one. What is right by RDF, OWL and SHACL and only against
our style is not reported for other terms, unless the settings select its code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from urllib.parse import urlsplit

from pyoxigraph import Literal, NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.check.undeclared import KINDS
from onto_compiler.problems import Problem
from onto_compiler.rdf import BASE, PREFIXES, RDFS, namespace_of
from onto_compiler.reasoning.axioms import TYPE, owl
from onto_compiler.sources import graph_of
from onto_compiler.vocabularies import TERMS

__all__ = ["House"]

STYLE = frozenset(
    [
        "DOC001",
        "DOC002",
        "DOC003",
        "DOC004",
        "DOC005",
        "DOC006",
        "DOC007",
        "OWL001",
        "OWL002",
        "OWL007",
        "OWL008",
        "OWL016",
        "RUL003",
        "RUL004",
        "RUL006",
        "RUL007",
        "RUL008",
        "RUL009",
        "RUL013",
        "RUL015",
        "RUL016",
        "VOC003",
        "VOC004",
        "VOC005",
        "VOC008",
        "VOC010",
    ]
)
"""Not reported of terms of others."""
ADVICE = frozenset(["OWL003", "OWL012", "OWL013", "OWL014", "OWL015", "TTL007"])
"""Information, of terms of others: worth knowing, and no fault."""
_NAMES = {"VOC001": "object", "VOC002": "predicate", "RUL005": "term"}
_IMPORTS, _DEFINED, _DEPRECATED = owl("imports"), NamedNode(RDFS + "isDefinedBy"), owl("deprecated")
_SHARED = frozenset((*TERMS, *PREFIXES.values()))
_OF_FILES = ("github.com", "githubusercontent.com", "gitlab.com")
"""Hosts of files, of which an address says nothing of the namespaces within."""


@dataclass
class House:
    """What is a project's own in ``model``; ``named`` are namespaces, ``selected`` codes or how they begin."""

    model: Model
    named: tuple[str, ...] = ()
    selected: tuple[str, ...] = ()

    def judged(self, findings: Iterable[Finding]) -> Iterator[Finding]:
        """The findings that are reported, each with the severity that it has in its place."""
        for finding in findings:
            if finding.code in _NAMES and self._may_be_elsewhere(finding):
                continue
            style = finding.code in STYLE or (finding.code == "VOC006" and self._is_maintained(finding))
            advice = finding.code in ADVICE or (finding.code == "SHP001" and self._may_have_a_type(finding))
            if not (style or advice) or self._asked(finding.code) or self._is_own(finding):
                yield finding
            elif advice:
                yield replace(finding, severity="info")

    def judged_problem(self, problem: Problem, graph: NamedNode) -> Problem:
        """As :meth:`judged`, of what concerns a file and no term of it."""
        if problem.code not in ADVICE or self._asked(problem.code) or graph in self.files:
            return problem
        return replace(problem, severity="info")

    def _asked(self, code: str) -> bool:
        return code.startswith(self.selected)

    def _is_own(self, finding: Finding) -> bool:
        if isinstance(finding.subject, NamedNode):
            return self._owns(finding.subject.value)
        if finding.subject is None or isinstance(finding.subject, Literal):
            return finding.graph is None or finding.graph in self.files
        holders = self.model.store.quads_for_pattern(finding.subject, None, None, None)
        return any(quad.graph_name in self.files or quad.graph_name not in self.model.graphs for quad in holders)

    def _owns(self, iri: str) -> bool:
        return iri.startswith(self.namespaces) or iri in self.headers

    @cached_property
    def files(self) -> frozenset[NamedNode]:
        """The graphs of the reported files that build on a shipped ontology, or are named in the settings."""
        graphs = self.model.graphs
        headers = {graph: self._headers(graph) for graph in graphs}
        own = {header for found in headers.values() for header in found if header.value.startswith((BASE, *self.named))}
        imports = {header: self._imports(header) for found in headers.values() for header in found}
        ours = {header for header, wider in imports.items() if any(one.value.startswith(BASE) for one in wider)}
        while ours - own:
            own |= ours
            ours = {header for header, wider in imports.items() if wider & own}
        return frozenset(
            graph for graph, found in headers.items() if (found & own if found else self._uses_ours(graph))
        )

    @cached_property
    def headers(self) -> frozenset[str]:
        """The IRIs of the ontologies of those files."""
        return frozenset(header.value for graph in self.files for header in self._headers(graph))

    @cached_property
    def namespaces(self) -> tuple[str, ...]:
        """What the IRIs of own terms begin with."""
        found = {f"{header.rstrip('#/')}{end}" for header in self.headers for end in "#/"}
        for graph in self.files:
            header = bool(self._headers(graph))
            about = self.model.store.quads_for_pattern(None, _DEFINED if header else TYPE, None, graph)
            found |= {namespace_of(quad.subject.value) for quad in about if isinstance(quad.subject, NamedNode)}
        return (BASE, *self.named, *sorted(found - _SHARED - {""}))

    def _imports(self, header: NamedNode) -> set[NamedNode]:
        quads = self.model.store.quads_for_pattern(header, _IMPORTS, None, None)
        return {quad.object for quad in quads if isinstance(quad.object, NamedNode)}

    def _headers(self, graph: NamedNode) -> set[NamedNode]:
        quads = self.model.store.quads_for_pattern(None, TYPE, owl("Ontology"), graph)
        return {quad.subject for quad in quads if isinstance(quad.subject, NamedNode)}

    def _uses_ours(self, graph: NamedNode) -> bool:
        def ours(term: object) -> bool:
            return isinstance(term, NamedNode) and term.value.startswith((BASE, *self.named))

        quads = self.model.store.quads_for_pattern(None, None, None, graph)
        return any(ours(quad.subject) or ours(quad.predicate) or ours(quad.object) for quad in quads)

    def _is_maintained(self, finding: Finding) -> bool:
        """Whether the file that uses a deprecated term is the one that deprecates it: it knows what it does."""
        term, store = finding.values.get("term"), self.model.store
        if not isinstance(term, NamedNode):
            return False
        here = {quad.graph_name for quad in store.quads_for_pattern(term, _DEPRECATED, None, None)}
        at = store.quads_for_pattern(finding.subject, finding.predicate, finding.object, None)  # type: ignore[arg-type]
        return all(quad.graph_name in here for quad in at)

    def _may_have_a_type(self, finding: Finding) -> bool:
        """Whether a shape misses a class of a term, of which a file that was not given may have said it."""
        term = finding.values.get("untyped")
        return isinstance(term, NamedNode) and urlsplit(term.value).netloc in self._missing

    def _may_be_elsewhere(self, finding: Finding) -> bool:
        """Whether an undeclared term of others may be declared in a file that was not given."""
        term = finding.values.get(_NAMES[finding.code])
        if not isinstance(term, NamedNode):
            return False
        namespace = namespace_of(term.value)
        if namespace in _SHARED and not namespace.startswith(BASE):
            return True
        if self._owns(term.value):
            return False
        host = urlsplit(namespace).netloc
        missing = any(one in {"", host} or one.endswith(_OF_FILES) for one in self._missing)
        return missing or namespace not in self._declared

    @cached_property
    def _declared(self) -> frozenset[str]:
        """The namespaces of each file and of what it imports: that in which it declares most, and its header's.

        Of others, a file may declare the few terms that it uses; one with several headers was put together of parts.
        """
        found: set[str] = set()
        for graph in (*self.model.graphs, *map(graph_of, self.model.imported)):
            kinds = (self.model.store.quads_for_pattern(None, TYPE, kind, graph) for kind in KINDS)
            terms = {quad.subject.value for quads in kinds for quad in quads if isinstance(quad.subject, NamedNode)}
            counted = Counter(namespace for namespace in map(namespace_of, terms) if namespace not in _SHARED)
            found |= {namespace for namespace, number in counted.items() if number == max(counted.values())}
            headers = [header.value.rstrip("#/") for header in self._headers(graph)]
            if len(headers) == 1:
                found |= {f"{headers[0]}{end}" for end in "#/"} & counted.keys()
        return frozenset(found)

    @cached_property
    def _missing(self) -> frozenset[str]:
        """The hosts of the imports that are in none of the files; vocabularies that are known are not missing."""
        names = (one.value for one in self.model.unresolved)
        return frozenset(
            urlsplit(iri).netloc for iri in names if not _SHARED & {f"{iri.rstrip('#/')}{end}" for end in "#/"}
        )
