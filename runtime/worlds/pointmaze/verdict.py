"""The published verdict on a state of the maze: success, and how far from the goal it ended.

Source: DINO-WM ``env/pointmaze/point_maze_wrapper.py``, ``eval_state``. Success is of positions alone; the
distance counts velocities too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grounding.predicates.planar import apart
from runtime.worlds.pointmaze.maze import SUCCESS_RADIUS
from runtime.worlds.pointmaze.rollout import checked_states

__all__ = ["StateVerdict", "judge"]


@dataclass(frozen=True, slots=True, eq=False)
class StateVerdict:
    """Of states (...): whether each is a success, and its distance from the goal, whole and in parts."""

    success: NDArray[np.bool_]
    distance: NDArray[np.float64]  # over (x, y, vx, vy), metres and metres per second taken alike
    position: NDArray[np.float64]  # metres
    velocity: NDArray[np.float64]  # metres per second


def judge(states: NDArray[np.floating], goal: NDArray[np.floating]) -> StateVerdict:
    """Compare ``states`` (..., 4) with ``goal`` (4,) or goals (..., 4).

    Raises ``OntoError`` PMZ003 for other shapes, PMZ004 for numbers that are not finite.
    """
    ended, wanted = checked_states(states), checked_states(goal)
    position, velocity = apart(ended[..., :2], wanted[..., :2]), apart(ended[..., 2:], wanted[..., 2:])
    distance = np.asarray(np.linalg.norm(ended - wanted, axis=-1))
    return StateVerdict(np.asarray(position < SUCCESS_RADIUS), distance, position, velocity)
