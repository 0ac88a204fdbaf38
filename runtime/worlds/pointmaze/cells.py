"""The path through a maze's free cells, which depends only on its layout."""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.pointmaze.maze import Maze

__all__ = ["cell_way"]


def cell_way(maze: Maze, begin: NDArray[np.floating], end: NDArray[np.floating]) -> NDArray[np.float64]:
    """The centres (K, 2) of the cells on the shortest path from the cell of ``begin`` to that of ``end``, inclusive.

    ``begin`` and ``end`` are positions (2 or more); each counts as in the free cell whose centre is nearest. Empty if
    no path joins them.
    """
    cells = [tuple(cell) for cell in maze.cells.tolist()]
    first, last = (_nearest(maze, place) for place in (begin, end))
    before: dict[tuple[int, ...], tuple[int, ...] | None] = {cells[first]: None}
    queue = deque([cells[first]])
    while queue and cells[last] not in before:
        i, j = here = queue.popleft()
        for there in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if there in cells and there not in before:
                before[there] = here
                queue.append(there)
    if cells[last] not in before:
        return np.empty((0, 2))
    way: list[tuple[int, ...]] = []
    step: tuple[int, ...] | None = cells[last]
    while step is not None:
        way.append(step)
        step = before[step]
    return maze.centres[[cells.index(cell) for cell in reversed(way)]]


def _nearest(maze: Maze, place: NDArray[np.floating]) -> int:
    return int(np.linalg.norm(maze.centres - np.asarray(place)[:2], axis=1).argmin())
