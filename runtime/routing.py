"""Pi_R: from a diagnosis and where the loop stands to a declared route (paper, section 3). The rules decide."""

from __future__ import annotations

from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST
from runtime.records import Diagnosis, RouteDecision

__all__ = ["route"]


def route(
    diagnosis: Diagnosis, knowledge: Knowledge, status: str = FIRST, previous: str | None = None
) -> RouteDecision:
    """The route for ``diagnosis``, given the attempt ``status`` and the route that was tried ``previous``ly.

    Raises:
        OntoError: RUN004, where no routing rule speaks of the combination.
    """
    entry = knowledge.tables.routing.get((diagnosis.fact.predicate, diagnosis.failure, status, previous))
    if entry is None:
        where = f" after route `{local_name(previous)}`" if previous else ""
        raise OntoError.of(
            "RUN004",
            f"no route for `{local_name(diagnosis.failure)}` of `{diagnosis.fact}` ({local_name(status)}{where})",
            "declare a core:CorrectionRoute that admits the failure and supports the predicate's kind",
        )
    return RouteDecision(
        route=entry.route,
        diagnosis=diagnosis,
        level=knowledge.schema.routes[entry.route].level,
        decision=entry.decision,
        rule=entry.rule,
        attempt_status=status,
        previous=previous,
    )
