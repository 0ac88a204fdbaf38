"""The maze's cells and walls, the room that they leave, and the model that is built from them."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import MAZES, RADIUS, Maze, maze_named

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]
NEAR = st.floats(-1.5, 5.0, allow_nan=False)


def test_the_published_maze_has_seven_free_cells():
    assert U_MAZE.cells.tolist() == [[1, 1], [1, 2], [1, 3], [2, 3], [3, 1], [3, 2], [3, 3]]
    assert len(U_MAZE.wall_boxes) == 18
    assert U_MAZE.extent == pytest.approx((-0.7, -0.7, 4.3, 4.3))


def test_four_mazes_are_known_by_name():
    assert {name: len(maze.cells) for name, maze in MAZES.items()} == {
        "u_maze": 7,
        "small": 10,
        "medium": 26,
        "large": 46,
    }


@given(x=NEAR, y=NEAR)
def test_clearance_is_what_mujoco_measures_between_ball_and_walls(x, y):
    model = U_MAZE.model
    data = mujoco.MjData(model)
    data.qpos[:] = (x, y)
    mujoco.mj_kinematics(model, data)
    ball = model.geom("ball_geom").id
    walls = [geom for geom in range(model.ngeom) if model.geom(geom).name.startswith("wall_")]
    assert len(walls) == 18
    nearest = min(mujoco.mj_geomDistance(model, data, ball, wall, 10.0, None) for wall in walls)
    clearance = float(U_MAZE.clearance(np.array([x, y])))
    if clearance > -RADIUS:  # the centre is in a free cell, and MuJoCo's distance to the walls is the room
        assert clearance == pytest.approx(nearest, abs=1e-6)
    else:
        assert not U_MAZE.free(np.array([x, y]))


@given(x=NEAR, y=NEAR, dx=st.floats(-0.1, 0.1), dy=st.floats(-0.1, 0.1))
def test_clearance_changes_no_faster_than_the_ball_moves(x, y, dx, dy):
    here, there = U_MAZE.clearance(np.array([[x, y], [x + dx, y + dy]]))
    assert abs(here - there) <= np.hypot(dx, dy) + 1e-12


def test_what_lies_outside_of_the_maze_is_wall():
    assert U_MAZE.clearance(np.array([9.0, 0.0])) < -4
    assert not U_MAZE.free(np.array([[-2.0, -2.0], [5.0, 5.0]])).any()


def test_clearance_takes_states_of_any_leading_shape():
    states = np.zeros((2, 3, 4)) + 0.8
    assert U_MAZE.clearance(states).shape == (2, 3)
    assert U_MAZE.free(states, 0.3).all()
    assert not U_MAZE.free(states, 0.41).any()


def test_the_point_mass_weighs_and_moves_as_the_published_one():
    model = U_MAZE.model
    assert model.body("ball_main").mass == pytest.approx(4.18879)
    assert model.opt.timestep == 0.01
    assert model.dof_damping.tolist() == [1, 1]
    assert model.actuator_gear[:, 0].tolist() == [100, 100]
    assert model.opt.gravity.tolist() == [0, 0, 0]
    data = mujoco.MjData(model)
    data.qpos[:], data.ctrl[:] = (0.8, 0.8), (1, 0)
    mujoco.mj_step(model, data)
    assert data.qvel[0] == pytest.approx(0.01 * 100 / (4.18879 + 0.01), rel=1e-6)


@pytest.mark.parametrize("rows", [("###", "#O"), ("###", "#X#", "###"), ("###", "###"), ()])
def test_a_layout_that_is_none_is_refused(rows):
    with pytest.raises(OntoError) as caught:
        Maze("broken", rows)
    assert [problem.code for problem in caught.value.problems] == ["PMZ001"]


def test_an_unknown_maze_is_refused_with_the_nearest_name():
    with pytest.raises(OntoError) as caught:
        maze_named("umaze")
    [problem] = caught.value.problems
    assert (problem.code, problem.hint) == ("PMZ002", "did you mean `u_maze`?")
