"""Windows of the shipped demonstrations, replayed as LIBERO would, and what rescues those that fail."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from onto_compiler.problems import OntoError

pytest.importorskip("h5py")
pytestmark = pytest.mark.sim
SAMPLE = Path(__file__).resolve().parents[5] / "docs/examples/put_the_bowl_on_the_plate_demo.hdf5"


@pytest.fixture(scope="module")
def scene():
    from onto_compiler.knowledge import load_knowledge
    from runtime.worlds.libero.demos import load
    from runtime.worlds.libero.windows.scene import WindowScene

    with WindowScene(load(SAMPLE), load_knowledge()) as opened:
        yield opened


def window(scene, demo, start, seed=2):
    from runtime.worlds.libero.windows.window import Window

    return Window(f"{scene.file.suite}/{scene.file.task}", demo, start, seed, 0, demo % 4)


def without(scene, **changes):
    """The same scene with a file whose demonstrations lack something."""
    other = object.__new__(type(scene))
    vars(other).update(vars(scene))
    demos = tuple(dataclasses.replace(demo, **changes) for demo in scene.file.demos)
    other.file = dataclasses.replace(scene.file, demos=demos)
    return other


def replay(*arguments):
    from runtime.worlds.libero.windows.replay import replay_window

    return replay_window(*arguments)


def test_a_replay_is_liberos_reset_of_another_seed_and_its_set_init_state(scene):
    from runtime.worlds.libero.demos.replay import task_of
    from runtime.worlds.libero.simulator.native import NativeTask

    chosen = window(scene, 1, 60)
    found = replay(scene, chosen)
    demo = scene.file.demos[1]
    with NativeTask.open(task_of(scene.file), chosen.fixtures_seed) as task:
        task.reset_to(demo.states[60])
        for action in demo.actions[60:85]:
            task.step(action)
        native = task.snapshot()
        task.restore(native)
        assert found.success == task.success()
    np.testing.assert_array_equal(found.final.integration, native.integration)
    np.testing.assert_array_equal(found.final.body_pos, native.body_pos)
    assert np.abs(native.body_pos - demo.start.body_pos).max() > 1e-3


def test_the_whole_recorded_state_repeats_the_recording(scene):
    from runtime.worlds.libero.windows.replay import replay_recorded

    for number, start in ((0, 220), (1, 60), (1, 87)):
        demo = scene.file.demos[number]
        found = replay_recorded(scene, window(scene, number, start))
        assert found.success == found.truth[-1].all() == demo.truth[start + 24].all()
        np.testing.assert_array_equal(found.truth, demo.truth[start : start + 25])


def test_a_part_that_is_restored_is_the_recorded_one(scene):
    from runtime.worlds.libero.windows.replay import CONTROLLER, FIXTURES, GRIPPER

    scene.simulation.settle(1)
    chosen, demo = window(scene, 0, 150), scene.file.demos[0]
    bare, recorded = replay(scene, chosen).final, demo.snapshot(175)
    np.testing.assert_array_equal(replay(scene, chosen, [FIXTURES]).final.body_pos, recorded.body_pos)
    assert not np.array_equal(bare.body_pos, recorded.body_pos)
    drifts = [
        np.abs(replay(scene, chosen, parts).final.integration - recorded.integration)[1:79].max()
        for parts in ([], [GRIPPER], [CONTROLLER], [GRIPPER, CONTROLLER, FIXTURES])
    ]
    assert drifts[3] < min(drifts[:3])
    with pytest.raises(ValueError, match="no part `grip`"):
        replay(scene, chosen, ["grip"])


def test_the_label_is_of_the_smallest_sets_that_rescue(scene, monkeypatch):
    from runtime.worlds.libero.windows import causes

    rescuing = {("controller", "gripper"), ("gripper", "fixtures"), ("controller", "gripper", "fixtures")}
    asked = []

    def fake(_scene, chosen, parts=()):
        asked.append(tuple(parts))
        return dataclasses.make_dataclass("Result", ["success"])(tuple(parts) in rescuing)

    chosen = window(scene, 1, 87)
    monkeypatch.setattr(causes, "replay_window", fake)
    found = causes.label(scene, chosen)
    assert found.rescues == (("controller", "gripper"), ("gripper", "fixtures"))
    assert len(asked) == 6
    assert (found.whole, found.recorded, found.faulty) == (True, True, False)
    assert str(found) == "controller and gripper or gripper and fixtures"
    rescuing.clear()
    assert str(causes.label(scene, chosen)) == "warm start or contact drift"
    false = {"whole": False, "recorded": False}
    assert str(dataclasses.replace(causes.label(scene, chosen), **false)) == "not true when it was recorded"
    assert dataclasses.replace(found, whole=False).faulty


def test_without_hidden_states_a_window_is_replayed_and_cannot_be_labelled(scene):
    from runtime.worlds.libero.windows.causes import label

    bare = without(scene, hidden=None)
    chosen = window(scene, 1, 60)
    assert replay(bare, chosen).success == replay(scene, chosen).success
    for lacking, words in ((bare, "hidden state"), (without(scene, truth=None), "truth")):
        with pytest.raises(OntoError, match=f"`demo_1` was recorded without the {words}") as caught:
            label(lacking, chosen)
        (problem,) = caught.value.problems
        assert (problem.code, problem.file) == ("DEM007", str(SAMPLE))


def test_a_window_of_another_file_or_past_the_end_is_refused(scene):
    wrong = [window(scene, 2, 60), window(scene, 1, 88), dataclasses.replace(window(scene, 1, 60), task="a/b")]
    for chosen in wrong:
        with pytest.raises(OntoError) as caught:
            replay(scene, chosen)
        assert caught.value.problems[0].code == "DEM008"
