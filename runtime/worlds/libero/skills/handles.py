"""Handles: the part that protrudes farthest in a direction, and its orientation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Handle", "protruding"]

Array = NDArray[np.float64]

THICK = 0.014  # metres behind the foremost point that still belong to the handle


@dataclass(frozen=True, slots=True, eq=False)
class Handle:
    """``centre`` (3,) of what protrudes, its ``long`` (3,) and ``thin`` (3,) unit vectors across ``out``, and extents.

    ``length`` and ``thickness`` are full extents in metres along them; ``depth`` is along ``out``.
    """

    centre: Array
    out: Array
    long: Array
    thin: Array
    length: float
    thickness: float
    depth: float


def protruding(points: Array, out: Array, thick: float = THICK) -> Handle:
    """The part of ``points`` (n, 3) within ``thick`` of the foremost along the unit vector ``out`` (3,)."""
    along = points @ out
    front = points[along > along.max() - thick]
    flat = front - np.outer(front @ out, out)
    middle = flat.mean(axis=0)
    _, _, axes = np.linalg.svd(flat - middle, full_matrices=False)
    long = axes[0]
    thin = np.cross(out, long)
    low, high = _extent(front @ long), _extent(front @ thin)
    depth = _extent(front @ out)
    centre = 0.5 * (sum(low) * long + sum(high) * thin + sum(depth) * out)
    return Handle(centre, out, long, thin, low[1] - low[0], high[1] - high[0], depth[1] - depth[0])


def _extent(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())
