from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.worlds.libero.scene.geometry import (
    Support,
    align_yaw,
    balance,
    cube_rotations,
    extent,
    level,
    matrix_of,
    nonnegative_least_squares,
    quaternion_of,
    yaw_matrix,
)

pytestmark = pytest.mark.sim

angles = st.floats(-np.pi, np.pi)


def tilted(axis, angle):
    quat = np.zeros(4)
    mujoco.mju_axisAngle2Quat(quat, np.asarray(axis, dtype=float), angle)
    return matrix_of(quat)


def feet(*points, friction=1.0, normal=(0.0, 0.0, 1.0)):
    points = np.array(points, dtype=float)
    return Support(points, np.tile(np.array(normal, dtype=float), (len(points), 1)), np.full(len(points), friction))


SQUARE = [(-0.1, -0.1, 0.0), (-0.1, 0.1, 0.0), (0.1, -0.1, 0.0), (0.1, 0.1, 0.0)]


def test_the_cube_has_24_rotations_and_no_reflection():
    rotations = cube_rotations()
    assert len({matrix.tobytes() for matrix in rotations}) == 24
    assert np.allclose(np.linalg.det(rotations), 1.0)


@given(angles, angles)
def test_a_rotation_survives_its_quaternion(yaw, tilt):
    matrix = yaw_matrix(yaw) @ tilted((1, 0, 0), tilt)
    assert np.allclose(matrix_of(quaternion_of(matrix)), matrix, atol=1e-9)


@given(angles, st.floats(0.001, 0.2))
def test_levelling_makes_the_most_vertical_axis_vertical_and_turns_no_more_than_the_tilt(yaw, tilt):
    matrix = tilted((0.6, 0.8, 0), tilt) @ yaw_matrix(yaw)
    upright = level(matrix)
    assert np.allclose(upright[:, 2], [0, 0, 1], atol=1e-9)
    assert np.arccos(np.clip((np.trace(upright @ matrix.T) - 1) / 2, -1, 1)) == pytest.approx(tilt, abs=1e-6)


def test_levelling_keeps_what_leans_more_than_the_limit():
    matrix = tilted((1, 0, 0), 0.5)
    assert level(matrix, limit=0.4) is matrix
    assert np.allclose(level(matrix, limit=0.6)[:, 2], [0, 0, 1])


@given(angles, angles)
def test_the_aligning_turn_makes_horizontal_axes_parallel_and_is_at_most_45_degrees(yaw, other):
    turn = align_yaw(yaw_matrix(yaw), yaw_matrix(other))
    cosines = np.abs((yaw_matrix(turn) @ yaw_matrix(yaw)).T @ yaw_matrix(other))
    assert abs(turn) <= np.pi / 4 + 1e-9
    assert np.allclose(np.sort(cosines.ravel())[-3:], 1.0, atol=1e-7)


@given(st.integers(0, 10_000))
def test_least_squares_meets_the_conditions_of_optimality(seed):
    rng = np.random.default_rng(seed)
    columns, target = rng.normal(size=(6, 14)), rng.normal(size=6)
    x, rest = nonnegative_least_squares(columns, target)
    gradient = columns.T @ (target - columns @ x)
    assert (x >= 0).all()
    assert (gradient <= 1e-7).all()
    assert np.abs(gradient[x > 0]).max(initial=0.0) < 1e-7
    assert rest == pytest.approx(np.linalg.norm(target - columns @ x))


def test_a_body_on_four_feet_is_balanced_and_bears_a_lean_within_them():
    assert balance(feet(*SQUARE), np.array([0, 0, 0.2]), 0.1) < 1e-9
    assert balance(feet(*SQUARE), np.array([0, 0, 0.2]), 0.1, lean=0.09) < 1e-9
    assert balance(feet(*SQUARE), np.array([0, 0, 0.2]), 0.1, lean=0.12) > 0.01


def test_a_body_beside_its_feet_or_without_contact_is_not_balanced():
    assert balance(feet(*SQUARE), np.array([0.2, 0, 0.2]), 0.1) > 0.1
    assert balance(Support(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)), np.zeros(3), 0.1) == 1.0


@pytest.mark.parametrize(("friction", "holds"), [(0.6, True), (0.3, False)])
def test_a_slope_is_held_by_friction_above_the_tangent_of_its_angle(friction, holds):
    slope = tilted((0, 1, 0), np.radians(25.0))  # tan 25 deg = 0.466
    support = feet(*(slope @ np.array(SQUARE).T).T, friction=friction, normal=slope[:, 2])
    assert (balance(support, slope @ np.array([0, 0, 0.02]), 0.1) < 1e-9) == holds


def test_the_extent_is_that_of_the_turned_boxes():
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="1 2 3" euler="0 0 90">'
        '<geom type="box" size="0.1 0.2 0.3"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    low, high = extent(model, data, np.array([0, 1]))
    assert np.allclose(low, [0.8, 1.9, 2.7])
    assert np.allclose(high, [1.2, 2.1, 3.3])
    with pytest.raises(ValueError, match="finite"):
        extent(model, data, np.array([0]))
