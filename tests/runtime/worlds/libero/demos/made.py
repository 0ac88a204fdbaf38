"""Files by hand: LIBERO's published layout, of a small scene that does not exist."""

from __future__ import annotations

import json

import h5py
import numpy as np

STEPS, SIZE = (5, 8), 47


def published(path, *, images=True):
    """A file as LIBERO publishes them: no window record, pictures unpacked, demonstrations in any order."""
    rng = np.random.default_rng(0)
    path.parent.mkdir(parents=True, exist_ok=True)
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["bddl_file_name"] = "chiliocosm/bddl_files/libero_goal/put_the_bowl_on_the_plate.bddl"
        data.attrs["env_args"] = json.dumps({"type": 1, "env_name": "Libero_Tabletop_Manipulation", "env_kwargs": {}})
        data.attrs["env_name"] = "Libero_Tabletop_Manipulation"
        data.attrs["macros_image_convention"] = "opengl"
        data.attrs["num_demos"], data.attrs["total"] = len(STEPS), sum(STEPS)
        data.attrs["problem_info"] = json.dumps(
            {
                "problem_name": "libero_tabletop_manipulation",
                "domain_name": "robosuite",
                "language_instruction": '"put the bowl on the plate"',
            }
        )
        data.attrs["tag"] = "libero-v1"
        for number, steps in ((10, STEPS[1]), (2, STEPS[0])):
            demo = data.create_group(f"demo_{number}")
            last = np.eye(steps, dtype=np.uint8)[-1]
            states = rng.normal(size=(steps, SIZE))
            for name, value in {
                "actions": rng.uniform(-1, 1, (steps, 7)),
                "states": states,
                "robot_states": rng.normal(size=(steps, 9)),
                "rewards": last,
                "dones": last,
            }.items():
                demo[name] = value
            for name, width in {
                "ee_ori": 3,
                "ee_pos": 3,
                "ee_states": 6,
                "gripper_states": 2,
                "joint_states": 7,
            }.items():
                demo[f"obs/{name}"] = rng.normal(size=(steps, width))
            for name in ("agentview_rgb", "eye_in_hand_rgb") if images else ():
                demo[f"obs/{name}"] = rng.integers(0, 255, (steps, 128, 128, 3), dtype=np.uint8)
            demo.attrs["num_samples"] = steps
            demo.attrs["model_file"] = "<mujoco/>"
            demo.attrs["init_state"] = states[0]
    return path


def same(ours, theirs):
    """Assert that two snapshots hold the same bits."""
    for name in ("integration", "body_pos", "body_quat", "gripper_action"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), strict=True)
    assert (ours.clock, ours.scene) == (theirs.clock, theirs.scene)
    assert ours.controller.keys() == theirs.controller.keys()
    for name, value in ours.controller.items():
        np.testing.assert_array_equal(value, theirs.controller[name], err_msg=name)
        assert type(value) is type(theirs.controller[name])
