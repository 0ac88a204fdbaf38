"""The observed facts of a task in one state, as plain records for ``info``; fields as in ``onto diagnose``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco

from grounding.observation import Observation, stack
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.diagnosis import diagnose_goal, unmet
from runtime.loop.routing import route
from runtime.trace.fact_rows import OBSERVED, UNMET, RoutedDiagnosis, seen_facts

__all__ = ["FactReporter", "GoalReport", "fact_rows"]

Row = dict[str, Any]


@dataclass(frozen=True, slots=True)
class GoalReport:
    """``success``: whether the goal holds; ``facts``: those of the goal; ``failures``: diagnoses of its unmet facts."""

    observation: Observation
    success: bool
    facts: tuple[Row, ...]
    failures: tuple[Row, ...]


class FactReporter:
    """Grounds and diagnoses the required facts of one scene."""

    def __init__(self, scene: Scene, required: RequiredABox, knowledge: Knowledge, *, level: str = "state") -> None:
        """Resolve every fact in ``scene``; failures are sent to routes of ``level``.

        Raises ``SIM001`` ff. if a fact names what the scene lacks.
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
                **self._constant[each.index],
                **_FAILURE.of(RoutedDiagnosis(each, route(each, knowledge, level=self._level).route), knowledge.schema),
            }
            for each in diagnose_goal(required, observation, knowledge.tables)
        )
        return GoalReport(
            observation,
            not unmet(required, observation),
            self._rows(self._constant, required.facts, observation),
            failures,
        )

    def premise(self, data: mujoco.MjData) -> tuple[Row, ...]:
        """The task's declared initial facts, in the same form."""
        return self._rows(self._premises, self._required.premise, self._premise.observe(data))

    def _rows(self, constant: Sequence[Row], facts: Sequence[Fact], observation: Observation) -> tuple[Row, ...]:
        return tuple(
            {**known, **row}
            for known, row in zip(constant, fact_rows(facts, observation, self._knowledge.schema), strict=True)
        )


# The columns that are constant in a scene, and those that depend on the state.
_KNOWN = OBSERVED.pick("predicate", "arguments", "polarity", "unit")
_SEEN = OBSERVED.pick("truth", "satisfied", "status", "margin", "limit")
_FAILURE = UNMET.pick("truth", "status", "margin", "limit", "failure", "route", "rule")


def fact_rows(facts: Sequence[Fact], observation: Observation, schema: Schema) -> Iterator[Row]:
    """What changes from state to state of each fact's row: truth, satisfaction, status, margin and its limit."""
    return (_SEEN.of(each, schema) for each in seen_facts(facts, observation))


def _constants(facts: Sequence[Fact], schema: Schema) -> tuple[Row, ...]:
    rows = (_KNOWN.of(each, schema) for each in seen_facts(facts, stack("sim", 0, [None] * len(facts))))
    return tuple({**row, "arguments": tuple(row["arguments"])} for row in rows)
