"""Pi_R: from a diagnosis and where the loop stands to a declared route (paper, section 3). The rules decide."""

from __future__ import annotations

from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST
from runtime.loop.records import Diagnosis, RouteDecision

__all__ = ["route", "route_or_none"]


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
        OntoError: RUN004, where no routing rule speaks of the combination.
    """
    decision = route_or_none(diagnosis, knowledge, status, previous, level=level)
    if decision is None:
        where = f" after route `{local_name(previous)}`" if previous else ""
        raise OntoError.of(
            "RUN004",
            f"no route of the {level} level for `{local_name(diagnosis.failure)}` of `{diagnosis.fact}` "
            f"({local_name(status)}{where})",
            "declare a core:CorrectionRoute of this level that admits the failure and supports the predicate's kind",
        )
    return decision


def route_or_none(
    diagnosis: Diagnosis,
    knowledge: Knowledge,
    status: str = FIRST,
    previous: str | None = None,
    *,
    level: str = "state",
) -> RouteDecision | None:
    """As :func:`route`, and None where no rule speaks of the combination: so ends a route that names no successor."""
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
