"""A path through free space goes over what stands in its corridor and out from under what hangs above."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("mujoco")
pytestmark = pytest.mark.sim

plane = st.floats(-0.5, 0.5)
points = st.lists(st.tuples(plane, plane, st.floats(0.8, 1.4)), max_size=40).map(lambda p: np.array(p).reshape(-1, 3))
places = st.tuples(plane, plane).map(lambda p: np.array([*p, 1.0]))


@given(points, places, places, st.floats(0.02, 0.2))
def test_the_corridor_is_as_high_as_what_stands_in_it(cloud, start, goal, radius):
    """Against a walk along the segment in small steps, which may miss a sliver at the edge."""
    from runtime.worlds.libero.skills.transit import corridor_height

    height = corridor_height(cloud, start, goal, radius)
    walk = start[:2] + np.linspace(0.0, 1.0, 400)[:, None] * (goal - start)[:2]
    away = np.array([np.linalg.norm(walk - p[:2], axis=1).min() for p in cloud])
    assert height >= cloud[away < radius - 2e-3, 2].max(initial=-np.inf)
    assert height <= cloud[away < radius + 1e-9, 2].max(initial=-np.inf)


@pytest.mark.parametrize(("aside", "height"), [(0.069, 1.2), (0.071, -np.inf)])
@pytest.mark.parametrize("along", [0.0, 0.1, 0.3])
def test_what_stands_within_the_radius_of_the_way_counts_and_what_stands_beyond_does_not(along, aside, height):
    from runtime.worlds.libero.skills.transit import corridor_height

    start, goal = np.array([0.0, 0.0, 1.0]), np.array([0.3, 0.0, 1.0])
    assert corridor_height(np.array([[along, aside, 1.2]]), start, goal, 0.07) == height


def box(centre, half):
    grid = [np.linspace(-h, h, 16) for h in half]
    return np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1).reshape(-1, 3) + centre


THING = box((0.0, 0.0, 0.9), (0.03, 0.03, 0.03))


def test_what_stands_free_rises_where_it_is():
    from runtime.worlds.libero.skills.transit import way_out

    table = box((0.0, 0.0, 0.86), (0.3, 0.3, 0.005))
    assert not way_out(THING, table).any()


def test_what_stands_under_a_board_comes_out_sideways_before_it_rises():
    from runtime.worlds.libero.skills.transit import ROOM, way_out

    board = box((-0.05, 0.0, 1.0), (0.1, 0.2, 0.005))  # its edge is 50 mm ahead
    out = way_out(THING, board)
    assert out[0] > 0.05
    assert out[2] == 0.0
    assert THING[:, 0].min() + out[0] >= 0.05 - ROOM
    moved = THING + out
    assert not ((abs(board[:, 0] - moved[:, 0].mean()) < 0.03) & (abs(board[:, 1] - moved[:, 1].mean()) < 0.03)).any()


def test_it_does_not_come_out_through_what_stands_beside_it():
    from runtime.worlds.libero.skills.transit import way_out

    board = box((-0.05, 0.0, 1.0), (0.1, 0.2, 0.005))
    free = way_out(THING, board)
    post = box(np.array([0.0, 0.0, 0.92]) + free, (0.02, 0.02, 0.06))
    other = way_out(THING, np.concatenate([board, post]))
    assert other.any()
    assert np.linalg.norm(other - free) > 0.03


def test_where_every_way_is_barred_it_stays():
    from runtime.worlds.libero.skills.transit import way_out

    ceiling = box((0.0, 0.0, 1.0), (0.35, 0.35, 0.005))
    assert not way_out(THING, ceiling).any()
