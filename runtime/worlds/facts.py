"""What a state shows of the task's facts, as plain records for ``info``; fields as in ``onto diagnose``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any

import mujoco

from grounding.observation import Observation
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema
from onto_compiler.tables import SATISFIED, STATUSES
from runtime.loop.diagnosis import diagnose_goal, evidence_status, unmet
from runtime.loop.routing import route
from runtime.wording import short_name, unit_of

__all__ = ["FactReporter", "GoalReport", "fact_rows"]

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class GoalReport:
    """``success`` is whether the goal holds; ``facts`` speak of the goal; ``failures`` diagnose what of it is unmet."""

    observation: Observation
    success: bool
    facts: tuple[Row, ...]
    failures: tuple[Row, ...]


class FactReporter:
    """Grounds and diagnoses the required facts of one scene."""

    def __init__(self, scene: Scene, required: RequiredABox, knowledge: Knowledge, *, level: str = "state") -> None:
        """Resolve every fact in ``scene``; failures are sent to routes of ``level``.

        Raises ``SIM001`` ff. where a fact names what the scene lacks.
        """
        self._required, self._knowledge, self._level = required, knowledge, level
        self._goal = SimGrounder(scene, required.facts, knowledge.schema)
        self._premise = SimGrounder(scene, required.premise, knowledge.schema)
        self._constant = _constants(required.facts, knowledge.schema)
        self._premises = _constants(required.premise, knowledge.schema)

    def report(self, data: mujoco.MjData, step: int = 0) -> GoalReport:
        """Ground and diagnose ``data``, which is only read."""
        required, knowledge = self._required, self._knowledge
        observation = self._goal.observe(data, step)
        failures = tuple(
            {
                **self._constant[found.index],
                "truth": found.truth,
                "status": knowledge.schema.labels[found.status],
                "margin": _number(found.margin),
                "limit": found.limit,
                "failure": short_name(found.failure, knowledge.schema),
                "route": short_name(route(found, knowledge, level=self._level).route, knowledge.schema),
                "rule": knowledge.schema.labels.get(found.rule, found.rule),
            }
            for found in diagnose_goal(required, observation, knowledge.tables)
        )
        return GoalReport(
            observation,
            not unmet(required, observation),
            self._rows(self._constant, required.facts, observation),
            failures,
        )

    def premise(self, data: mujoco.MjData) -> tuple[Row, ...]:
        """The facts that the task declares of its start, in the same form."""
        return self._rows(self._premises, self._required.premise, self._premise.observe(data))

    def _rows(self, constant: Sequence[Row], facts: Sequence[Fact], observation: Observation) -> tuple[Row, ...]:
        return tuple(
            {**known, **row}
            for known, row in zip(constant, fact_rows(facts, observation, self._knowledge.schema), strict=True)
        )


def fact_rows(facts: Sequence[Fact], observation: Observation, schema: Schema) -> Iterator[Row]:
    """What changes from state to state of each fact's row: truth, satisfaction, status, margin and its limit."""
    for i, code in enumerate(evidence_status(facts, observation)):
        yield {
            "truth": bool(observation.truth[i]),
            "satisfied": STATUSES[code] == SATISFIED,
            "status": schema.labels[STATUSES[code]],
            "margin": _number(observation.margin[i]),
            "limit": observation.limit[i],
        }


def _constants(facts: Sequence[Fact], schema: Schema) -> tuple[Row, ...]:
    return tuple(
        {
            "predicate": short_name(fact.predicate, schema),
            "arguments": tuple(argument.name for argument in fact.arguments),
            "polarity": fact.polarity,
            "unit": unit_of(fact, schema),
        }
        for fact in facts
    )


def _number(margin: float) -> float | None:
    """None for an undefined margin: NaN differs from itself, and infos are compared."""
    return None if isnan(margin) else float(margin)
