"""Uses of deprecated terms (VOC006): not by what is deprecated itself, nor by what only sets two terms in relation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode, Quad

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, PREFIXES, RDFS, SKOS
from onto_compiler.terms import Term

__all__ = ["check_deprecated"]

_DEPRECATED = NamedNode(OWL + "deprecated")
_TRUE = {"true", "1"}
_REPLACED_BY = NamedNode(PREFIXES["dcterms"] + "isReplacedBy")
_RELATING = {
    *(OWL + name for name in ("disjointWith", "equivalentClass", "equivalentProperty", "inverseOf", "sameAs")),
    *(OWL + name for name in ("propertyDisjointWith", "members", "deprecated")),
    *(SKOS + name for name in ("broadMatch", "closeMatch", "exactMatch", "narrowMatch", "related", "relatedMatch")),
    PREFIXES["dcterms"] + "replaces",
    RDFS + "seeAlso",
}


def check_deprecated(model: Model) -> Iterator[Finding]:
    """Each triple in which something current uses a deprecated term."""
    graph = model.graph
    old = {
        term
        for value, terms in graph.values(_DEPRECATED).items()
        if isinstance(value, Literal) and value.value in _TRUE
        for term in terms
    }
    if not old:
        return
    uses = [quad for quad in model.written if quad.predicate in old or quad.object in old]
    if not uses:
        return
    above = {quad.object: quad for quad in model.written if isinstance(quad.object, BlankNode)}
    for quad in uses:
        subject, predicate, value = cast("tuple[Term, NamedNode, Term]", (quad.subject, quad.predicate, quad.object))
        for term in {predicate, value} & old:
            # `isReplacedBy` in a vocabulary of one's own (Brick has one) is meant as Dublin Core's.
            relates = term == value and (predicate.value in _RELATING or predicate.value.endswith("isReplacedBy"))
            if not relates and _is_current(subject, old, above):
                new = next(iter(graph.objects(term, _REPLACED_BY)), "what its definition names")
                yield Finding(
                    "VOC006",
                    "warning",
                    "`{term}` is deprecated",
                    "use `{replacement}`",
                    subject,
                    predicate,
                    value,
                    values={"term": term, "replacement": new},
                )


def _is_current(node: Term, old: set[Term], above: Mapping[BlankNode, Quad]) -> bool:
    """Whether ``node``, or what holds it where it has no name, is neither deprecated nor part of such a relation."""
    seen: set[Term] = set()
    while isinstance(node, BlankNode) and node not in seen and (quad := above.get(node)) is not None:
        seen.add(node)
        if quad.predicate.value in _RELATING:
            return False
        node = cast("Term", quad.subject)
    return node not in old
