"""The rows that PointMaze compares: which terms score a plan, what is sensed, and what follows an unmet prediction.

Weights are chosen on trials 10,000 and up, which no table has. Every row has the same sampler and, but for those that
say so, the same budget.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from grounding.world_model.model import WorldModel, load_world_model
from onto_compiler.knowledge import load_knowledge
from runtime.planning.cem import Budget, Sampling
from runtime.planning.mechanisms import again
from runtime.planning.pointmaze.mpc import Planner
from runtime.planning.pointmaze.planners import ByModel, ByTruth, Guidance, Randomly
from runtime.planning.pointmaze.sensing import FULL, POSITION, Sensor
from runtime.planning.scorers import Weights
from runtime.pointmaze.grounded import MazeFacts, required_facts
from runtime.pointmaze.maze import maze_named
from runtime.pointmaze.rollout import Rollout
from runtime.routed import load_routed

__all__ = ["ROWS", "Row", "maze_rollout", "planner"]

MAZE = "u_maze"
BUDGET, SAMPLING = Budget(), Sampling()
ALLOWANCE = 3 * BUDGET.evaluations
"""Evaluations that follow a plan whose predicted facts miss the goal."""
_LARGE = Budget(iterations=BUDGET.iterations + ALLOWANCE // BUDGET.samples)

FEATURE = Weights(feature=1.0, proprio=1.0)
EVENT = Weights(feature=1.0, proprio=5.0, remaining=1.0, success=0.5, feasibility=0.2, consistency=0.2, uncertainty=0.5)
ONTO = Weights(
    feature=0.1, proprio=0.1, remaining=1.0, uncertainty=0.5, margins={"at_target": 0.3, "velocity_matches": 0.3}
)
UNTYPED = Weights(
    feature=0.1, proprio=0.1, remaining=1.0, uncertainty=0.5, scores={"at_target": 0.3, "velocity_matches": 0.3}
)


@dataclass(frozen=True, slots=True)
class Row:
    """``weights`` of a plan's score; ``after`` an unmet prediction: nothing, what the rules say, or search anew."""

    weights: Weights | None
    sensed: tuple[bool, ...] = FULL
    budget: Budget = BUDGET
    after: str = ""  # "", "guided" or "undirected"
    truth: bool = False

    @property
    def learned(self) -> bool:
        """Whether a world model is asked."""
        return self.weights is not None and not self.truth

    @property
    def sees(self) -> str:
        """As a published row says it."""
        if self.truth:
            return "privileged-state, true-dynamics"
        return "predicted" if self.learned else "nothing"


_LEARNED = {
    "feature_images": Row(Weights(feature=1.0)),
    "feature": Row(FEATURE),
    "event": Row(EVENT),
    "onto": Row(ONTO),
    "onto_untyped": Row(UNTYPED),
    "search": Row(ONTO, after="guided"),
    "undirected_search": Row(ONTO, after="undirected"),
    "large": Row(ONTO, budget=_LARGE),
}
ROWS = {
    **_LEARNED,
    **{
        f"{name}_blind": Row(row.weights, POSITION, row.budget, row.after)
        for name, row in _LEARNED.items()
        if name != "feature_images"
    },
    "ceiling": Row(ONTO, truth=True),
    "ceiling_large": Row(ONTO, budget=_LARGE, truth=True),
    "random": Row(None),
}
"""By name; ``_blind`` rows do not sense velocity, and have a history of three macro steps."""


def planner(name: str, folder: Path) -> Planner:
    """The planner of a row, with the world model in ``folder`` where it needs one; raises as its parts do."""
    row, knowledge = ROWS[name], load_knowledge()
    if row.weights is None:
        return Randomly(SAMPLING)
    required = required_facts(knowledge)
    if row.truth:
        facts = MazeFacts(maze_named(MAZE), required, knowledge)
        return ByTruth(maze_rollout(), facts, row.weights, row.budget, SAMPLING)
    model = _model(folder)
    sensor = Sensor(maze_named(MAZE), model.encoder, row.sensed, model.dynamics.history)
    mechanisms = load_routed(knowledge.schema, "onto_evwm.mechanisms", "mechanism", "RUN010")
    guidance: dict[str, Callable[[], Guidance | None]] = {
        "": lambda: None,
        "guided": lambda: Guidance(knowledge, mechanisms, ALLOWANCE),
        "undirected": lambda: Guidance(knowledge, allowance=ALLOWANCE, instead=again),
    }
    return ByModel(model, sensor, required, row.weights, row.budget, SAMPLING, guidance[row.after]())


@lru_cache(maxsize=2)
def _model(folder: Path) -> WorldModel:
    return load_world_model(folder)


@lru_cache(maxsize=1)
def maze_rollout() -> Rollout:
    """The true dynamics."""
    return Rollout(maze_named(MAZE))
