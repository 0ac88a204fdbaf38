"""What both loops share: how fast the gripper moves, and which entity each geom belongs to.

Without numba, so that the exact loop runs where the compiled one cannot: under a MuJoCo whose structures are unknown.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["GRIPPER_SPEED", "sides"]

GRIPPER_SPEED = 0.01  # per substep, models/grippers/panda_gripper.py


def sides(ngeom: int, entities: Sequence[NDArray[np.intp]]) -> NDArray[np.int16]:
    """The number of the entity that each geom belongs to, -1 for none: (ngeom,), or empty without entities."""
    if not entities:
        return np.empty(0, dtype=np.int16)
    side = np.full(ngeom, -1, dtype=np.int16)
    for number, geoms in enumerate(entities):
        side[geoms] = number
    return side
