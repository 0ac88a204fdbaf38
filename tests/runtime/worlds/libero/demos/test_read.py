from __future__ import annotations

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from tests.runtime.worlds.libero.demos import made
from tests.runtime.worlds.libero.demos.made import same

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


def load(*arguments, **options):
    from runtime.worlds.libero.demos import load

    return load(*arguments, **options)


def fault(path):
    with pytest.raises(OntoError) as caught:
        load(path)
    (problem,) = caught.value.problems
    assert problem.file == str(path)
    return problem.code, problem.message


@pytest.fixture
def published(tmp_path):
    return made.published(tmp_path / "libero_goal" / "put_the_bowl_on_the_plate_demo.hdf5")


def test_a_file_as_libero_publishes_them_is_read_whole_and_in_the_order_of_its_numbers(published):
    file = load(published, images=True)
    assert (file.suite, file.task) == ("libero_goal", "put_the_bowl_on_the_plate")
    assert file.language == "put the bowl on the plate"
    assert [demo.name for demo in file.demos] == ["demo_2", "demo_10"]
    assert [len(demo) for demo in file.demos] == list(made.STEPS)
    with h5py.File(published) as raw:
        for demo in file.demos:
            assert len(demo.obs) == 7
            for key, value in demo.obs.items():
                np.testing.assert_array_equal(value, raw[f"data/{demo.name}/obs/{key}"])
            for key in ("actions", "states", "rewards", "dones", "robot_states"):
                np.testing.assert_array_equal(getattr(demo, key), raw[f"data/{demo.name}/{key}"])
            assert demo.start is None
            assert demo.origin is None
            assert (demo.hidden, demo.truth, demo.facts, demo.onset) == (None, None, (), None)
    assert file.attributes["tag"] == "libero-v1"
    assert file.about == {}


def test_pictures_are_read_only_when_they_are_wanted(published):
    (demo, _) = load(published).demos
    assert demo.pictures == ("agentview_rgb", "eye_in_hand_rgb")
    assert sorted(demo.obs) == ["ee_ori", "ee_pos", "ee_states", "gripper_states", "joint_states"]


def test_a_file_derived_from_liberos_may_lack_what_only_tools_need(published):
    with h5py.File(published, "r+") as file:
        for demo in file["data"].values():
            del demo["robot_states"], demo.attrs["model_file"], demo.attrs["init_state"], demo.attrs["num_samples"]
    demo = load(published).demos[0]
    assert demo.robot_states is None
    np.testing.assert_array_equal(demo.init_state, demo.states[0])


def test_no_file_and_a_file_of_another_kind_are_told_from_a_wrong_layout(tmp_path):
    assert fault(tmp_path / "none.hdf5")[0] == "DEM001"
    text = tmp_path / "text.hdf5"
    text.write_text("no HDF5")
    assert fault(text)[0] == "DEM001"


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_a_file_that_was_cut_off_is_refused(published, share):
    content = published.read_bytes()
    published.write_bytes(content[: int(share * len(content))])
    assert fault(published)[0] == "DEM001"


BREAKS = {
    "no data": (lambda f: f.move("data", "other"), "there is no group `data`"),
    "empty": (lambda f: [f["data"].pop(n) for n in list(f["data"])], "holds no demonstration"),
    "strange name": (lambda f: f.move("data/demo_2", "data/trial_2"), "`data/trial_2` is no `demo_N`"),
    "no actions": (lambda f: f["data/demo_2"].pop("actions"), "has no `actions`"),
    "no states": (lambda f: f["data/demo_2"].pop("states"), "has no `states`"),
    "no obs": (lambda f: f["data/demo_2"].pop("obs"), "has no group `obs`"),
    "six numbers": (lambda f: _put(f, "actions", np.zeros((5, 6))), "not (n, 7)"),
    "flat states": (lambda f: _put(f, "states", np.zeros(5)), "not (n, 1 + nq + nv)"),
    "fewer steps": (lambda f: _put(f, "rewards", np.zeros(4)), "is not of 5 steps"),
    "short obs": (lambda f: _put(f, "obs/ee_pos", np.zeros((4, 3))), "obs/ee_pos` is not of 5 steps"),
    "not finite": (lambda f: _put(f, "actions", np.full((5, 7), np.nan)), "not finite"),
    "group for array": (lambda f: [f["data/demo_2"].pop("dones"), f.create_group("data/demo_2/dones")], "dones"),
    "no JSON": (lambda f: f["data"].attrs.__setitem__("problem_info", "{"), "`problem_info` is no JSON"),
    "a list": (lambda f: f["data"].attrs.__setitem__("problem_info", "[]"), "is no JSON object"),
    "array for group": (lambda f: [f["data"].pop("demo_2"), f["data"].__setitem__("demo_2", 1)], "no group `demo_2`"),
    "no steps": (lambda f: f["data/demo_2"].attrs.__setitem__("num_samples", 0), "has no steps"),
}


def _put(file, name, value):
    del file[f"data/demo_2/{name}"]
    file[f"data/demo_2/{name}"] = value


def test_the_breaks_are_all_there():
    assert len(BREAKS) == 16


@pytest.mark.parametrize("name", BREAKS)
def test_another_layout_is_named(published, name):
    act, words = BREAKS[name]
    with h5py.File(published, "r+") as file:
        act(file)
    code, message = fault(published)
    assert code == "DEM002"
    assert words in message


def test_the_shipped_file_is_read_with_its_window_records(sample):
    file = load(sample)
    assert (file.suite, file.task, len(file.demos)) == ("libero_goal", "put_the_bowl_on_the_plate", 2)
    for demo in file.demos:
        assert demo.start.integration.size > demo.states.shape[1]
        assert {"goal_pos", "goal_ori", "new_update", "torques"} <= set(demo.start.controller)
        assert demo.start.controller["position_limits"] is None
        assert demo.origin.intended.shape == demo.actions.shape
    assert [one["outcome"] for one in file.demos[0].origin.tries] == ["lost", "held"]


def test_demonstrations_that_were_read_are_written_as_they_were(sample, tmp_path):
    from runtime.worlds.libero.demos.write import write

    file = load(sample)
    attributes = {name: value for name, value in file.attributes.items() if name not in {"num_demos", "total"}}
    write(tmp_path / "again.hdf5", attributes, file.about, file.demos)
    again = load(tmp_path / "again.hdf5")
    assert again.attributes == file.attributes
    assert again.about == file.about
    for ours, theirs in zip(again.demos, file.demos, strict=True):
        np.testing.assert_array_equal(ours.states, theirs.states)
        np.testing.assert_array_equal(ours.start.integration, theirs.start.integration)
        assert ours.start.clock == theirs.start.clock
        assert {
            k: np.array_equal(v, theirs.start.controller[k]) for k, v in ours.start.controller.items()
        } == dict.fromkeys(theirs.start.controller, True)
        assert ours.origin.tries == theirs.origin.tries
        for step in range(len(theirs)):
            same(ours.snapshot(step), theirs.snapshot(step))
        np.testing.assert_array_equal(ours.truth, theirs.truth)
        assert ours.facts == theirs.facts
