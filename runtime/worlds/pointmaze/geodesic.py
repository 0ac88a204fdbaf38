"""The shortest path of the ball between two positions in a maze: straight lines around the corners of its walls.

It is privileged, as it uses the walls. It labels the training data of heads that predict the distance to the target
from features, and scores the planner on the true dynamics.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.pointmaze.maze import RADIUS, Maze, centre

__all__ = ["Geodesic"]

_SLACK = 1e-3
"""By how much less than its radius the ball keeps from walls here, so that it may slide along one."""
_CHUNK = 20_000


class Geodesic:
    """Distances in ``maze`` for the ball's centre, with walls grown by its radius; corners stay square."""

    def __init__(self, maze: Maze) -> None:
        grown = RADIUS - _SLACK
        self._walls = maze.wall_boxes + np.array([-grown, -grown, grown, grown])
        self._corners = _corners(maze)
        between = _lengths(self._corners[:, None], self._corners[None])
        between[~self._clear(self._corners[:, None], self._corners[None])] = np.inf
        for middle in range(len(between)):  # Floyd and Warshall
            between = np.minimum(between, between[:, middle, None] + between[middle])
        self._between = between

    def distance(self, begin: NDArray[np.floating], end: NDArray[np.floating]) -> NDArray[np.float64]:
        """Metres from ``begin`` (N, 2 or more) to ``end`` (N, 2 or more) or one place; infinite if there is no way.

        A place within a grown wall sees only what it would see from there in a straight line, or else infinity.
        """
        starts = np.asarray(begin, dtype=np.float64)[..., :2]
        ends = np.broadcast_to(np.asarray(end, dtype=np.float64)[..., :2], starts.shape)
        found = np.empty(len(starts))
        for first in range(0, len(starts), _CHUNK):
            rows = slice(first, first + _CHUNK)
            found[rows] = self._distance(starts[rows], ends[rows])
        return found

    def _distance(self, starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float64]:
        straight = np.where(self._clear(starts, ends), _lengths(starts, ends), np.inf)
        bent = np.flatnonzero(np.isinf(straight))
        if len(bent) and len(self._corners):
            legs = []
            for side in (starts[bent, None], ends[bent, None]):
                length = _lengths(side, self._corners[None])
                legs.append(np.where(self._clear(side, self._corners[None]), length, np.inf))
            over = (legs[0][:, :, None] + self._between[None] + legs[1][:, None]).min(axis=(1, 2))
            straight[bent] = over
        return straight

    def _clear(self, begin: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether the segment between two places (..., 2) crosses the inside of no grown wall."""
        origin, way = np.broadcast_arrays(begin, end)
        way = way - origin
        with np.errstate(divide="ignore", invalid="ignore"):
            low = (self._walls[:, :2] - origin[..., None, :]) / way[..., None, :]
            high = (self._walls[:, 2:] - origin[..., None, :]) / way[..., None, :]
        near, far = np.minimum(low, high), np.maximum(low, high)
        still = way[..., None, :] == 0
        within = (origin[..., None, :] > self._walls[:, :2]) & (origin[..., None, :] < self._walls[:, 2:])
        near = np.where(still, np.where(within, -np.inf, np.inf), near).max(axis=-1)
        far = np.where(still, np.where(within, np.inf, -np.inf), far).min(axis=-1)
        return np.asarray(~((near < far) & (near < 1) & (far > 0)).any(axis=-1))


def _lengths(begin: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.norm(end - begin, axis=-1))


def _corners(maze: Maze) -> NDArray[np.float64]:
    """(C, 2): the turning points: where of the four cells around a vertex one alone is wall, off it by the radius."""
    rows, columns = len(maze.rows), len(maze.rows[0])
    free = {(int(i), int(j)) for i, j in maze.cells}
    found = []
    for i in range(rows - 1):
        for j in range(columns - 1):
            around = [(i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)]
            walls = [cell for cell in around if cell not in free]
            if len(walls) == 1:
                vertex = centre(np.array([around[0]]))[0] + 0.5
                away = np.sign(vertex - centre(np.array([walls[0]]))[0])
                found.append(vertex + away * RADIUS)
    return np.array(found).reshape(-1, 2)
