"""A grasp leaves room for the fingers and the hand, and has something between its pads."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("mujoco")
pytest.importorskip("numba")
pytestmark = pytest.mark.sim

HALF = st.floats(0.012, 0.034)
SLACK = 1e-9
# Half extents (x, y) and range above the tip (z) of what the fingers and the hand fill when they are open, in metres.
FINGER = ((0.0380, 0.0625), (0.0, 0.0145), (-0.0015, 0.060))
HAND = ((0.0, 0.106), (0.0, 0.0335), (0.037, 0.131))


def surface(half, centre=(0.0, 0.0, 0.0)):
    grids = [np.arange(-h, h + 1e-9, min(0.006, 2 * h / 3)) for h in half]
    points = []
    for axis, sign in itertools.product(range(3), (-1, 1)):
        sides = list(grids)
        sides[axis] = np.array([sign * half[axis]])
        points.append(np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 3))
    return np.concatenate(points) + centre


def filled(grasp, points, box):
    """Which points lie in a box of the open gripper."""
    from runtime.worlds.libero.skills.grasping import TIP

    local = (points - grasp.pose.position) @ grasp.pose.rotation
    local[:, 2] = TIP - local[:, 2]
    (x0, x1), (y0, y1), (z0, z1) = box
    x, y, up = abs(local[:, 0]), abs(local[:, 1]), local[:, 2]
    within = (x > x0 + SLACK) & (x < x1 - SLACK) & (y >= y0) & (y < y1 - SLACK)
    return within & (up > z0 + SLACK) & (up < z1 - SLACK)


def looking_down():
    from runtime.worlds.libero.skills.frames import Pose, frame

    return Pose(np.array([0.0, 0.0, 0.3]), frame(np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])))


def found(half, around, tilts=(0.0,), yaws=8):
    from runtime.worlds.libero.skills.grasping import Search, find_grasps

    search = Search(yaws=yaws, tilts=tilts)
    return find_grasps(surface(half), around, np.zeros(3), -half[2] + 0.003, looking_down(), search)


@settings(max_examples=25, deadline=None)
@given(HALF, st.floats(0.012, 0.08), HALF, st.floats(0.06, 0.16), st.floats(0.0, 6.28), st.sampled_from([0.0, 0.7]))
def test_no_grasp_has_a_point_of_the_object_or_of_its_surroundings_in_a_finger_or_the_hand(x, y, z, away, angle, tilt):
    half = (x, y, z)
    beside = surface((0.02, 0.02, 0.05), away * np.array([np.cos(angle), np.sin(angle), 0.0]))
    for grasp in found(half, beside, (tilt,)):
        for points in (surface(half), beside):
            assert not filled(grasp, points, FINGER).any()
            assert not filled(grasp, points, HAND).any()


@settings(max_examples=25, deadline=None)
@given(HALF, st.floats(0.012, 0.08), HALF)
def test_a_free_box_is_gripped_across_a_side_that_fits_above_what_it_stands_on(x, y, z):
    half = (x, y, z)
    from runtime.worlds.libero.skills.grasping import TIP

    grasps = found(half, np.empty((0, 3)))
    assert grasps
    assert [g.cost for g in grasps] == sorted(g.cost for g in grasps)
    for grasp in grasps:
        tip = grasp.pose.position + TIP * grasp.pose.rotation[:, 2]
        assert tip[2] >= -z + 0.003 - 1e-6
        assert grasp.width <= 0.074
    best = grasps[0]
    assert np.linalg.norm(best.pose.position[:2]) < 0.02  # over the middle, where it does not swing
    assert best.width >= 2 * min(x, y) - 0.013  # across, not by a corner


@pytest.mark.parametrize("half", [(0.06, 0.06, 0.03), (0.045, 0.05, 0.02)])
def test_what_is_too_wide_is_not_gripped_across(half):
    assert found(half, np.empty((0, 3)), yaws=2) == []  # its corners are left to other yaws


def test_a_box_between_two_walls_is_gripped_along_them_or_not_at_all():
    half = (0.02, 0.03, 0.03)
    walls = np.concatenate([surface((0.01, 0.06, 0.06), (s * 0.055, 0.0, 0.0)) for s in (-1, 1)])
    grasps = found(half, walls)
    assert grasps
    assert all(abs(grasp.pose.rotation[0, 0]) < 0.5 for grasp in grasps)  # never closes across the walls
    ring = np.concatenate([walls, *(surface((0.06, 0.01, 0.06), (0.0, s * 0.06, 0.0)) for s in (-1, 1))])
    assert found(half, ring) == []
