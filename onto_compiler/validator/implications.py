"""The paper's three implications, which ``ontology/shapes`` writes as ``sh:sparql``, once more in Python.

Each function is the Python form of one query and is found by that query's text: a query that was changed, or that
somebody adds, is not found here and runs as SPARQL. Tests hold both forms equal.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from typing import Protocol

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import CORE, TRACE, node
from onto_compiler.shacl.values import number
from onto_compiler.validator.facts import Term, Values

__all__ = ["IMPLICATIONS", "Implication", "query_key"]


class Known(Protocol):
    """What an implication asks of statements: facts of single records, or a graph that the engine validates."""

    def values(self, subject: Term, predicate: NamedNode) -> Values:
        """The objects of ``predicate`` that ``subject`` has."""
        ...

    def subjects(self, predicate: NamedNode, value: Term) -> Values:
        """The subjects that have ``value`` for ``predicate``."""
        ...

    def is_a(self, value: Term, cls: Term) -> bool:
        """Whether ``value`` has ``cls`` or a class below it for a type."""
        ...


Solution = Mapping[str, Term]
Implication = Callable[[Known, Term], Iterator[Solution]]

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

    def implication(facts: Known, focus: Term) -> Iterator[Solution]:
        for predicate in facts.values(focus, _PREDICATE):
            for wanted in facts.values(predicate, wants):
                for value in facts.values(focus, argument):
                    if not facts.is_a(value, wanted):
                        yield {"value": value, "wanted": wanted, "predicate": predicate, "path": argument}

    return implication


def _arity(facts: Known, focus: Term) -> Iterator[Solution]:
    """Predicate consistency: as many arguments as the predicate declares."""
    second = bool(facts.values(focus, _SECOND))
    for predicate in facts.values(focus, _PREDICATE):
        for arity in facts.values(predicate, _ARITY):
            declared = number(arity) if isinstance(arity, Literal) else None
            if declared is not None and (declared == 2) != second:
                yield {"value": predicate, "arity": arity, "path": _PREDICATE}


def _preserved(facts: Known, focus: Term) -> Iterator[Solution]:
    """Argument preservation: a diagnosis speaks of a fact of its episode's required ABox, or a precondition of one."""
    attempts = dict.fromkeys(facts.subjects(_DIAGNOSIS, focus))
    for decision in facts.subjects(_OF, focus):
        attempts.update(dict.fromkeys(facts.subjects(_SELECTED, decision)))
    for attempt in attempts:
        for episode in facts.values(attempt, _EPISODE):
            for required in facts.values(episode, _REQUIRES):
                members = facts.values(required, _MEMBER)
                for value in facts.values(focus, _FACT):
                    if value not in members and not any(value in facts.values(m, _PRECONDITION) for m in members):
                        yield {"value": value, "attempt": attempt, "required": required, "path": _FACT}


def _compatible(facts: Known, focus: Term) -> Iterator[Solution]:
    """Compatible routing: the route admits the failure and supports the predicate's kind."""
    for route in facts.values(focus, _ROUTE):
        admitted, kinds = facts.values(route, _ADMITS), facts.values(route, _SUPPORTS)
        for diagnosis in facts.values(focus, _OF):
            for fact in facts.values(diagnosis, _FACT):
                for predicate in facts.values(fact, _PREDICATE):
                    supported = any(facts.is_a(predicate, kind) for kind in kinds)
                    for failure in facts.values(diagnosis, _FAILURE):
                        if not supported or failure not in admitted:
                            yield {"value": route, "unmet": failure, "predicate": predicate, "path": _ROUTE}


def _at_level(facts: Known, focus: Term) -> Iterator[Solution]:
    """Compatible routing: the route acts at the level at which the run may act."""
    for route in facts.values(focus, _ROUTE):
        levels = facts.values(route, _LEVEL)
        for diagnosis in facts.values(focus, _OF):
            for wanted in facts.values(diagnosis, _REQUESTED):
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
