"""The proprioception of the model: hand and fingers from LIBERO's observations.

It has nothing of objects. A rotation vector is discontinuous at large angles, so two axes of the hand replace it; the
speeds are differences to the observation one control step before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["HIDDEN", "PLACES", "SIZE", "sensed"]

SIZE = 16
PLACES = 3
"""The first coordinates are positions, in metres."""
HIDDEN = 5
"""The last coordinates are speeds, which a robot may not sense."""
_RATE = 20.0  # control steps a second

Array = NDArray[np.float64]


def sensed(position: Array, rotation: Array, fingers: Array) -> NDArray[np.float32]:
    """Rows (T, SIZE) of ``position`` (T, 3) in metres, ``rotation`` (T, 3), a rotation vector, ``fingers`` (T, 2).

    Position, the hand's first two axes, fingers, and the speeds of position and fingers a second.
    """
    speeds = np.zeros((len(position), HIDDEN))
    speeds[1:] = np.diff(np.concatenate([position, fingers], axis=1), axis=0) * _RATE
    return np.concatenate([position, _axes(rotation), fingers, speeds], axis=1).astype(np.float32)


def _axes(rotation: Array) -> Array:
    """The first two columns (T, 6) of the matrices of rotation vectors, by Rodrigues's formula."""
    angle = np.linalg.norm(rotation, axis=1)[:, None, None]
    x, y, z = (rotation / np.maximum(angle[:, 0], 1e-12)).T
    none = np.zeros_like(x)
    cross = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=1).reshape(-1, 3, 3)
    matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return np.concatenate([matrix[:, :, 0], matrix[:, :, 1]], axis=1)
