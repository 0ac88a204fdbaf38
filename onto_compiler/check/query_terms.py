"""Names in the queries of shapes, targets, functions and rules that nothing declares; they match nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property

from pyoxigraph import Literal, NamedNode, Triple

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH, namespace_of
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.reader import Reader
from onto_compiler.sources import load_store
from onto_compiler.sparql_faults.undeclared import StoreVocabulary, undeclared

__all__ = ["QUERIES", "check_query_terms", "undeclared_in_queries"]

QUERIES = tuple(NamedNode(SH + name) for name in ("select", "ask", "construct"))
_RULE = QUERIES[-1]
_NEARLY, _SHORT = 0.75, 4  # how similar a misspelt name is, and from how many letters on names are compared
_TYPE, _DEFINED_BY = NamedNode(RDF + "type"), NamedNode(RDFS + "isDefinedBy")
_KINDS = tuple(map(NamedNode, (f"{RDF}Property", f"{RDFS}Class", f"{OWL}Class"))) + tuple(
    NamedNode(f"{OWL}{kind}Property") for kind in ("Annotation", "Datatype", "Object")
)
_NAMING = tuple(
    NamedNode(SH + name) for name in ("class", "path", "targetClass", "targetObjectsOf", "targetSubjectsOf")
)


def check_query_terms(model: Model) -> Iterator[Finding]:
    """Each undeclared name in a query of the reported files. Those of our namespaces in rules are RUL005."""
    vocabulary, reader = StoreVocabulary(model.store), Reader(model.graph)
    for quad in model.written:
        query = quad.object
        if quad.predicate not in QUERIES or not isinstance(query, Literal) or quad.graph_name not in model.graphs:
            continue
        assert not isinstance(quad.subject, Triple)  # noqa: S101 - no triple is a subject in RDF 1.2
        for _, fault in undeclared(query.value, reader.prefixes(quad.subject), vocabulary):
            if quad.predicate == _RULE and fault.code == "VOC001":
                continue
            inside = (fault.start, fault.length)
            yield Finding(
                fault.code, "error", fault.message, fault.hint, quad.subject, quad.predicate, query, inside=inside
            )


@dataclass(frozen=True)
class _GraphVocabulary:
    """What the given graphs declare or use. A namespace is known once a graph declares one of its terms.

    Of namespaces without a declaration the terms that are used as properties and classes stand in for it: a name that
    is nearly one of them is taken for a misspelt one.
    """

    graphs: tuple[Graph, ...]
    shipped: list[StoreVocabulary] = field(default_factory=list)

    def knows(self, iri: str) -> bool:
        """Whether a term is declared or used, or lies in a namespace of which nothing is known."""
        term, namespace = NamedNode(iri), namespace_of(iri)
        if any(graph.holders(term) or graph.has_subject(term) or graph.subjects(_TYPE, term) for graph in self.graphs):
            return True
        if namespace.startswith(BASE):
            return self._ours.knows(iri)
        if namespace not in self._namespaces and not self._resembles(iri):
            return True
        return any(True for graph in self.graphs for _ in graph.pointing(term))

    def declared(self) -> Iterable[str]:
        """The terms that are declared or used, and those of the shipped ontology once they were asked for."""
        return [*self._terms, *(iri for one in self.shipped for iri in one.declared())]

    @property
    def _ours(self) -> StoreVocabulary:
        if not self.shipped:
            self.shipped.append(StoreVocabulary(load_store()))
        return self.shipped[0]

    def _resembles(self, iri: str) -> bool:
        namespace = namespace_of(iri)
        name = iri.removeprefix(namespace)
        beside = [term.removeprefix(namespace) for term in self._terms if namespace_of(term) == namespace]
        return len(name) >= _SHORT and bool(get_close_matches(name, beside, 1, _NEARLY))

    @cached_property
    def _declarations(self) -> set[str]:
        found = {term for graph in self.graphs for kind in _KINDS for term in graph.subjects(_TYPE, kind)}
        found |= {term for graph in self.graphs for term in graph.holders(_DEFINED_BY)}
        return {term.value for term in found if isinstance(term, NamedNode)}

    @cached_property
    def _namespaces(self) -> set[str]:
        return set(map(namespace_of, self._declarations))

    @cached_property
    def _terms(self) -> list[str]:
        used = {term for graph in self.graphs for name in (_TYPE, *_NAMING) for term in graph.values(name)}
        used |= {predicate for graph in self.graphs for predicate in graph.properties}
        return sorted(self._declarations | {term.value for term in used if isinstance(term, NamedNode)})


def undeclared_in_queries(shapes: Graph, data: Graph) -> Iterator[ShapeFault]:
    """Each name in a query of ``shapes`` that nothing declares or uses.

    It is an error in the standard vocabularies' namespaces and in ours, and in any other a warning, as what declares
    it may lie in a file that was not given.
    """
    vocabulary, reader = _GraphVocabulary((shapes, data)), Reader(shapes)
    for predicate in QUERIES:
        for holder, queries in shapes.holders(predicate).items():
            prefixes = reader.prefixes(holder)
            for query in queries:
                if not isinstance(query, Literal):
                    continue
                for iri, fault in undeclared(query.value, prefixes, vocabulary):
                    yield ShapeFault(
                        fault.message,
                        holder,
                        predicate.value.removeprefix(SH),
                        query,
                        code=fault.code,
                        hint=fault.hint,
                        inside=(fault.start, fault.length),
                        severity="error" if fault.code != "VOC001" or iri.startswith(BASE) else "warning",
                    )
