"""Training data: what decides it, what it covers, and its file."""

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import MAZES
from runtime.worlds.pointmaze.rollout import Rollout
from runtime.worlds.pointmaze.trajectories import collect, load
from runtime.worlds.pointmaze.trials import trials

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]


@pytest.fixture(scope="module")
def data():
    return collect(U_MAZE, count=200)


def test_states_are_what_the_actions_lead_to(data):
    assert data.states.shape == (200, 101, 4)
    assert data.actions.shape == (200, 100, 2)
    assert np.array_equal(Rollout(U_MAZE).states(data.states[:, 0], data.actions), data.states)


def test_the_same_source_gives_the_same_data(data):
    again = collect(U_MAZE, count=40, threads=2)
    assert np.array_equal(again.states, data.states[:40])
    assert np.array_equal(again.actions, data.actions[:40])


def test_splits_and_seeds_share_no_start_with_each_other_or_with_a_trial(data):
    others = [collect(U_MAZE, 200, 1, seed, split) for seed, split in ((1, "train"), (0, "validation"), (0, "test"))]
    starts = [each.states[:, 0] for each in (data, *others)]
    starts.append(np.concatenate([[each.start, each.goal] for each in trials(range(300))]))
    together = np.concatenate(starts)
    assert len(np.unique(together[:, 0])) == len(together) == 1400


def test_every_free_cell_and_every_direction_of_travel_is_covered(data):
    cells = np.round(data.states[..., :2] + 0.2).astype(int).reshape(-1, 2)
    found, counts = np.unique(cells, axis=0, return_counts=True)
    assert found.tolist() == U_MAZE.cells.tolist()
    assert counts.min() > 0.03 * counts.sum()
    assert (np.abs(data.states[..., 2:]).max(axis=(0, 1)) > 5).all()
    touching = U_MAZE.clearance(data.states) < 0.002
    assert 0.2 < touching.mean() < 0.6


def test_actions_reach_from_noise_to_long_pushes(data):
    within = np.abs(data.actions).max()
    assert within == 1
    centred = data.actions - data.actions.mean(axis=1, keepdims=True)
    persistence = (centred[:, 1:] * centred[:, :-1]).sum(axis=(1, 2)) / (centred**2).sum(axis=(1, 2))
    assert persistence.min() < 0.1
    assert persistence.max() > 0.8


def test_a_file_gives_back_what_was_saved(data, tmp_path):
    path = tmp_path / "train.npz"
    data.save(path)
    found = load(path)
    assert found.source == data.source
    assert np.array_equal(found.states, data.states)
    assert np.array_equal(found.actions, data.actions)


@pytest.mark.parametrize("damage", ["missing", "empty", "cut", "pickled", "other", "swapped"])
def test_a_file_of_anything_else_is_refused(data, tmp_path, damage):
    path = tmp_path / "train.npz"
    data.save(path)
    whole = path.read_bytes()
    if damage == "missing":
        path.unlink()
    elif damage == "empty":
        path.write_bytes(b"")
    elif damage == "cut":
        path.write_bytes(whole[: len(whole) // 2])
    elif damage == "pickled":
        np.savez(path, states=np.array([{}], dtype=object), actions=data.actions, card=np.array("{}"))
    elif damage == "other":
        np.savez(path, states=data.states, actions=data.actions, card=np.array('["u_maze"]'))
    else:
        with np.load(path) as file:
            np.savez(path, states=file["states"][:7], actions=file["actions"], card=file["card"])
    with pytest.raises(OntoError) as caught:
        load(path)
    assert [problem.code for problem in caught.value.problems] == ["PMZ006"]
    assert caught.value.problems[0].file == str(path)


def test_a_folder_that_is_not_there_is_a_problem(data, tmp_path):
    with pytest.raises(OntoError) as caught:
        data.save(tmp_path / "nowhere" / "train.npz")
    assert [problem.code for problem in caught.value.problems] == ["PMZ006"]


def test_negative_counts_are_refused():
    with pytest.raises(OntoError) as caught:
        collect(U_MAZE, count=-1)
    assert [problem.code for problem in caught.value.problems] == ["PMZ003"]
