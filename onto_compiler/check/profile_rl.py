"""Axioms outside OWL 2 RL: they are sound OWL, and the forward chaining of ``onto check`` draws nothing from them.

Source: OWL 2 Profiles, section 4.2 (what may stand below and above in a subclass axiom).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.check.profile_dl import CARDINALITIES, read_list
from onto_compiler.rdf import RDFS, shorten
from onto_compiler.reasoning.axioms import TYPE, owl

__all__ = ["check_rl"]

_HINT = "keep it for reasoners of OWL 2 DL (`onto check --reasoner hermit`), or say it as a SHACL shape"
_BELOW, _ABOVE = "below", "above"
_ALLOWED = {
    _BELOW: {"intersectionOf": _BELOW, "unionOf": _BELOW, "oneOf": "", "someValuesFrom": _BELOW, "hasValue": ""},
    _ABOVE: {"intersectionOf": _ABOVE, "complementOf": _BELOW, "allValuesFrom": _ABOVE, "hasValue": ""},
}
_WORDS = {
    name: owl(name)
    for name in ("intersectionOf", "unionOf", "oneOf", "complementOf", "someValuesFrom", "allValuesFrom", "hasValue")
} | {"hasSelf": owl("hasSelf")}
_MOST = {owl("maxCardinality"), owl("maxQualifiedCardinality")}
_SIDES = (
    (NamedNode(RDFS + "subClassOf"), (_BELOW,), (_ABOVE,)),
    (owl("equivalentClass"), (_BELOW, _ABOVE), (_BELOW, _ABOVE)),
    (owl("disjointWith"), (_BELOW,), (_BELOW,)),
    (NamedNode(RDFS + "domain"), (), (_ABOVE,)),
    (NamedNode(RDFS + "range"), (), (_ABOVE,)),
)
Triple = tuple[Term, NamedNode, Term]


def check_rl(model: Model) -> Iterator[Finding]:
    """OWL016 at each part of a class expression that OWL 2 RL has not at its place, and at axioms that it has not."""
    for predicate, left, right in _SIDES:
        for subject, _, value in _triples(model, None, predicate):
            for side in left:
                yield from _expression(model, subject, side)
            for side in right:
                yield from _expression(model, value, side)
    for triple in _triples(model, None, owl("disjointUnionOf")):
        yield _finding(triple, "owl:disjointUnionOf")
    for triple in _triples(model, None, TYPE, owl("ReflexiveProperty")):
        yield _finding(triple, "owl:ReflexiveProperty")


def _triples(model: Model, subject: Term | None, predicate: NamedNode, value: Term | None = None) -> Iterator[Triple]:
    found = model.store.quads_for_pattern(subject, predicate, value, None)  # type: ignore[arg-type]
    return (cast("Triple", (quad.subject, quad.predicate, quad.object)) for quad in found)


def _expression(model: Model, node: Term, side: str) -> Iterator[Finding]:
    """What ``node``, where it is anonymous, says that may not stand on this ``side`` of a subclass axiom."""
    waiting, seen = [(node, side)], set()
    while waiting:
        node, side = waiting.pop()
        if not isinstance(node, BlankNode) or (node, side) in seen:
            continue
        seen.add((node, side))
        for word, predicate in _WORDS.items():
            for triple in _triples(model, node, predicate):
                if word not in _ALLOWED[side]:
                    yield _finding(triple, f"owl:{word} {_place(side)}")
                elif within := _ALLOWED[side][word]:
                    parts = read_list(model, triple[2]) if word in {"intersectionOf", "unionOf"} else (triple[2],)
                    waiting += [(part, within) for part in parts or ()]
        for predicate in CARDINALITIES:
            for triple in _triples(model, node, predicate):
                number = triple[2].value if isinstance(triple[2], Literal) else ""
                if side == _BELOW or predicate not in _MOST or number not in {"0", "1"}:
                    yield _finding(triple, f"{shorten(predicate.value)} {number} {_place(side)}")


def _place(side: str) -> str:
    return "in a subclass" if side == _BELOW else "in a superclass"


def _finding(triple: Triple, what: str) -> Finding:
    message = f"{what} is outside OWL 2 RL: the built-in reasoner does not use it"
    return Finding("OWL016", "warning", message, _HINT, *triple, general=True)
