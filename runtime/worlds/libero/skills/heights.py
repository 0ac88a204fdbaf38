"""Height maps: the height at which a shape that is lowered from above comes to rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["CELL", "Relief", "relief_of", "underside"]

Array = NDArray[np.float64]

CELL = 0.006  # metres


@dataclass(frozen=True, slots=True, eq=False)
class Relief:
    """``top[i, j]``: the largest z over the cell whose lower corner is ``origin + CELL * (i, j)``, or -inf."""

    origin: Array  # (2,)
    top: Array

    def drop(self, under: Array, corner: Array) -> float:
        """The largest z of this relief minus ``under`` (a, b): the height that the shape's zero comes to rest at.

        ``corner`` (2,) is where the lower corner of ``under`` lies. Minus infinity over nothing.
        """
        i, j = np.round((corner - self.origin) / CELL).astype(int)
        height, width = self.top.shape
        first, last = max(0, -i), min(under.shape[0], height - i)
        left, right = max(0, -j), min(under.shape[1], width - j)
        if first >= last or left >= right:
            return -np.inf
        below = self.top[i + first : i + last, j + left : j + right]
        return float((below - under[first:last, left:right]).max())


def relief_of(points: Array, centre: Array, radius: float) -> Relief:
    """The relief of ``points`` (n, 3) in a square of half side ``radius`` (m) around ``centre``."""
    origin = np.floor((centre[:2] - radius) / CELL) * CELL
    size = int(np.ceil(2 * radius / CELL)) + 1
    top = np.full((size, size), -np.inf)
    cells = np.floor((points[:, :2] - origin) / CELL).astype(int)
    inside = ((cells >= 0) & (cells < size)).all(axis=1)
    np.maximum.at(top, tuple(cells[inside].T), points[inside, 2])
    return Relief(origin, top)


def underside(cloud: Array) -> tuple[Array, Array]:
    """The lowest z of ``cloud`` (n, 3) by cell, +inf where it has none, and where the lower corner of that map lies."""
    corner = np.floor(cloud[:, :2].min(axis=0) / CELL) * CELL
    cells = np.round(np.floor((cloud[:, :2] - corner) / CELL)).astype(int)
    under = np.full(cells.max(axis=0) + 1, np.inf)
    np.minimum.at(under, tuple(cells.T), cloud[:, 2])
    return under, corner
