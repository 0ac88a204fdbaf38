from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from onto_compiler.problems import OntoError

h5py = pytest.importorskip("h5py")
pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def file(collected):
    from runtime.worlds.libero.demos import load

    return load(collected.path)


def test_a_task_is_collected_with_what_liberos_readers_ask_for(collected, file):
    assert (collected.demos, collected.short) == (1, False)
    assert collected.path.endswith("libero_goal/put_the_bowl_on_the_plate_demo.hdf5")
    with h5py.File(collected.path) as raw:
        data = raw["data"]
        assert data.attrs["num_demos"] == 1
        assert data.attrs["total"] == sum(len(demo) for demo in file.demos)
        arguments = json.loads(data.attrs["env_args"])
        assert arguments["env_name"] == data.attrs["env_name"] == "Libero_Tabletop_Manipulation"
        assert arguments["env_kwargs"]["controller_configs"]["type"] == "OSC_POSE"
        assert json.loads(data.attrs["problem_info"])["language_instruction"] == "put the bowl on the plate"
        assert data.attrs["macros_image_convention"] == "opengl"
        for demo in data.values():
            steps = demo.attrs["num_samples"]
            shapes = {name: demo[name].shape for name in ("actions", "robot_states", "rewards", "dones")}
            assert shapes == {"actions": (steps, 7), "robot_states": (steps, 9), "rewards": (steps,), "dones": (steps,)}
            widths = {name: demo["obs"][name].shape for name in demo["obs"]}
            assert widths == {
                "ee_ori": (steps, 3),
                "ee_pos": (steps, 3),
                "ee_states": (steps, 6),
                "gripper_states": (steps, 2),
                "joint_states": (steps, 7),
            }
            np.testing.assert_array_equal(demo.attrs["init_state"], demo["states"][0])
            assert demo["rewards"][()].tolist() == demo["dones"][()].tolist() == [0] * (steps - 1) + [1]
            assert demo.attrs["model_file"].startswith("<mujoco")


def test_nothing_in_a_file_names_this_machine(collected):
    from runtime.worlds.libero.simulator.assets import package_root

    found = []
    with h5py.File(collected.path) as raw:
        raw["data"].visititems(lambda name, node: found.extend((name, v) for v in node.attrs.values()))
        found += [("data", value) for value in raw["data"].attrs.values()]
    text = " ".join(value for _, value in found if isinstance(value, str))
    assert "robosuite/models/assets/" in text
    assert "libero/libero/assets/" in text
    for place in package_root().parents:
        assert len(place.parts) == 1 or f"{place}/" not in text


def test_a_demonstration_ends_released_and_past_its_success(file):
    from runtime.worlds.libero.demos.trial import HELD_OUT, PAST

    for demo in file.demos:
        assert 0 < demo.origin.success_step <= len(demo) - PAST
        np.testing.assert_array_equal(demo.actions[-PAST:], [[0, 0, 0, 0, 0, 0, -1]] * PAST)
        assert 0 <= demo.origin.state_index < HELD_OUT


def test_actions_are_what_was_executed_and_the_intended_ones_stand_beside_them(file):
    disturbed = [demo for demo in file.demos if demo.origin.severity > 0]
    assert disturbed
    for demo in disturbed:
        assert np.abs(demo.actions - demo.origin.intended).max() > 0.01
        assert demo.origin.disturbances
    assert all(np.abs(demo.actions).max() <= 1 for demo in file.demos)


def test_what_was_observed_belongs_to_the_state_before_the_action(file):
    """LIBERO observes one substep (2 ms) before the end of the step before."""
    for demo in file.demos:
        joints, positions = demo.obs["joint_states"], demo.states[:, 1:8]
        ahead = np.abs(joints - positions).max(axis=1)
        behind = np.abs(joints[:-1] - positions[1:]).max(axis=1)
        assert ahead.max() < 0.01
        assert np.median(behind) > 5 * np.median(ahead)
        np.testing.assert_array_equal(demo.robot_states[:, :2], demo.obs["gripper_states"])
        np.testing.assert_array_equal(demo.robot_states[:, 2:5], demo.obs["ee_states"][:, :3])


def test_the_same_order_gives_the_same_bytes(order, collected, tmp_path):
    from runtime.worlds.libero.demos.collect import collect_task

    again = collect_task(dataclasses.replace(order, folder=tmp_path), wait=True)
    assert _bytes(again.path) == _bytes(collected.path)


def test_a_finished_task_is_left_alone(order, collected):
    from runtime.worlds.libero.demos.collect import collect_task

    before = _bytes(collected.path)
    assert collect_task(order, wait=True) == collected
    assert _bytes(collected.path) == before


def test_other_options_are_refused_by_name(order, collected):
    from runtime.worlds.libero.demos.collect import collect

    with pytest.raises(OntoError) as caught:
        collect([dataclasses.replace(order, seed=1)], 1, lambda _: None)
    (problem,) = caught.value.problems
    assert problem.code == "DEM003"
    assert "seed 0 and not 1" in problem.message


def _bytes(path):
    from pathlib import Path

    return Path(path).read_bytes()


def test_where_it_was_made_a_demonstration_is_replayed_without_drift(collected):
    from runtime.worlds.libero.demos.replay import replay

    (found,) = replay(collected.path)
    assert (found.same, found.holds, found.whole, found.drift) == (True, True, True, 0.0)
