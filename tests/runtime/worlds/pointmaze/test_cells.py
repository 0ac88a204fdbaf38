"""The way through free cells."""

from __future__ import annotations

import numpy as np
import pytest

from runtime.worlds.pointmaze.cells import cell_way
from runtime.worlds.pointmaze.geodesic import Geodesic
from runtime.worlds.pointmaze.maze import MAZES, Maze


def test_the_u_is_walked_around():
    maze = MAZES["u_maze"]
    way = cell_way(maze, np.array([0.8, 0.8]), np.array([2.8, 0.8]))
    np.testing.assert_allclose(
        way, [[0.8, 0.8], [0.8, 1.8], [0.8, 2.8], [1.8, 2.8], [2.8, 2.8], [2.8, 1.8], [2.8, 0.8]]
    )


@pytest.mark.parametrize("name", list(MAZES))
def test_a_way_goes_from_cell_to_neighbour_and_is_no_shorter_than_the_shortest(name: str):
    maze, random = MAZES[name], np.random.default_rng(0)
    for begin, end in random.choice(maze.centres, (20, 2)):
        way = cell_way(maze, begin, end)
        np.testing.assert_array_equal((way[0], way[-1]), (begin, end))
        np.testing.assert_allclose(np.linalg.norm(np.diff(way, axis=0), axis=1), 1.0)
        assert len(way) - 1 >= Geodesic(maze).distance(begin[None], end)[0] - 1e-9


def test_where_there_is_no_way_there_are_no_cells():
    parted = Maze("parted", ("#####", "#O#O#", "#####"))
    assert len(cell_way(parted, parted.centres[0], parted.centres[1])) == 0
