"""Poses compose as transforms do, and a gripper's two equal fingers give every grasp a twin."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("mujoco")
pytestmark = pytest.mark.sim

numbers = st.floats(-2.0, 2.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
directions = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: v / np.linalg.norm(v))
angles = st.floats(-3.1, 3.1)


@st.composite
def rotations(draw):
    from runtime.worlds.libero.skills.frames import axis_angle

    return axis_angle(draw(directions), draw(angles))


@st.composite
def poses(draw):
    from runtime.worlds.libero.skills.frames import Pose

    return Pose(draw(vectors), draw(rotations()))


def matrix(pose):
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = pose.rotation, pose.position
    return whole


@given(poses(), poses())
def test_composition_and_inverse_are_those_of_homogeneous_matrices(a, b):
    assert matrix(a @ b) == pytest.approx(matrix(a) @ matrix(b), abs=1e-12)
    assert matrix(a.inverse()) == pytest.approx(np.linalg.inv(matrix(a)), abs=1e-12)


@given(poses(), st.floats(0.0, 1.0))
def test_a_pose_backs_against_its_approach_and_keeps_its_rotation(pose, distance):
    backed = pose.backed(distance)
    local = pose.inverse() @ backed
    assert local.position == pytest.approx([0.0, 0.0, -distance], abs=1e-12)
    assert np.array_equal(backed.rotation, pose.rotation)


@given(directions, directions)
def test_a_frame_is_a_rotation_that_approaches_as_asked_and_closes_as_near_as_it_can(approach, closing):
    from runtime.worlds.libero.skills.frames import frame

    if np.linalg.norm(np.cross(approach, closing)) < 0.01:
        return
    made = frame(approach, closing)
    assert made.T @ made == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(made) == pytest.approx(1.0)
    assert made[:, 2] == pytest.approx(approach)
    assert made[:, 0] @ closing == pytest.approx(np.linalg.norm(np.cross(approach, closing)), abs=1e-9)


@given(rotations(), rotations())
def test_the_nearest_twin_is_the_same_grasp_and_never_more_than_a_half_turn_from_both(rotation, current):
    from runtime.worlds.libero.skills.frames import nearest_twin, turn

    near = nearest_twin(rotation, current)
    other = near * np.array([-1.0, -1.0, 1.0])
    assert near[:, 2] == pytest.approx(rotation[:, 2])
    assert abs(near[:, 0] @ rotation[:, 0]) == pytest.approx(1.0)
    assert np.linalg.det(near) == pytest.approx(1.0)
    assert turn(current, near) <= turn(current, other) + 1e-6


@given(directions, angles)
def test_a_rotation_vector_is_axis_times_angle(axis, angle):
    from runtime.worlds.libero.skills.frames import axis_angle, rotation_vector, turn

    made = axis_angle(axis, angle)
    assert rotation_vector(made) == pytest.approx(axis * angle, abs=1e-6)
    assert turn(np.eye(3), made) == pytest.approx(abs(angle), abs=1e-6)


@given(st.floats(-50.0, 50.0))
def test_a_wrapped_angle_points_the_same_way_within_half_a_turn(angle):
    from runtime.worlds.libero.skills.frames import wrapped

    assert -np.pi <= wrapped(angle) <= np.pi
    assert np.exp(1j * wrapped(angle)) == pytest.approx(np.exp(1j * angle), abs=1e-9)
