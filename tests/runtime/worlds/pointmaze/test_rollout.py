"""The batched dynamics are MuJoCo's own, step for step and bit for bit."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import MAZES
from runtime.worlds.pointmaze.rollout import Rollout

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]
ROLLOUT = Rollout(U_MAZE)
DATA = {maze: mujoco.MjData(maze.model) for maze in (U_MAZE, MAZES["medium"])}


def stepped(maze, state, actions):
    """The states of one trajectory (T + 1, 4), by a plain loop of ``mj_step`` from a reset at each environment step."""
    model, data = maze.model, DATA[maze]
    states = [np.asarray(state)]
    for action in actions:
        mujoco.mj_resetData(model, data)
        data.qpos[:] = states[-1][:2]
        data.qvel[:] = np.clip(states[-1][2:], -5, 5)
        data.ctrl[:] = np.clip(action, -1, 1)
        for _ in range(5):
            mujoco.mj_step(model, data)
        states.append(np.concatenate([data.qpos, data.qvel]))
    return np.array(states)


def drawn(maze, rows, steps, seed):
    rng = np.random.default_rng(seed)
    xy = maze.centres[rng.integers(len(maze.cells), size=rows)] + rng.uniform(-0.45, 0.45, (rows, 2))
    states = np.concatenate([xy, rng.uniform(-5.3, 5.3, (rows, 2))], axis=1)
    return states, rng.uniform(-1.3, 1.3, (rows, steps, 2))


@pytest.mark.parametrize("name", ["u_maze", "medium"])
def test_a_rollout_is_a_plain_loop_of_steps_bit_for_bit(name):
    maze = MAZES[name]
    states, actions = drawn(maze, 60, 30, seed=1)
    found = Rollout(maze).states(states, actions)
    assert found.shape == (60, 31, 4)
    wanted = np.stack([stepped(maze, *given) for given in zip(states, actions, strict=True)])
    assert np.array_equal(found, wanted)
    touching = (maze.clearance(wanted) < 0.002).mean()
    assert 0.05 < touching < 0.95, "the comparison meets walls and open space"
    assert (np.abs(wanted[..., 2:]) > 5).any(), "the comparison meets velocities that are clipped"


@settings(deadline=None, max_examples=200)
@given(
    cell=st.sampled_from(U_MAZE.centres.tolist()),
    # From where nothing is touched to where a contact begins, and what is clipped at either end.
    gap=st.floats(-0.01, 0.02),
    along=st.floats(-0.5, 0.5),
    speed=st.floats(-6, 6),
    side=st.floats(-6, 6),
    action=st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)),
    turned=st.booleans(),
)
def test_a_step_beside_a_wall_is_mujocos_own(cell, gap, along, speed, side, action, turned):
    beside, tangent = (1, 0) if turned else (0, 1)
    state = np.array([*cell, 0.0, 0.0])
    state[beside] += 0.4 - gap
    state[tangent] += along
    state[2 + beside], state[2 + tangent] = speed, side
    found = ROLLOUT.states(state[None], np.array([[action]]))
    assert np.array_equal(found[0], stepped(U_MAZE, state, [action]))


def test_two_threads_find_what_one_finds():
    states, actions = drawn(U_MAZE, 64, 20, seed=2)
    assert np.array_equal(Rollout(U_MAZE, threads=2).states(states, actions), Rollout(U_MAZE).states(states, actions))


def test_a_rollout_goes_on_from_where_another_ended():
    states, actions = drawn(U_MAZE, 20, 20, seed=3)
    rollout = Rollout(U_MAZE)
    whole = rollout.states(states, actions)
    first = rollout.states(states, actions[:, :10])
    second = rollout.states(first[:, -1], actions[:, 10:])
    assert np.array_equal(whole, np.concatenate([first, second[:, 1:]], axis=1))


def test_the_warm_start_that_upstream_keeps_makes_no_difference():
    states, actions = drawn(U_MAZE, 20, 25, seed=4)
    found = Rollout(U_MAZE).states(states, actions)
    model = U_MAZE.model
    for start, row, wanted in zip(states, actions, found, strict=True):
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = start[:2], start[2:]
        for action in np.clip(row, -1, 1):
            data.qvel[:] = np.clip(data.qvel, -5, 5)
            mujoco.mj_forward(model, data)
            data.ctrl[:] = action
            for _ in range(5):
                mujoco.mj_step(model, data)
        assert np.concatenate([data.qpos, data.qvel]) == pytest.approx(wanted[-1], abs=1e-9)


def test_one_state_is_a_start_for_many_rows_of_actions():
    _, actions = drawn(U_MAZE, 8, 5, seed=5)
    start = np.array([0.8, 0.8, 0.0, 0.0])
    found = Rollout(U_MAZE).states(start, actions)
    assert np.array_equal(found, Rollout(U_MAZE).states(np.tile(start, (8, 1)), actions))


@pytest.mark.parametrize("shape", [(0, 5, 2), (3, 0, 2)])
def test_nothing_to_roll_out_gives_the_starts(shape):
    start = np.array([0.8, 0.8, 1.0, 0.0])
    found = Rollout(U_MAZE).states(start, np.zeros(shape))
    assert found.shape == (shape[0], shape[1] + 1, 4)
    assert (found[:, 0] == start).all()


@pytest.mark.parametrize(
    ("state", "actions", "code"),
    [
        (np.zeros((3, 4)), np.zeros((2, 5, 2)), "PMZ003"),
        (np.zeros((2, 2)), np.zeros((2, 5, 2)), "PMZ003"),
        (np.zeros((2, 4)), np.zeros((2, 10)), "PMZ003"),
        (np.zeros((2, 4)), np.zeros((2, 2)), "PMZ003"),
        (np.zeros((1, 2, 4)), np.zeros((2, 5, 2)), "PMZ003"),
        (np.array(["x"] * 4), np.zeros((1, 5, 2)), "PMZ003"),
        (np.array([0.8, np.nan, 0, 0]), np.zeros((1, 5, 2)), "PMZ004"),
        (np.array([0.8, 0.8, 0, 0]), np.full((1, 5, 2), np.inf), "PMZ004"),
        (np.array([0.8, 1e12, 0, 0]), np.zeros((1, 5, 2)), "PMZ004"),
    ],
)
def test_what_cannot_be_rolled_out_is_refused_before_anything_runs(state, actions, code):
    with pytest.raises(OntoError) as caught:
        Rollout(U_MAZE).states(state, actions)
    assert [problem.code for problem in caught.value.problems] == [code]
