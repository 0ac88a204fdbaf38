"""The published trials: random start and goal states, each pair drawn from a seed of its own.

Trial ``i`` of DINO-WM's PointMaze is drawn by ``RandomState(99 i + 1)`` (``plan.py``, seed 99): first the start, then
the goal. Positions are uniform over the corridors of the U, 0.2 metres off the walls' faces, velocities over the
range of the published data. The published table has trials 0 to 49; later numbers give fresh ones of the same kind.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import Maze

__all__ = ["PUBLISHED", "Trial", "trial", "trial_in", "trial_seed", "trials"]

PUBLISHED = 50
"""How many trials the published table has: numbers 0 to 49."""
_SEED, _OFFSET = 99, 1
_LOW, _HIGH = 0.5, 3.1
"""Of a position that is drawn, in x and in y, metres."""
_INNER, _OUTER = 1.1, 2.5
"""Where the two arms of the U end and begin in x; between them, y begins at ``_OUTER`` as well."""
_ROOM = 0.1
"""Between the ball and the walls where it is drawn, metres."""
_SPEED = 5.2262554
"""The greatest velocity that is drawn, either way, metres per second."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """``start`` and ``goal``: states (4,), metres and metres per second."""

    number: int
    start: NDArray[np.float64]
    goal: NDArray[np.float64]

    @property
    def seed(self) -> int:
        """The seed that it is drawn from."""
        return trial_seed(self.number)


def trial_seed(number: int) -> int:
    """The seed of a trial; raises ``OntoError`` PMZ005 for a number that has none."""
    seed = _SEED * number + _OFFSET
    if not 0 <= seed < 2**32 or number < 0:
        raise OntoError.of(
            "PMZ005", f"there is no trial {number}", f"trials are numbered from 0; 0 to {PUBLISHED - 1} are published"
        )
    return seed


def trial(number: int) -> Trial:
    """The trial of that number; raises ``OntoError`` PMZ005 for a number that has none."""
    random = np.random.RandomState(trial_seed(number))
    return Trial(number, _drawn(random), _drawn(random))


def trial_in(maze: Maze, number: int) -> Trial:
    """The trial of that number in ``maze``: the published one in DINO-WM's, and one of the same kind in any other.

    There, positions are uniform over the free space 0.1 metres off the walls. Raises as :func:`trial`.
    """
    if maze.name == "u_maze":
        return trial(number)
    random = np.random.RandomState(trial_seed(number))

    def drawn() -> NDArray[np.float64]:
        low_x, low_y, high_x, high_y = maze.extent
        while True:
            place = random.uniform((low_x, low_y), (high_x, high_y))
            if maze.free(place, _ROOM):
                return np.concatenate([place, random.uniform(-_SPEED, _SPEED, 2)])

    return Trial(number, drawn(), drawn())


def trials(numbers: Iterable[int]) -> tuple[Trial, ...]:
    """The trials of those numbers, in their order; raises as :func:`trial` does."""
    return tuple(trial(number) for number in numbers)


def _drawn(random: np.random.RandomState) -> NDArray[np.float64]:
    """A state (4,): positions are drawn over the square until one is in the U."""
    while True:
        x, y = random.uniform(_LOW, _HIGH), random.uniform(_LOW, _HIGH)
        if x <= _INNER or x >= _OUTER or y >= _OUTER:
            return np.array([x, y, random.uniform(-_SPEED, _SPEED), random.uniform(-_SPEED, _SPEED)])
