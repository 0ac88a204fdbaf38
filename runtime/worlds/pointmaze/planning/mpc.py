"""Model-predictive control as DINO-WM evaluates it in the maze: plan, execute the whole plan, observe, and plan again.

A trial ends after the first plan whose end is a success, or after ``plans`` of them. The true state is what verifies;
a planner reads only what it is given.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.observation import Observation
from runtime.planning.guided import SearchResult
from runtime.worlds.pointmaze.rollout import Rollout
from runtime.worlds.pointmaze.trials import Trial
from runtime.worlds.pointmaze.verdict import StateVerdict, judge

__all__ = ["ExecutedStep", "ImaginedPlan", "PlannedActions", "Planner", "TrialResult", "play"]

HORIZON = 5
"""Macro steps in a plan, DINO-WM's."""
PLANS = 4
"""Plans in a trial: DINO-WM sets no bound."""


@dataclass(frozen=True, slots=True, eq=False)
class ImaginedPlan:
    """A world model's prediction for a plan.

    ``paths`` (M, T + 1, 4) of its M members, step by step; ``margin`` and ``score`` (H, F) of the required facts after
    each macro step, NaN if there is no evidence of one.
    """

    paths: NDArray[np.float64]
    margin: NDArray[np.float64]
    score: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PlannedActions:
    """A plan: ``actions`` (T, 2), the prediction for its end (None without one), and how it was found."""

    actions: NDArray[np.float64]
    evaluations: int
    predicted: Observation | None = None
    searched: SearchResult | None = None
    foreseen: ImaginedPlan | None = None


class Planner(Protocol):
    """Makes the plans of one episode."""

    def begin(self, state: NDArray[np.float64], goal: NDArray[np.float64]) -> None:
        """Start an episode; a planner uses only the parts of ``state`` and ``goal`` (4,) that its row senses."""

    def plan(self, left: int, random: torch.Generator) -> PlannedActions:
        """The next plan; ``left`` is the number of plans of :data:`HORIZON` macro steps that time remains for."""
        ...

    def moved(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> None:
        """Record an executed plan: ``actions`` (T, 2) led through ``states`` (T + 1, 4)."""


@dataclass(frozen=True, slots=True, eq=False)
class ExecutedStep:
    """An executed plan: true ``states`` (T + 1, 4) and the verdict on the last."""

    made: PlannedActions
    states: NDArray[np.float64]
    verdict: StateVerdict
    seconds: float


@dataclass(frozen=True, slots=True, eq=False)
class TrialResult:
    """A trial; ``time`` is its length in plans of :data:`HORIZON`; a longer plan counts as several."""

    trial: Trial
    steps: tuple[ExecutedStep, ...]
    time: int

    @property
    def success(self) -> bool:
        """Whether the last plan ended at the target."""
        return bool(self.steps[-1].verdict.success)

    @property
    def figures(self) -> dict[str, Any]:
        """The outcome and cost, as plain values."""
        last = self.steps[-1].verdict
        return {
            "success": self.success,
            "plans": len(self.steps),
            "time": self.time,
            "distance": float(last.distance),
            "position": float(last.position),
            "velocity": float(last.velocity),
            "evaluations": sum(step.made.evaluations for step in self.steps),
        }

    @property
    def seconds(self) -> float:
        """Seconds spent on planning."""
        return round(sum(step.seconds for step in self.steps), 3)


def play(
    trial: Trial, planner: Planner, rollout: Rollout, random: torch.Generator, macro: int, plans: int = PLANS
) -> TrialResult:
    """Play ``trial``; a plan of two horizons takes the time of two plans."""
    state, steps, left = trial.start, list[ExecutedStep](), plans
    planner.begin(state, trial.goal)
    while left > 0:
        begun = time.perf_counter()
        made = planner.plan(left, random)
        seconds = time.perf_counter() - begun
        states = rollout.states(state, made.actions[None])[0]
        verdict = judge(states[-1], trial.goal)
        steps.append(ExecutedStep(made, states, verdict, seconds))
        left -= max(1, round(len(made.actions) / (macro * HORIZON)))
        if bool(verdict.success):
            break
        planner.moved(states, made.actions)
        state = states[-1]
    return TrialResult(trial, tuple(steps), plans - left)
