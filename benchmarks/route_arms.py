"""Ways to choose a route: the shipped rules, and controls that differ from them in nothing else.

Each control is a :class:`~runtime.loop.routing.Routing` of one episode. The routes are those of the state level, in the
order of their names; a route without a candidate falls through to the arm's next one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import count, permutations

import numpy as np

from onto_compiler.knowledge import Knowledge
from onto_compiler.rdf import CORE
from onto_compiler.tables import EXPLICITLY_FALSE, FIRST
from runtime.loop.records import Diagnosis, RouteDecision
from runtime.loop.routing import Routing, attempt_status, by_rule

__all__ = ["ARMS", "SEED", "Asked", "FailureType", "permuted_types", "state_routes"]

SEED = 0
_LEVEL = "state"
FailureType = tuple[str, str]
"""The kind of a predicate, and the failure class of its facts: what routing rules look at."""


def state_routes(knowledge: Knowledge) -> tuple[str, ...]:
    """The routes of the state level by name."""
    routes = knowledge.schema.routes
    return tuple(
        sorted((iri for iri, each in routes.items() if each.level == _LEVEL), key=lambda iri: routes[iri].name)
    )


class Asked:
    """A routing that counts the routes that were asked for a candidate."""

    def __init__(self, routing: Routing) -> None:
        """Ask ``routing``."""
        self.routing, self.count = routing, 0

    def __call__(self, diagnosis: Diagnosis, knowledge: Knowledge, rejected: str | None) -> Iterator[RouteDecision]:
        """As ``routing`` does."""
        for decision in self.routing(diagnosis, knowledge, rejected):
            self.count += 1
            yield decision


def _typed(_random: np.random.Generator) -> Routing:
    return by_rule


def _fresh_random(random: np.random.Generator) -> Routing:
    """An order of the routes drawn anew for every attempt."""
    return _ordered(lambda routes: [routes[place] for place in random.permutation(len(routes))])


def _fixed_order(_random: np.random.Generator) -> Routing:
    """The same order for every attempt of every episode."""
    return _ordered(list)


def _round_robin(_random: np.random.Generator) -> Routing:
    """Attempt k of an episode begins with route k, and again with the first after the last."""
    turn = count()

    def order(routes: Sequence[str]) -> Sequence[str]:
        first = next(turn) % len(routes)
        return [*routes[first:], *routes[:first]]

    return _ordered(order)


def _permuted(_random: np.random.Generator) -> Routing:
    """The rules' routes for a failure of another type, see :func:`permuted_types`."""

    def routing(diagnosis: Diagnosis, knowledge: Knowledge, rejected: str | None) -> Iterator[RouteDecision]:
        kind = knowledge.schema.predicates[diagnosis.fact.predicate].kind
        predicate, failure = permuted_types(knowledge)[kind, diagnosis.failure]
        other = replace(diagnosis, fact=replace(diagnosis.fact, predicate=predicate), failure=failure)
        for decision in by_rule(other, knowledge, rejected):
            yield replace(decision, diagnosis=diagnosis)

    return routing


ARMS: Mapping[str, Callable[[np.random.Generator], Routing]] = {
    "typed": _typed,
    "fresh_random": _fresh_random,
    "fixed_order": _fixed_order,
    "round_robin": _round_robin,
    "permuted": _permuted,
}
"""By name, what makes the routing of one episode; it may draw from the episode's generator."""


def _ordered(order: Callable[[Sequence[str]], Sequence[str]]) -> Routing:
    """The routes in an ``order`` that is asked for at each attempt, whatever has failed."""

    def routing(diagnosis: Diagnosis, knowledge: Knowledge, rejected: str | None) -> Iterator[RouteDecision]:
        for route in order(state_routes(knowledge)):
            word = "Dispatch" if rejected is None else "Retry" if route == rejected else "Reroute"
            yield RouteDecision(
                route, diagnosis, _LEVEL, CORE + word, "", attempt_status(rejected), rejected, requested=_LEVEL
            )

    return routing


@cache
def _derangement(routes: tuple[str, ...]) -> tuple[int, ...]:
    """A permutation of places, drawn once, under which no place has the route that it had."""
    found = [p for p in permutations(range(len(routes))) if all(routes[a] != routes[b] for a, b in enumerate(p))]
    return found[int(np.random.default_rng(SEED).integers(len(found)))]


def permuted_types(knowledge: Knowledge) -> dict[FailureType, tuple[str, str]]:
    """For each type of failure of a required relation that is false, a predicate and failure of another type.

    No type is sent along the route that it is first sent along by rule.
    """
    routing, first = knowledge.tables.routing, dict[FailureType, tuple[str, str]]()
    for (predicate, polarity, status), entry in sorted(knowledge.tables.diagnosis.items()):
        if polarity and status == EXPLICITLY_FALSE and (predicate, entry.failure, FIRST, None, _LEVEL) in routing:
            first.setdefault((knowledge.schema.predicates[predicate].kind, entry.failure), (predicate, entry.failure))
    examples = list(first.values())
    dispatched = tuple(routing[predicate, failure, FIRST, None, _LEVEL].route for predicate, failure in examples)
    return {kind: examples[place] for kind, place in zip(first, _derangement(dispatched), strict=True)}
