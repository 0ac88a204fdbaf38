"""Pi_R: the declared route of a diagnosis, given the status of the attempts (paper, section 3). The rules decide."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Protocol

from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema, local_name
from onto_compiler.tables import EXHAUSTED, FIRST, REPEAT
from runtime.loop.records import Diagnosis, RouteDecision

__all__ = ["Routing", "attempt_status", "by_rule", "route", "route_or_none"]


class Routing(Protocol):
    """Which routes a failure is sent along, the preferred one first; the correction loop's is :func:`by_rule`."""

    def __call__(self, diagnosis: Diagnosis, knowledge: Knowledge, rejected: str | None) -> Iterator[RouteDecision]:
        """The routes of one attempt: the loop takes the first that has a candidate.

        ``rejected`` is the route of the last rejected attempt on the same fact in this episode, if there was one.
        """
        ...


def by_rule(diagnosis: Diagnosis, knowledge: Knowledge, rejected: str | None) -> Iterator[RouteDecision]:
    """The declared route, and after each route without a candidate the one that the rules name then; each once.

    Raises:
        OntoError: RUN004 if no routing rule speaks of the diagnosis.
    """
    asked = set[str]()
    decision: RouteDecision | None = route(diagnosis, knowledge, attempt_status(rejected), rejected)
    while decision is not None and decision.route not in asked:
        yield decision
        asked.add(decision.route)
        decision = route_or_none(diagnosis, knowledge, EXHAUSTED, decision.route)


def attempt_status(rejected: str | None) -> str:
    """The status of an attempt on a fact whose last attempt in this episode followed the route ``rejected``, if any."""
    return FIRST if rejected is None else REPEAT


def route(
    diagnosis: Diagnosis,
    knowledge: Knowledge,
    status: str = FIRST,
    previous: str | None = None,
    *,
    level: str = "state",
) -> RouteDecision:
    """The route of ``level`` for ``diagnosis``, given the attempt ``status`` and the route tried ``previous``ly.

    Raises:
        OntoError: RUN004 if no routing rule speaks of the combination.
    """
    decision = route_or_none(diagnosis, knowledge, status, previous, level=level)
    if decision is None:
        raise _missing(diagnosis, knowledge.schema, status, previous, level)
    return decision


def _missing(diagnosis: Diagnosis, schema: Schema, status: str, previous: str | None, level: str) -> OntoError:
    """What a routing rule lacks: a route of the level, its failure, its kind, or its successor."""
    failure, kind = diagnosis.failure, schema.predicates[diagnosis.fact.predicate].kind
    of = f"`{local_name(failure)}` of `{diagnosis.fact}`"
    admitting = [
        each for each in schema.routes.values() if each.level == level and _among(failure, each.admits, schema)
    ]
    names = ", ".join(f"`{each.name}`" for each in admitting)
    if not admitting:
        message = f"no route of the {level} level admits {of}"
        hint = f"let one admit it: `core:admits` with `{local_name(failure)}` or a class above it"
    elif not any(_among(kind, each.supports, schema) for each in admitting):
        message = f"{names} of the {level} level admits {of}, and does not support its kind, `{local_name(kind)}`"
        hint = f"let the route support it: `core:supports` with `{local_name(kind)}` or a class above it"
    else:
        after = f" after `{local_name(previous)}`" if previous else ""
        message = f"no routing rule sends {of} along {names}, {local_name(status)}{after}"
        hint = (
            "name the route's successor with core:onRejection, or declare a first route that is no core:ResidualRoute"
        )
    return OntoError.of("RUN004", message, hint)


def _among(cls: str, wanted: Collection[str], schema: Schema) -> bool:
    return any(schema.is_a(cls, each) for each in wanted)


def route_or_none(
    diagnosis: Diagnosis,
    knowledge: Knowledge,
    status: str = FIRST,
    previous: str | None = None,
    *,
    level: str = "state",
) -> RouteDecision | None:
    """As :func:`route`, and None if no rule covers the combination: so ends a route that names no successor."""
    entry = knowledge.tables.routing.get((diagnosis.fact.predicate, diagnosis.failure, status, previous, level))
    if entry is None:
        return None
    return RouteDecision(
        route=entry.route,
        diagnosis=diagnosis,
        level=knowledge.schema.routes[entry.route].level,
        decision=entry.decision,
        rule=entry.rule,
        attempt_status=status,
        previous=previous,
        requested=level,
    )
