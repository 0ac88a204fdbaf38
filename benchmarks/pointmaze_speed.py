"""How long PointMaze takes: data, training and the published table from nothing, the table alone, and the grounding."""

from __future__ import annotations

import tempfile
import time
from functools import partial
from itertools import product
from os import cpu_count
from pathlib import Path
from statistics import median

import torch

from grounding.world_model.model import load_world_model
from grounding.world_model.pred import ObservedGoal, PredGrounder
from onto_compiler.knowledge import load_knowledge
from onto_compiler.pool import map_over_processes
from runtime.training import STAGES
from runtime.training.stages import TrainingDir
from runtime.worlds.pointmaze.grounded import required_facts
from runtime.worlds.pointmaze.maze import ACTION_DIM, MACRO_STEPS, STATE_DIM
from runtime.worlds.pointmaze.planning.mpc import play
from runtime.worlds.pointmaze.planning.rows import maze_rollout, planner
from runtime.worlds.pointmaze.training import MazeTrainingConfig, train
from runtime.worlds.pointmaze.trials import PUBLISHED, trial

__all__ = ["from_nothing_minutes", "grounding_ms", "table_minutes"]

TABLE = ("feature", "event", "onto", "search")
"""The paper's four rows."""
_SEED = 90
"""Of the model that is trained to be timed: none that ships."""
_CANDIDATES, _HORIZON = 300, 5
_REPEATS = 50


def grounding_ms(folder: Path) -> float:
    """Milliseconds, on one thread, from 300 imagined candidates to the facts and scores after each of 5 macro steps."""
    torch.set_num_threads(1)
    model = load_world_model(folder)
    grounder = PredGrounder(model.facts, required_facts(load_knowledge()).facts)
    random = torch.Generator().manual_seed(0)
    width = model.encoder.shape[0]
    begin, actions = torch.rand(STATE_DIM, generator=random), _drawn(random)
    features = torch.rand(width, generator=random)
    goal = ObservedGoal(features, begin, torch.ones(STATE_DIM, dtype=torch.bool))
    with torch.no_grad():
        imagined = model.dynamics.imagine(features, begin, actions)
        taken = []
        for _ in range(_REPEATS):
            begun = time.perf_counter()
            grounder.ground(imagined, goal, every=True)
            taken.append(time.perf_counter() - begun)
    return 1000 * median(taken)


def table_minutes(folder: Path) -> float:
    """Minutes of the published trials under the paper's four rows, on every core."""
    begun = time.perf_counter()
    for _ in map_over_processes(partial(_play, folder), list(product(TABLE, range(PUBLISHED))), cpu_count() or 1):
        pass
    return (time.perf_counter() - begun) / 60


def from_nothing_minutes() -> tuple[float, float]:
    """Minutes of data and training of one model, and of the table with it."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, begun = Path(scratch), time.perf_counter()
        torch.set_num_threads(cpu_count() or 1)
        for stage in STAGES:
            train(stage, MazeTrainingConfig(seed=_SEED), TrainingDir(folder), "", "", lambda _text: None)
        return (time.perf_counter() - begun) / 60, table_minutes(folder)


def _play(folder: Path, job: tuple[str, int]) -> None:
    torch.set_num_threads(1)
    name, number = job
    play(trial(number), planner(name, folder), maze_rollout(), torch.Generator().manual_seed(number), MACRO_STEPS)


def _drawn(random: torch.Generator) -> torch.Tensor:
    return torch.rand((_CANDIDATES, _HORIZON, MACRO_STEPS, ACTION_DIM), generator=random) * 2 - 1
