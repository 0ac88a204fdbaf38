"""The planners that are compared in PointMaze: with a world model, with the true dynamics, and random."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.world_model.model import WorldModel
from grounding.world_model.pred import ObservedGoal, PredGrounder
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from onto_compiler.schema import local_name
from runtime.planning.cem import Budget, Sampling, SamplingDistribution, search
from runtime.planning.guided import improve
from runtime.planning.mechanisms import Mechanism
from runtime.planning.problem import PlanningProblem
from runtime.planning.scorers import Weighted, Weights
from runtime.worlds.pointmaze.geodesic import Geodesic
from runtime.worlds.pointmaze.grounded import MazeFacts
from runtime.worlds.pointmaze.maze import ACTION_DIM, MACRO_STEPS
from runtime.worlds.pointmaze.planning.mpc import HORIZON, ImaginedPlan, PlannedActions, Planner
from runtime.worlds.pointmaze.planning.sensing import Sensor
from runtime.worlds.pointmaze.rollout import Rollout

__all__ = ["ByModel", "ByTruth", "Guidance", "Randomly"]

_STEPS = HORIZON * MACRO_STEPS


@dataclass(frozen=True, slots=True, eq=False)
class Guidance:
    """Improves a plan whose facts do not hold: see :func:`runtime.planning.guided.improve`."""

    knowledge: Knowledge
    mechanisms: Mapping[str, Mechanism] = field(default_factory=dict)
    allowance: int = 9000
    instead: Mapping[str, Mechanism] | None = None


class ByModel(Planner):
    """MPC with CEM in a world model, from pictures and the sensed proprioception."""

    def __init__(
        self,
        model: WorldModel,
        sensor: Sensor,
        grounder: PredGrounder,
        required: RequiredABox,
        weights: Weights,
        budget: Budget,
        sampling: Sampling,
        guidance: Guidance | None = None,
    ) -> None:
        self._model, self._sensor, self._grounder, self._required = model, sensor, grounder, required
        self._budget, self._sampling, self._guidance = budget, sampling, guidance
        self._scorer = Weighted(weights, model.dynamics, model.events, self._grounder)
        self._goal: ObservedGoal | None = None

    def begin(self, state: NDArray[np.float64], goal: NDArray[np.float64]) -> None:
        """Observe the goal, and clear earlier episodes."""
        self._sensor.begin(state)
        self._goal = self._sensor.goal(goal)

    def moved(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> None:
        """Store the sensed states."""
        self._sensor.moved(states, actions)

    def plan(self, left: int, random: torch.Generator) -> PlannedActions:
        """Search; then, with guidance, improve the result. Raises ``WM010`` if a feature is not finite."""
        if self._goal is None:
            raise RuntimeError("an episode begins before its first plan")
        question = PlanningProblem(
            self._model.dynamics, self._grounder, self._scorer, self._sensor.history(), self._goal, self._budget,
            self._sampling, left * HORIZON, self._sensor.between(),
        )  # fmt: skip
        region = SamplingDistribution.everywhere(_STEPS, ACTION_DIM, self._sampling, question.begin.device)
        with torch.no_grad():
            found = search(question.cost, region, self._budget, self._sampling, random, judge=question.judge())
        if self._guidance is None:
            seen, _ = question.judged(found)
            return PlannedActions(
                _array(found.actions), found.evaluations, seen, None, _foreseen(question, found.actions)
            )
        guidance = self._guidance
        better = improve(
            question, found, self._required, guidance.knowledge, guidance.mechanisms, guidance.allowance, random,
            guidance.instead,
        )  # fmt: skip
        spent = found.evaluations + better.evaluations
        chosen = better.found.actions
        return PlannedActions(_array(chosen), spent, better.observation, better, _foreseen(question, chosen))


class ByTruth(Planner):
    """The upper bound: the same search on the true dynamics, scored by true facts and the true remaining distance."""

    def __init__(
        self, rollout: Rollout, facts: MazeFacts, weights: Weights, budget: Budget, sampling: Sampling
    ) -> None:
        self._rollout, self._facts, self._way = rollout, facts, Geodesic(rollout.maze)
        self._weights, self._budget, self._sampling = weights, budget, sampling
        names = [local_name(fact.predicate) for fact in facts.required.facts]
        self._margins = np.array([float(weights.margins.get(name, 0.0)) for name in names])
        self._state = self._target = np.zeros(4)

    def begin(self, state: NDArray[np.float64], goal: NDArray[np.float64]) -> None:
        """Store both."""
        self._state, self._target = state, goal

    def moved(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> None:
        """Continue from the last state."""
        del actions
        self._state = states[-1]

    def plan(self, left: int, random: torch.Generator) -> PlannedActions:
        """Search."""
        del left
        found = search(
            self._cost,
            SamplingDistribution.everywhere(_STEPS, ACTION_DIM, self._sampling),
            self._budget,
            self._sampling,
            random,
        )
        return PlannedActions(_array(found.actions), found.evaluations)

    def _cost(self, actions: torch.Tensor) -> torch.Tensor:
        ends = self._rollout.states(self._state, actions.double().numpy())[:, -1]
        way = self._way.distance(ends, self._target)
        gap = np.linalg.norm(ends[:, :2] - self._target[:2], axis=1)
        lost = np.where(np.isfinite(way), way, gap + 10.0)  # pressed into a wall: no path from there
        margins = self._facts.label(ends, self._target).margin @ self._margins
        return torch.from_numpy(self._weights.remaining * lost - margins)


class Randomly(Planner):
    """Random actions, drawn like a search's first candidates."""

    def __init__(self, sampling: Sampling) -> None:
        self._sampling = sampling

    def begin(self, state: NDArray[np.float64], goal: NDArray[np.float64]) -> None:
        """Do nothing."""

    def moved(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> None:
        """Do nothing."""

    def plan(self, left: int, random: torch.Generator) -> PlannedActions:
        """One candidate."""
        del left
        drawn = torch.randn((_STEPS, ACTION_DIM), generator=random) * self._sampling.deviation
        return PlannedActions(_array(drawn.clamp(-1, 1)), 1)


def _foreseen(question: PlanningProblem, actions: torch.Tensor) -> ImaginedPlan:
    """The prediction for ``actions`` (T, 2)."""
    with torch.no_grad():
        imagined = question.imagine(actions[None])
        facts = question.grounder.ground(imagined, question.goal, every=True)
    margin, score = (np.where(facts.observed, _array(each[0]), np.nan) for each in (facts.margin, facts.score))
    return ImaginedPlan(_array(imagined.path[:, 0]), margin, score)


def _array(values: torch.Tensor) -> NDArray[np.float64]:
    return np.asarray(values.detach().cpu().double().numpy())
