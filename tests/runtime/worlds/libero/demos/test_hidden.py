"""What the flat states leave out is kept for every step: a replay from any of them is exact."""

from __future__ import annotations

import dataclasses
import shutil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from onto_compiler.problems import OntoError
from tests.runtime.worlds.libero.demos.made import same

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim
STEPS = 15


def load(path):
    from runtime.worlds.libero.demos import load

    return load(path)


@pytest.fixture(scope="module")
def demo(collected):
    return load(collected.path).demos[0]


@pytest.fixture(scope="module")
def simulation(ref):
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.simulation import Simulation

    return Simulation(compile_scene(ref.bddl), exact=True)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9])
def test_a_replay_from_any_step_repeats_every_state_and_all_that_is_hidden(demo, simulation, share):
    first = int(share * len(demo))
    simulation.settle(2)  # whatever was before
    simulation.restore(demo.snapshot(first))
    last = min(first + STEPS, len(demo) - 1)
    for step in range(first, last):
        np.testing.assert_array_equal(simulation.flat_state, demo.states[step])
        simulation.step(demo.actions[step])
    same(simulation.snapshot(), demo.snapshot(last))


def test_the_first_snapshot_is_the_window_record(demo):
    same(demo.snapshot(0), demo.start)


def test_the_truth_is_liberos_own_in_every_state(demo, ref):
    from runtime.worlds.libero.simulator.native import NativeTask

    assert demo.facts == ("on(akita_black_bowl_1, plate_1)",)
    assert set(demo.truth[:, 0]) == {False, True}
    change = int(np.flatnonzero(demo.truth[:, 0])[0])
    with NativeTask.open(ref) as task:
        for step in {0, change - 1, change, change + 1, *range(2, len(demo), 7)} & set(range(len(demo) - 1)):
            task.restore(demo.snapshot(step + 1))
            assert demo.truth[step].all() == task.success()


@given(st.data())
def test_the_onset_is_the_first_action_from_which_all_stays_true(data):
    shape = data.draw(st.tuples(st.integers(1, 12), st.integers(1, 3)))
    truth = data.draw(arrays(np.bool_, shape, elements=st.sampled_from([True, True, False])))
    demo = dataclasses.replace(_BARE, truth=truth)
    lasting = [count for count in range(1, len(truth) + 1) if truth[count - 1 :].all()]
    assert demo.onset == (lasting[0] if lasting else None)


def _bare():
    from runtime.worlds.libero.demos import Demonstration

    return Demonstration("demo_0", *[np.empty(0)] * 4, obs={}, robot_states=None, init_state=np.empty(0))


_BARE = _bare()


def test_a_file_from_before_loads_without_and_has_no_snapshot(sample, tmp_path):
    path = tmp_path / "demo.hdf5"
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        del file["data/demo_0/hidden"], file["data/demo_0/truth"]
    old, new = load(path).demos
    assert (old.hidden, old.truth, old.onset) == (None, None, None)
    assert old.start is not None
    with pytest.raises(OntoError, match="`demo_0` was recorded without the hidden state") as caught:
        old.snapshot(3)
    assert caught.value.problems[0].code == "DEM007"
    with pytest.raises(IndexError, match="has no step 112"):
        new.snapshot(112)


def _put(group, name, value):
    del group[name]
    group[name] = value


def _numbers(group):
    facts = group["truth"].attrs["facts"]
    _put(group, "truth", np.zeros((112, 1)))
    group["truth"].attrs["facts"] = facts


BREAKS = {
    "no warm start": (lambda g: g["hidden"].pop("integration"), "integration"),
    "no goal": (lambda g: g["hidden/controller"].pop("goal_ori"), "have no `goal_ori`"),
    "no controller": (lambda g: g["hidden"].pop("controller"), "controller"),
    "fewer steps": (lambda g: _put(g, "hidden/gripper_action", np.zeros((9, 2))), "(9, 2), not (112, 2)"),
    "another scene": (lambda g: _put(g, "hidden/integration", np.zeros((112, 5))), "(112, 5), not (112, 311)"),
    "strange name": (lambda g: g.__setitem__("hidden/controller/sense", np.zeros(112)), "hidden `sense`"),
    "not finite": (lambda g: _put(g, "hidden/controller/torques", np.full((112, 7), np.nan)), "not finite"),
    "no start": (lambda g: g.pop("start"), "hidden states and no `start`"),
    "truth of another length": (lambda g: _put(g, "truth", np.zeros((9, 1), dtype=np.bool_)), "facts"),
    "no facts": (lambda g: g["truth"].attrs.__delitem__("facts"), "facts"),
    "another number of facts": (lambda g: g["truth"].attrs.__setitem__("facts", "[]"), "of 112 steps and 0 facts"),
    "numbers": (_numbers, "of 112 steps and 1 fact"),
}


@pytest.mark.parametrize("name", BREAKS)
def test_a_damaged_record_is_refused_and_named(sample, tmp_path, name):
    act, words = BREAKS[name]
    path = tmp_path / "demo.hdf5"
    shutil.copy(sample, path)
    with h5py.File(path, "r+") as file:
        act(file["data/demo_1"])
    with pytest.raises(OntoError) as caught:
        load(path)
    (problem,) = caught.value.problems
    assert (problem.code, problem.file) == ("DEM002", str(path))
    assert "the record of `data/demo_1` is damaged" in problem.message
    assert words in problem.message
