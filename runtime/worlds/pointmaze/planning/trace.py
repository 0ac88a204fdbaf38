"""A played trial as an episode: each executed plan with its predicted and its simulated ABox, and the attempts.

An attempt is a mechanism that a rule chose for a diagnosis of the best plan so far; its proposal was only predicted. A
search without guidance makes no attempts.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from grounding.observation import Observation
from onto_compiler.knowledge import Knowledge
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import diagnose_goal, satisfied
from runtime.loop.records import Application, Attempt, Episode, ExecutedPlan, Prediction, Proposal, Verification
from runtime.worlds.pointmaze.grounded import MazeFacts
from runtime.worlds.pointmaze.planning.mpc import ExecutedStep, TrialResult
from runtime.worlds.pointmaze.world import SUITE

__all__ = ["SUITE", "TrialRecorder"]

_JUDGED = "at_target"
"""The predicate whose truth the published success is."""


@dataclass(frozen=True, slots=True, eq=False)
class TrialRecorder:
    """Records trials that ``planner`` (the name of a row) played with ``seed``."""

    facts: MazeFacts
    knowledge: Knowledge
    planner: str
    seed: int
    provenance: Sequence[tuple[str, Any]] = ()

    def episode(self, played: TrialResult) -> Episode:
        """The record of ``played``; it is unresolved unless the simulator's state was accepted."""
        required, trial = self.facts.required, played.trial
        declared = MazeFacts(self.facts.maze, replace(required, facts=required.premise), self.knowledge)
        premise = declared.observe(trial.start, trial.goal)
        attempts, plans = list[Attempt](), list[ExecutedPlan]()
        begun = 0
        for index, step in enumerate(played.steps):
            attempts += self._attempts(step, begun, index, len(attempts))
            plans.append(self._plan(step, played, begun, index))
            begun = plans[-1].simulated.step
        return Episode(
            task=required.task,
            suite=SUITE,
            state_index=trial.number,
            seed=self.seed,
            required=required,
            initial=self.facts.observe(trial.start, trial.goal),
            premise=premise,
            premise_holds=bool(satisfied(required.premise, premise).all()),
            attempts=tuple(attempts),
            final=plans[-1].simulated,
            outcome="accepted" if played.success else "unresolved",
            verification=plans[-1].verification,
            provenance=tuple(self.provenance),
            plans=tuple(plans),
        )

    def _plan(self, step: ExecutedStep, played: TrialResult, begun: int, index: int) -> ExecutedPlan:
        required, tables = self.facts.required, self.knowledge.tables
        steps = len(step.made.actions)
        seen = step.made.predicted
        predicted = None if seen is None else _later(seen, begun)
        judged = next(fact for fact in required.facts if local_name(fact.predicate) == _JUDGED)
        return ExecutedPlan(
            index=index,
            planner=self.planner,
            evaluations=step.made.evaluations,
            steps=steps,
            predicted=predicted,
            diagnoses=() if predicted is None else diagnose_goal(required, predicted, tables),
            simulated=self.facts.observe(step.states[-1], played.trial.goal, begun + steps),
            verification=Verification(str(judged.native), bool(step.verdict.success)),
        )

    def _attempts(self, step: ExecutedStep, begun: int, plan: int, first: int) -> Iterator[Attempt]:
        """The attempts to improve the plan of ``step``, numbered from ``first``."""
        searched = step.made.searched
        offered = Counter[tuple[int, str]]()
        for number, tried in enumerate(searched.tried if searched is not None else ()):
            if tried.decision is None:
                continue  # no diagnosis guides this search
            application = prediction = None
            if tried.observation is not None:
                key = (tried.diagnosis.index, tried.mechanism)
                proposal = Proposal(tried.mechanism, tried.mechanism, offered[key], np.empty(0), ())
                offered[key] += 1
                application = Application(proposal, "none", 0.0)
                prediction = Prediction(_later(tried.observation, begun), tried.better, tried.evaluations)
            before = _later(tried.before, begun)
            yield Attempt(
                index=first + number,
                observation=before,
                diagnoses=diagnose_goal(self.facts.required, before, self.knowledge.tables),
                selected=tried.decision,
                application=application,
                plan=plan,
                prediction=prediction,
            )


def _later(seen: Observation, steps: int) -> Observation:
    """``seen``, counted from the beginning of the trial: a planner counts from the beginning of its plan."""
    return replace(seen, step=seen.step + steps)
