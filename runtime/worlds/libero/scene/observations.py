"""LIBERO's low-dimensional observations under their own names, read straight from MuJoCo's arrays.

Sources: robosuite 1.4.0 ``robots/robot.py`` and ``robots/single_arm.py`` (``setup_observables``), LIBERO
``envs/bddl_base_domain.py`` (``_create_obj_sensors``). Positions are in metres in the world's frame, quaternions xyzw.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, near
from runtime.worlds.libero.simulator.compiled import CompiledScene

__all__ = ["Observer"]

PROPRIO = "robot0_proprio-state"
OBJECT = "object-state"
_HAND = "robot0_right_hand"  # the body whose orientation is robosuite's ``robot0_eef_quat``
_FINGERS = ("gripper0_finger_joint1", "gripper0_finger_joint2")
_XYZW = (1, 2, 3, 0)


class Observer:
    """Reads the observations ``keys`` of one scene; without ``keys``, all that LIBERO gives for ``objects``."""

    def __init__(self, scene: CompiledScene, objects: Sequence[str], keys: Sequence[str] | None = None) -> None:
        """Resolve names; raises ``SIM030`` if a key is unknown."""
        model, arm = scene.model, scene.arm
        self._arm, self._objects = arm, tuple(objects)
        self._bodies = np.array([scene.index.root_body(name) for name in objects], dtype=np.intp)
        self._hand = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, _HAND)
        fingers = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in _FINGERS]
        self._finger_qpos, self._finger_dof = model.jnt_qposadr[fingers], model.jnt_dofadr[fingers]
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        everything = self._all(data)
        for key in keys or ():
            if key not in everything:
                hint = near(key, everything) or f"it has {', '.join(everything)}"
                raise OntoError.of("SIM030", f"`{scene.bddl.stem}` has no observation `{key}`", hint)
        self._keys = tuple(everything) if keys is None else tuple(keys)
        self._relative = any("_to_robot0_" in key or key == OBJECT for key in self._keys)
        self.spaces: dict[str, spaces.Space[NDArray[Any]]] = {
            key: spaces.Box(-np.inf, np.inf, everything[key].shape, everything[key].dtype.type) for key in self._keys
        }

    def read(self, data: mujoco.MjData) -> dict[str, NDArray[Any]]:
        """Fresh arrays of what ``data`` holds; poses are those of its last forward pass, as in LIBERO."""
        everything = self._all(data, relative=self._relative)
        return {key: everything[key] for key in self._keys}

    def _all(self, data: mujoco.MjData, *, relative: bool = True) -> dict[str, NDArray[Any]]:
        arm = self._arm
        joints = data.qpos[arm.qpos]
        found: dict[str, NDArray[Any]] = {
            "robot0_joint_pos": joints,
            "robot0_joint_pos_cos": np.cos(joints),
            "robot0_joint_pos_sin": np.sin(joints),
            "robot0_joint_vel": data.qvel[arm.dof],
            "robot0_eef_pos": data.site_xpos[arm.site].copy(),
            "robot0_eef_quat": data.xquat[self._hand][list(_XYZW)],
            "robot0_gripper_qpos": data.qpos[self._finger_qpos],
            "robot0_gripper_qvel": data.qvel[self._finger_dof],
        }
        found[PROPRIO] = np.concatenate(list(found.values()))
        positions, quaternions = data.xpos[self._bodies], data.xquat[self._bodies][:, _XYZW]
        if relative:
            near_by, turned = _in_frame(
                positions, quaternions, data.site_xpos[arm.site], data.xquat[self._hand][list(_XYZW)]
            )
            found[OBJECT] = np.concatenate([positions, quaternions, near_by, turned], axis=1).ravel()
        for i, name in enumerate(self._objects):
            found[f"{name}_pos"], found[f"{name}_quat"] = positions[i], quaternions[i]
            if relative:
                found[f"{name}_to_robot0_eef_pos"], found[f"{name}_to_robot0_eef_quat"] = near_by[i], turned[i]
        return found


def _in_frame(
    positions: NDArray[np.float64],
    quaternions: NDArray[np.float64],
    origin: NDArray[np.float64],
    turn: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Poses (n, 3) and (n, 4) as seen from the frame at ``origin`` (3,) with orientation ``turn`` (4,), all xyzw.

    LIBERO computes these in float32, so that they agree to 1e-6. As there, the quaternion's w is not negative.
    """
    vector, w = -turn[:3], turn[3]  # the inverse
    shifted = positions - origin
    crossed = np.cross(vector, shifted)
    moved = shifted + 2.0 * (w * crossed + np.cross(vector, crossed))
    others, v = quaternions[:, 3], quaternions[:, :3]
    result = np.empty_like(quaternions)
    result[:, :3] = w * v + others[:, None] * vector + np.cross(vector, v)
    result[:, 3] = w * others - v @ vector
    result *= np.where(result[:, 3] < 0.0, -1.0, 1.0)[:, None]
    return moved, result.astype(np.float32)
