"""The paper's three implications, which ``ontology/shapes`` writes as ``sh:sparql``, once more in Python.

Each function is the Python form of one query and is found by that query's text: a query that was changed, or that
somebody adds, is not found here and runs as SPARQL. Tests hold both forms equal.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import CORE, TRACE, node
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.values import number

__all__ = ["IMPLICATIONS", "Implication", "query_key"]


Solution = Mapping[str, Term]
Implication = Callable[[Graph, Term], Iterator[Solution]]

_PREDICATE, _FIRST, _SECOND, _DOMAIN, _RANGE, _ARITY, _FACT, _ROUTE, _FAILURE, _ADMITS, _SUPPORTS = (
    node(CORE + name)
    for name in (
        "predicate", "argument1", "argument2", "domain", "range", "arity", "fact", "route", "failureClass", "admits",
        "supports",
    )
)  # fmt: skip
_LEVEL, _REQUESTED, _PRECONDITION = (node(CORE + name) for name in ("level", "requestedLevel", "precondition"))
_DIAGNOSIS, _OF, _SELECTED, _EPISODE, _REQUIRES, _MEMBER = (
    node(TRACE + name) for name in ("diagnosis", "of", "selected", "inEpisode", "requires", "memberFact")
)


def query_key(select: str) -> str:
    """What a query is found by: a digest of its text, in which white space does not count."""
    return hashlib.sha256(" ".join(select.split()).encode()).hexdigest()[:16]


def _argument(argument: NamedNode, wants: NamedNode) -> Implication:
    """Predicate consistency: the argument is of the class that the predicate declares for it."""

    def implication(data: Graph, focus: Term) -> Iterator[Solution]:
        for predicate in data.objects(focus, _PREDICATE):
            for wanted in data.objects(predicate, wants):
                for value in data.objects(focus, argument):
                    if not data.is_a(value, wanted):
                        yield {"value": value, "wanted": wanted, "predicate": predicate, "path": argument}

    return implication


def _arity(data: Graph, focus: Term) -> Iterator[Solution]:
    """Predicate consistency: as many arguments as the predicate declares."""
    second = bool(data.objects(focus, _SECOND))
    for predicate in data.objects(focus, _PREDICATE):
        for arity in data.objects(predicate, _ARITY):
            declared = number(arity) if isinstance(arity, Literal) else None
            if declared is not None and (declared == 2) != second:
                yield {"value": predicate, "arity": arity, "path": _PREDICATE}


def _preserved(data: Graph, focus: Term) -> Iterator[Solution]:
    """Argument preservation: a diagnosis speaks of a fact of its episode's required ABox, or a precondition of one."""
    attempts = dict.fromkeys(data.subjects(_DIAGNOSIS, focus))
    for decision in data.subjects(_OF, focus):
        attempts.update(dict.fromkeys(data.subjects(_SELECTED, decision)))
    for attempt in attempts:
        for episode in data.objects(attempt, _EPISODE):
            for required in data.objects(episode, _REQUIRES):
                members = data.objects(required, _MEMBER)
                for value in data.objects(focus, _FACT):
                    if value not in members and not any(value in data.objects(m, _PRECONDITION) for m in members):
                        yield {"value": value, "attempt": attempt, "required": required, "path": _FACT}


def _compatible(data: Graph, focus: Term) -> Iterator[Solution]:
    """Compatible routing: the route admits the failure and supports the predicate's kind."""
    for route in data.objects(focus, _ROUTE):
        admitted, kinds = data.objects(route, _ADMITS), data.objects(route, _SUPPORTS)
        for diagnosis in data.objects(focus, _OF):
            for fact in data.objects(diagnosis, _FACT):
                for predicate in data.objects(fact, _PREDICATE):
                    supported = any(data.is_a(predicate, kind) for kind in kinds)
                    for failure in data.objects(diagnosis, _FAILURE):
                        if not supported or failure not in admitted:
                            yield {"value": route, "unmet": failure, "predicate": predicate, "path": _ROUTE}


def _at_level(data: Graph, focus: Term) -> Iterator[Solution]:
    """Compatible routing: the route acts at the level at which the run may act."""
    for route in data.objects(focus, _ROUTE):
        levels = data.objects(route, _LEVEL)
        for diagnosis in data.objects(focus, _OF):
            for wanted in data.objects(diagnosis, _REQUESTED):
                if wanted not in levels:
                    yield {"value": route, "wanted": wanted, "path": _ROUTE}


IMPLICATIONS: Mapping[str, Implication] = {
    "2b47f4343cfc4f74": _argument(_FIRST, _DOMAIN),
    "1ae2ae9b6a1a1767": _argument(_SECOND, _RANGE),
    "5ebced233f1d5619": _arity,
    "23a1016928925276": _preserved,
    "e6c85d8e797daa03": _compatible,
    "fdfd0a429de7d7d2": _at_level,
}
