"""The shortest way in a maze, against a search on a fine grid."""

from __future__ import annotations

import heapq

import numpy as np
import pytest

from runtime.worlds.pointmaze.geodesic import Geodesic
from runtime.worlds.pointmaze.maze import MAZES, Maze

STEP = 0.1


def by_grid(maze: Maze, begin: np.ndarray) -> dict[tuple[int, int], float]:
    """Dijkstra from ``begin`` over places a tenth of a metre apart, each joined to sixteen around it."""
    low, high = np.floor(np.array(maze.extent).reshape(2, 2) / STEP).astype(int)
    lattice = [(i, j) for i in range(low[0], high[0] + 1) for j in range(low[1], high[1] + 1)]
    free = {place for place, ok in zip(lattice, maze.free(np.array(lattice) * STEP, -1e-6), strict=True) if ok}
    ways = [(i, j) for i in range(-2, 3) for j in range(-2, 3) if np.gcd(i, j) == 1]
    found: dict[tuple[int, int], float] = {}
    queue = [(0.0, tuple(np.round(begin / STEP).astype(int).tolist()))]
    while queue:
        length, (x, y) = heapq.heappop(queue)
        if (x, y) in found:
            continue
        found[x, y] = length
        for i, j in ways:
            there = (x + i, y + j)
            between = {(x + i // 2, y + j // 2), (x - -i // 2, y - -j // 2)}  # what a knight's move passes
            if there not in found and there in free and between <= free:
                heapq.heappush(queue, (length + STEP * float(np.hypot(i, j)), there))
    return found


@pytest.mark.parametrize("name", ["u_maze", "medium"])
def test_the_way_is_that_of_a_search_on_a_grid(name: str):
    maze = MAZES[name]
    begin = np.round(maze.centres[0] / STEP) * STEP
    found = by_grid(maze, begin)
    exact = Geodesic(maze).distance(np.array(list(found)) * STEP, begin)
    grid = np.array(list(found.values()))
    assert len(grid) > 300
    assert (exact <= 1.01 * grid + 0.05).all()  # the grid may cut the corners of walls, which are round for a ball
    assert (exact >= 0.97 * grid - 0.15).all()


def test_it_is_a_distance():
    maze = MAZES["u_maze"]
    way, random = Geodesic(maze), np.random.default_rng(0)
    places = np.concatenate([maze.centres + random.uniform(-0.3, 0.3, maze.centres.shape) for _ in range(20)])
    others, third = random.permutation(places), random.permutation(places)
    forth, back = way.distance(places, others), way.distance(others, places)
    np.testing.assert_allclose(forth, back, atol=1e-12)
    assert (forth >= np.linalg.norm(places - others, axis=1) - 1e-12).all()
    assert (forth <= way.distance(places, third) + way.distance(third, others) + 1e-9).all()
    np.testing.assert_array_equal(way.distance(places, places), 0.0)


def test_behind_the_wall_the_way_leads_around_it():
    way = Geodesic(MAZES["u_maze"])
    ends = np.array([[0.8, 0.8]]), np.array([2.8, 0.8])
    assert way.distance(*ends)[0] == pytest.approx(2 * np.hypot(0.4, 1.6) + 1.2, abs=2e-2)


def test_there_is_no_way_out_of_the_maze():
    way = Geodesic(MAZES["u_maze"])
    assert np.isinf(way.distance(np.array([[0.8, 0.8]]), np.array([10.0, 10.0]))[0])
