"""Damage to a recorded ABox, one kind per function: what a faulty writer, a wrong rule or a careless edit would leave.

A mutation is drawn; it may leave the record valid, which both validators must then say too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.rdf import CORE, MAN, RDF, TRACE, XSD, node

__all__ = ["MUTATIONS", "Mutation"]

Triples = list[Triple]
Term = NamedNode | BlankNode | Literal
Mutation = Callable[[np.random.Generator, Triples], Triples]

_TYPE = node(RDF + "type")
_CLASSES = [
    *(node(CORE + name) for name in ("Entity", "ObservedFact", "Predicate", "RequiredFact")),
    *(node(MAN + name) for name in ("ArticulatedFixture", "Drawer", "Object", "Region", "RelationMissing")),
    *(node(TRACE + name) for name in ("Application", "Attempt", "Diagnosis", "Episode", "Proposal", "RouteDecision")),
]
_ROUTES = [
    node(MAN + name)
    for name in ("object_relation_predicate", "rack_contact_site", "source_joint_pose", "source_joint_residual")
]
_DATATYPES = ("boolean", "date", "decimal", "double", "integer", "string")
_MALFORMED = {"boolean": "maybe", "double": "high", "integer": "1.5"}


def _pick(rng: np.random.Generator, among: Sequence[Triple]) -> Triple | None:
    return among[int(rng.integers(len(among)))] if among else None


def _having(triples: Triples, *predicates: str) -> Triples:
    wanted = {node(predicate) for predicate in predicates}
    return [triple for triple in triples if triple.predicate in wanted]


def _terms(triples: Triples) -> list[Term]:
    return list(dict.fromkeys(triple.object for triple in triples if not isinstance(triple.object, Triple)))


def _any(rng: np.random.Generator, terms: Sequence[Term]) -> Term:
    return terms[int(rng.integers(len(terms)))]


def _changed(triples: Triples, old: Triple | None, new: Term | None, *, keep: bool = False) -> Triples:
    """``triples`` with the object of ``old`` changed to ``new``, or without it; ``keep`` adds beside it."""
    if old is None:
        return triples
    rest = triples if keep else [triple for triple in triples if triple != old]
    return rest if new is None else [*rest, Triple(old.subject, old.predicate, new)]


def _without(*predicates: str) -> Mutation:
    return lambda rng, triples: _changed(triples, _pick(rng, _having(triples, *predicates)), None)


def _drop(rng: np.random.Generator, triples: Triples) -> Triples:
    return _changed(triples, _pick(rng, triples), None)


def _add(rng: np.random.Generator, triples: Triples) -> Triples:
    return _changed(triples, _pick(rng, triples), _any(rng, _terms(triples)), keep=True)


def _replace(rng: np.random.Generator, triples: Triples) -> Triples:
    return _changed(triples, _pick(rng, triples), _any(rng, _terms(triples)))


def _second_value(rng: np.random.Generator, triples: Triples) -> Triples:
    """Another value that the same property has elsewhere, so that types fit and only the number is wrong."""
    old = _pick(rng, triples)
    others = _terms([triple for triple in triples if old is not None and triple.predicate == old.predicate])
    return _changed(triples, old, _any(rng, others) if others else None, keep=True)


def _move(rng: np.random.Generator, triples: Triples) -> Triples:
    """A statement about another subject."""
    old, other = _pick(rng, triples), _pick(rng, triples)
    if old is None or other is None:
        return triples
    return [*(triple for triple in triples if triple != old), Triple(other.subject, old.predicate, old.object)]


def _retype(rng: np.random.Generator, triples: Triples) -> Triples:
    return _changed(triples, _pick(rng, _having(triples, RDF + "type")), _any(rng, _CLASSES))


def _second_type(rng: np.random.Generator, triples: Triples) -> Triples:
    return _changed(triples, _pick(rng, _having(triples, RDF + "type")), _any(rng, _CLASSES), keep=True)


def _wrong_argument(rng: np.random.Generator, triples: Triples) -> Triples:
    """An argument of another class: the entity that a fact is about becomes something else."""
    old = _pick(rng, _having(triples, CORE + "argument1", CORE + "argument2"))
    kinds = [t for t in _having(triples, RDF + "type") if old is not None and t.subject == old.object]
    return _changed(triples, _pick(rng, kinds), _any(rng, _CLASSES))


def _wrong_predicate(rng: np.random.Generator, triples: Triples) -> Triples:
    predicates = [node(MAN + name) for name in ("on", "joint_state", "in_region", "left_of")]
    return _changed(triples, _pick(rng, _having(triples, CORE + "predicate")), _any(rng, predicates))


def _foreign_fact(rng: np.random.Generator, triples: Triples) -> Triples:
    """A diagnosis of a fact that the task only declares, or of one that nobody knows."""
    about = {t.subject for t in triples if t.predicate == _TYPE and t.object == node(TRACE + "Diagnosis")}
    old = _pick(rng, [triple for triple in _having(triples, CORE + "fact") if triple.subject in about])
    facts = [t.subject for t in triples if t.predicate == _TYPE and t.object == node(CORE + "RequiredFact")]
    return _changed(triples, old, _any(rng, [*facts, node("https://example.org/fact")]))  # type: ignore[list-item]


def _wrong_route(rng: np.random.Generator, triples: Triples) -> Triples:
    """A decision for another route, which may be one that fits."""
    decided = {triple.subject for triple in _having(triples, CORE + "decision")}
    old = _pick(rng, [triple for triple in _having(triples, CORE + "route") if triple.subject in decided])
    others = [route for route in _ROUTES if old is not None and route != old.object]
    return _changed(triples, old, _any(rng, others) if others else None)


def _wrong_failure(rng: np.random.Generator, triples: Triples) -> Triples:
    """Another class of failure for the diagnosis that a decision speaks of."""
    routed = {triple.object for triple in _having(triples, TRACE + "of")}
    old = _pick(rng, [triple for triple in _having(triples, CORE + "failureClass") if triple.subject in routed])
    failures = [node(MAN + name) for name in ("RelationMissing", "RackContact", "JointState")]
    return _changed(triples, old, _any(rng, [*failures, node(CORE + "ExecutionFailure")]))


def _no_member(rng: np.random.Generator, triples: Triples) -> Triples:
    """A required ABox that lacks one of its facts."""
    required = [triple for triple in _having(triples, TRACE + "memberFact") if "/required/fact/" in str(triple.object)]
    return _changed(triples, _pick(rng, required), None)


def _wrong_datatype(rng: np.random.Generator, triples: Triples) -> Triples:
    old = _pick(rng, [triple for triple in triples if isinstance(triple.object, Literal)])
    if old is None or not isinstance(old.object, Literal):
        return triples
    name = str(rng.choice(_DATATYPES))
    text = {"date": "2026-02-28", "boolean": "true", "decimal": "1.0", "double": "1.0", "integer": "1"}.get(name, "x")
    return _changed(triples, old, Literal(text, datatype=node(XSD + name)))


def _malformed(rng: np.random.Generator, triples: Triples) -> Triples:
    known = {node(XSD + name): text for name, text in _MALFORMED.items()}
    literals = [t for t in triples if isinstance(t.object, Literal) and t.object.datatype in known]
    old = _pick(rng, literals)
    if old is None or not isinstance(old.object, Literal):
        return triples
    return _changed(triples, old, Literal(known[old.object.datatype], datatype=old.object.datatype))


def _out_of_range(rng: np.random.Generator, triples: Triples) -> Triples:
    """A score outside of 0 to 1, on its edge, or none."""
    old = _pick(rng, [t for t in triples if t.predicate == node(CORE + "source") and "/observation/" in str(t.subject)])
    if old is None:
        return triples
    text = str(rng.choice(["-0.1", "0.0", "1.0", "1.1", "NaN", "INF", "1e-3"]))
    scored = _having(triples, CORE + "score")
    rest = [triple for triple in triples if triple not in scored or triple.subject != old.subject]
    return [*rest, Triple(old.subject, node(CORE + "score"), Literal(text, datatype=node(XSD + "double")))]


def _other_kind(rng: np.random.Generator, triples: Triples) -> Triples:
    """A literal where a node stood, a node where a literal stood, or a node without a name."""
    old = _pick(rng, triples)
    if old is None:
        return triples
    options: list[Term] = [Literal("text"), node("https://example.org/nothing"), BlankNode("nameless")]
    return _changed(triples, old, _any(rng, options))


def _other_individual(rng: np.random.Generator, triples: Triples) -> Triples:
    names = ("source", "status", "decision")
    individuals = [node(CORE + name) for name in ("Simulator", "Satisfied", "Absent", "Dispatch", "ExplicitlyFalse")]
    return _changed(triples, _pick(rng, _having(triples, *(CORE + name for name in names))), _any(rng, individuals))


def _twice(rng: np.random.Generator, triples: Triples) -> Triples:
    """Two faults at once."""
    names = sorted(set(MUTATIONS) - {"none", "two"})
    for name in rng.choice(names, 2):
        triples = MUTATIONS[str(name)](rng, triples)
    return triples


def _none(rng: np.random.Generator, triples: Triples) -> Triples:  # noqa: ARG001 - a mutation's signature
    return triples


MUTATIONS: Mapping[str, Mutation] = {
    "none": _none,
    "drop": _drop,
    "add": _add,
    "replace": _replace,
    "move": _move,
    "second value": _second_value,
    "retype": _retype,
    "second type": _second_type,
    "wrong argument": _wrong_argument,
    "wrong predicate": _wrong_predicate,
    "foreign fact": _foreign_fact,
    "wrong route": _wrong_route,
    "wrong failure": _wrong_failure,
    "wrong datatype": _wrong_datatype,
    "malformed": _malformed,
    "out of range": _out_of_range,
    "other kind": _other_kind,
    "other individual": _other_individual,
    "no polarity": _without(CORE + "polarity"),
    "no member": _no_member,
    "two": _twice,
}
