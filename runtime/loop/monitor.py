"""The unmet facts of a goal in a running simulation, cheap enough for every control step (about a microsecond).

The records are those of :func:`runtime.loop.diagnosis.diagnose_goal` without margins, which cost a hundred times as
much and are computed only on request. The grounder decides the truth, the rules the failure class; the result for a
pattern of truth values is computed once and cached.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.observation import Evidence, Observation, stack
from grounding.sim import SimGrounder
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.tables import RuleTables
from runtime.loop.diagnosis import diagnose_goal, satisfied
from runtime.loop.records import Diagnosis

__all__ = ["GoalMonitor", "Unmet"]

KEPT = 4096  # patterns; a goal of a dozen facts has no more


@dataclass(frozen=True, slots=True)
class Unmet:
    """A :class:`~runtime.loop.records.Diagnosis` without a margin."""

    fact: Fact
    index: int
    failure: str
    status: str
    truth: bool
    rule: str
    priority: int


class GoalMonitor:
    """Diagnoses one goal in successive states of its grounder's scene."""

    def __init__(self, required: RequiredABox, grounder: SimGrounder, tables: RuleTables) -> None:
        """``grounder`` grounds ``required.facts``."""
        self._required, self._grounder, self._tables = required, grounder, tables
        self._seen: dict[bytes, tuple[Unmet, ...]] = {}
        # A margin decides between alternatives, against a threshold, and where it may contradict the truth.
        plain = all(fact.threshold == 0.0 for fact in required.facts) and all(grounder.planned)
        self._by_truth = plain and not required.alternatives

    def unmet(self, data: mujoco.MjData) -> tuple[Unmet, ...]:
        """The unmet facts of the nearest alternative in ``data``, a forwarded state; empty if the goal holds.

        Raises ``SIM003``, ``SIM004``, ``RUN003`` as grounding and diagnosis do.
        """
        if not self._by_truth:
            return _without_margins(self.diagnose(data))
        pattern = self._grounder.pattern(data)
        try:
            return self._seen[pattern]
        except KeyError:
            return self._meet(pattern)

    def satisfied(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        """Whether each required fact holds in ``data``, as :func:`runtime.loop.diagnosis.satisfied`; shape (n,).

        Raises ``SIM003``, ``SIM004`` as grounding does.
        """
        facts = self._required.facts
        if self._by_truth:
            return satisfied(facts, _of_truths(self._grounder.pattern(data)))
        return satisfied(facts, self._grounder.observe(data))

    def diagnose(self, data: mujoco.MjData, step: int = 0) -> tuple[Diagnosis, ...]:
        """The same with margins, as complete records."""
        return diagnose_goal(self._required, self._grounder.observe(data, step), self._tables)

    def _meet(self, pattern: bytes) -> tuple[Unmet, ...]:
        observation = _of_truths(pattern)
        if len(self._seen) >= KEPT:
            self._seen.clear()
        found = self._seen[pattern] = _without_margins(diagnose_goal(self._required, observation, self._tables))
        return found


def _of_truths(pattern: bytes) -> Observation:
    return stack("sim", 0, [Evidence(bool(truth)) for truth in pattern])


def _without_margins(found: Sequence[Diagnosis]) -> tuple[Unmet, ...]:
    return tuple(Unmet(d.fact, d.index, d.failure, d.status, d.truth, d.rule, d.priority) for d in found)
