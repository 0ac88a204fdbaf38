"""Training data of the maze: random actions from random states, determined by split, seed and number only.

DINO-WM trains on 2,000 random trajectories of 100 environment steps, and does not publish what drew their actions. Here
each trajectory starts anywhere in the free cells at any velocity of the published range, and draws a persistence and a
strength of its own: from white noise, which a planner's first candidates are, to pushes that last a second, which its
plans become. Two fifths of the states touch a wall.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal, get_args

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import ACTION_DIM, STATE_DIM, Maze
from runtime.worlds.pointmaze.rollout import Rollout

__all__ = ["Split", "Trajectories", "TrajectoryConfig", "collect", "load"]

Split = Literal["train", "validation", "test"]
_TAG = 0x0D1A0
"""Prefix of split and seed, so that no trial or planner draws the same numbers."""
_SPEED = 5.2262554
"""The greatest velocity of a start, either way, metres per second: that of the published states."""
_PERSISTENCE = (0.0, 0.5, 0.8, 0.95)
"""The range of the correlation of successive actions."""
_STRENGTH = (0.3, 1.0)
"""The range of an action's standard deviation, before it is clipped to [-1, 1]."""
_CHUNK = 500
"""Trajectories that are rolled out at once."""


@dataclass(frozen=True, slots=True)
class TrajectoryConfig:
    """Everything that determines trajectories."""

    maze: str
    split: Split
    seed: int
    count: int
    steps: int


@dataclass(frozen=True, slots=True, eq=False)
class Trajectories:
    """``states`` (N, T + 1, 4), metres and metres per second; ``actions`` (N, T, 2) in [-1, 1]."""

    states: NDArray[np.float64]
    actions: NDArray[np.float64]
    source: TrajectoryConfig

    def save(self, path: Path) -> None:
        """Write a compressed ``.npz``; raises ``OntoError`` PMZ006 if ``path`` cannot be written."""
        card = json.dumps({**asdict(self.source), "mujoco": mujoco.__version__})
        try:
            with path.open("wb") as file:
                np.savez_compressed(file, states=self.states, actions=self.actions, card=np.array(card))
        except OSError as error:
            raise OntoError.of("PMZ006", f"cannot write trajectories: {error}", file=str(path)) from None


def collect(
    maze: Maze, count: int = 2000, steps: int = 100, seed: int = 0, split: Split = "train", threads: int = 1
) -> Trajectories:
    """``count`` trajectories of ``steps`` environment steps.

    Each is decided by ``split``, ``seed`` and its number: fewer of them are the first of more, and the number of
    threads changes nothing. Raises ``OntoError`` PMZ003 for counts that are negative.
    """
    if count < 0 or steps < 0 or seed < 0:
        message = f"found {count} trajectories of {steps} steps, seed {seed}"
        raise OntoError.of("PMZ003", message, "counts, steps and seeds are 0 or more")
    states, actions = np.empty((count, steps + 1, STATE_DIM)), np.empty((count, steps, ACTION_DIM))
    rollout = Rollout(maze, threads)
    for first in range(0, count, _CHUNK):
        numbers = range(first, min(first + _CHUNK, count))
        drawn = [_drawn(maze, steps, (_TAG, get_args(Split).index(split), seed, number)) for number in numbers]
        rows = slice(numbers.start, numbers.stop)
        actions[rows] = [pushes for _, pushes in drawn]
        states[rows] = rollout.states(np.array([start for start, _ in drawn]), actions[rows])
    return Trajectories(states, actions, TrajectoryConfig(maze.name, split, seed, count, steps))


def load(path: Path) -> Trajectories:
    """The trajectories of a file that :meth:`Trajectories.save` wrote; raises ``OntoError`` PMZ006 for any other."""
    try:
        with np.load(path, allow_pickle=False) as file:
            card = json.loads(str(file["card"]))
            made_by = card.pop("mujoco")
            found = Trajectories(file["states"], file["actions"], TrajectoryConfig(**card))
    except (OSError, EOFError, ValueError, KeyError, TypeError, AttributeError, zipfile.BadZipFile) as error:
        raise OntoError.of("PMZ006", f"no trajectories can be read from it: {error}", file=str(path)) from None
    count, steps = found.source.count, found.source.steps
    wanted = ((count, steps + 1, STATE_DIM), (count, steps, ACTION_DIM))
    if (found.states.shape, found.actions.shape) != wanted:
        message = f"states {found.states.shape} and actions {found.actions.shape}, but its card says {wanted}"
        raise OntoError.of("PMZ006", message, f"made with MuJoCo {made_by}; collect them again", file=str(path))
    return found


def _drawn(maze: Maze, steps: int, key: tuple[int, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A start (4,) and the actions (T, 2) of one trajectory."""
    random = np.random.default_rng(key)
    place = _anywhere(maze, random)
    while not maze.free(place):
        place = _anywhere(maze, random)
    start = np.concatenate([place, random.uniform(-_SPEED, _SPEED, 2)])
    persistence = _PERSISTENCE[random.integers(len(_PERSISTENCE))]
    noise = random.normal(size=(steps, ACTION_DIM)) * random.uniform(*_STRENGTH)
    pushes = np.empty((steps, ACTION_DIM))
    fresh = np.sqrt(1 - persistence**2)  # keeps the standard deviation, whatever stays of the last action
    for step in range(steps):
        pushes[step] = persistence * pushes[step - 1] + fresh * noise[step] if step else noise[0]
    return start, np.clip(pushes, -1.0, 1.0)


def _anywhere(maze: Maze, random: np.random.Generator) -> NDArray[np.float64]:
    """A place (2,) in the free cells, near a wall perhaps."""
    return np.asarray(maze.centres[random.integers(len(maze.centres))] + random.uniform(-0.5, 0.5, 2))
