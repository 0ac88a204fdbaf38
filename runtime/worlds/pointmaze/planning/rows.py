"""The rows of the PointMaze comparison: the score of a plan, the sensors, and the reaction to an unmet prediction.

The scores are declared in ``ontology/scores/pointmaze.ttl``; their weights were chosen on trials 10,000 and up, which
no table has. Every row has the same sampler and, but for those that say so, the same budget.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from grounding.world_model.device import device_named
from grounding.world_model.model import WorldModel, load_world_model
from grounding.world_model.pred import PredGrounder
from onto_compiler.knowledge import load_knowledge
from runtime.loop.routed import load_routed
from runtime.planning.cem import Budget, Sampling
from runtime.planning.mechanisms import again, resample_around_margin
from runtime.planning.packed import pack
from runtime.planning.scorers import Weights
from runtime.worlds.pointmaze.grounded import MazeFacts, required_facts
from runtime.worlds.pointmaze.maze import maze_named
from runtime.worlds.pointmaze.planning.mpc import Planner
from runtime.worlds.pointmaze.planning.planners import ByModel, ByTruth, Guidance, Randomly
from runtime.worlds.pointmaze.planning.sensing import FULL, POSITION, Sensor
from runtime.worlds.pointmaze.rollout import Rollout

__all__ = ["ROWS", "PlannerRow", "maze_rollout", "planner"]

MAZE = "u_maze"
BUDGET, SAMPLING = Budget(), Sampling()
ALLOWANCE = 3 * BUDGET.evaluations
"""Evaluations for improving a plan whose predicted facts are unmet."""
_LARGE = Budget(iterations=BUDGET.iterations + ALLOWANCE // BUDGET.samples)


@dataclass(frozen=True, slots=True)
class PlannerRow:
    """``score`` of a plan, by name; ``after`` an unmet prediction: nothing, or by which choice the search goes on."""

    score: str | None
    sensed: tuple[bool, ...] = FULL
    budget: Budget = BUDGET
    after: str = ""  # "", "guided", "drawn", "constant" or "undirected"
    truth: bool = False

    @property
    def learned(self) -> bool:
        """Whether it uses a world model."""
        return self.score is not None and not self.truth

    @property
    def extended(self) -> bool:
        """Whether a plan may take :data:`ALLOWANCE` evaluations more than the usual budget."""
        return bool(self.after) or self.budget == _LARGE

    @property
    def sees(self) -> str:
        """As in the published rows."""
        if self.truth:
            return "privileged-state, true-dynamics"
        return "predicted" if self.learned else "nothing"


_LEARNED = {
    "feature_images": PlannerRow("feature_images"),
    "feature_dinowm": PlannerRow("feature_dinowm"),
    "feature": PlannerRow("feature"),
    "event": PlannerRow("event"),
    "onto": PlannerRow("onto"),
    "onto_untyped": PlannerRow("onto_untyped"),
    "search": PlannerRow("onto", after="guided"),
    "random_search": PlannerRow("onto", after="drawn"),
    "constant_mechanism": PlannerRow("onto", after="constant"),
    "undirected_search": PlannerRow("onto", after="undirected"),
    "large": PlannerRow("onto", budget=_LARGE),
}
ROWS = {
    **_LEARNED,
    **{
        f"{name}_blind": PlannerRow(row.score, POSITION, row.budget, row.after)
        for name, row in _LEARNED.items()
        if name not in ("feature_images", "feature_dinowm", "constant_mechanism")
    },
    "ceiling": PlannerRow("onto", truth=True),
    "ceiling_large": PlannerRow("onto", budget=_LARGE, truth=True),
    "random": PlannerRow(None),
}
"""By name; ``_blind`` rows do not sense velocity, and have a history of three macro steps."""


def planner(name: str, folder: Path, device: str = "auto") -> Planner:
    """The planner of a row, with the world model in ``folder`` where it needs one; raises as its parts do.

    It computes on ``device``, by default on a GPU if there is one; rows without a model ignore it.
    """
    row, knowledge = ROWS[name], load_knowledge()
    if row.score is None:
        return Randomly(SAMPLING)
    weights = Weights.of(knowledge.schema.scores[row.score])
    required = required_facts(knowledge)
    if row.truth:
        facts = MazeFacts(maze_named(MAZE), required, knowledge)
        return ByTruth(maze_rollout(), facts, weights, row.budget, SAMPLING)
    device = device_named(device)
    model = _model(folder, device)
    sensor = Sensor(maze_named(MAZE), model.encoder, row.sensed, model.dynamics.history, device)
    observed = sensor.observes(required.facts, knowledge.schema)
    grounder = PredGrounder(model.facts, required.facts, required.source, observed)
    mechanisms = load_routed(knowledge.schema, "onto_evwm.mechanisms", "mechanism", "RUN010")
    guidance: dict[str, Callable[[], Guidance | None]] = {
        "": lambda: None,
        "guided": lambda: Guidance(knowledge, mechanisms, ALLOWANCE),
        "drawn": lambda: Guidance(knowledge, allowance=ALLOWANCE, instead=mechanisms),
        "constant": lambda: Guidance(
            knowledge, allowance=ALLOWANCE, instead={"resample_around_margin": resample_around_margin}
        ),
        "undirected": lambda: Guidance(knowledge, allowance=ALLOWANCE, instead={"again": again}),
    }
    return ByModel(model, sensor, grounder, required, weights, row.budget, SAMPLING, guidance[row.after]())


@lru_cache(maxsize=2)
def _model(folder: Path, device: str) -> WorldModel:
    model = load_world_model(folder, device)
    for network in (model.dynamics, model.events, model.facts):
        pack(network)
    return model


@lru_cache(maxsize=1)
def maze_rollout() -> Rollout:
    """The true dynamics."""
    return Rollout(maze_named(MAZE))
