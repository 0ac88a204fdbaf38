"""The native environment's order of calls around robosuite's controller: bit-identical, without the overhead.

Source: robosuite 1.4.0, ``environments/base.py`` (``step``) and ``robots/single_arm.py`` (``control``).
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.native_import import control_env
from runtime.worlds.libero.simulator.touch import GRIPPER_SPEED, sides
from runtime.worlds.native_import import quiet
from runtime.worlds.snapshot import give_back, held_by

__all__ = ["ExactStepper"]


class ExactStepper:
    """Steps ``data`` as robosuite does; three forward passes a substep."""

    def __init__(self, scene: CompiledScene, data: mujoco.MjData) -> None:
        """Make robosuite's controller over ``data``; raises ``SIM010`` if robosuite cannot be imported."""
        control_env()  # configures LIBERO and robosuite before they are imported
        binding = importlib.import_module("robosuite.utils.binding_utils")
        controllers = importlib.import_module("robosuite.controllers")
        self._scene, self._model, self._data = scene, scene.model, data
        self._fingers = scene.arm.fingers
        limits = scene.model.actuator_ctrlrange[self._fingers]
        self._bias, self._weight = 0.5 * (limits[:, 1] + limits[:, 0]), 0.5 * (limits[:, 1] - limits[:, 0])
        self._gripper = np.zeros(1)
        self._side = np.empty(0, dtype=np.int16)
        self.touched = np.zeros((0, 0), dtype=np.bool_)
        with quiet():
            sim = binding.MjSim(scene.model)
            sim.data = binding.MjData(sim.model)
            sim.data._data = data  # noqa: SLF001  robosuite makes its own, and gives no other way in
            arm = scene.arm
            self._controller = controllers.controller_factory(
                "OSC_POSE",
                {
                    **controllers.load_controller_config(default_controller="OSC_POSE"),
                    "robot_name": "Panda",
                    "sim": sim,
                    "eef_name": mujoco.mj_id2name(scene.model, mujoco.mjtObj.mjOBJ_SITE, arm.site),
                    "joint_indexes": {"joints": arm.dof, "qpos": arm.qpos, "qvel": arm.dof},
                    "actuator_range": (arm.torque_low, arm.torque_high),
                    "policy_freq": 20,
                    "ndim": len(arm.dof),
                },
            )

    def watch(self, entities: Sequence[NDArray[np.intp]]) -> None:
        """Accumulate from now on which of ``entities`` (each its geom ids) touch in any substep, in ``touched``."""
        self._side = sides(self._model.ngeom, entities)
        self.touched = np.zeros((len(entities), len(entities)), dtype=np.bool_)

    def step(self, action: NDArray[np.float64], before_last_substep: Callable[[], object] | None = None) -> None:
        """Take one control step with ``action`` (7,), finite; ``before_last_substep`` is called when it is due."""
        self._before = self.take()
        model, data, controller, arm = self._model, self._data, self._controller, self._scene.arm
        gripper = np.sign(action[6:])
        for substep in range(self._scene.substeps):
            if before_last_substep is not None and substep == self._scene.substeps - 1:
                before_last_substep()
            mujoco.mj_forward(model, data)
            if substep == 0:
                controller.set_goal(action[:6])
            torques = np.clip(controller.run_controller(), arm.torque_low, arm.torque_high)
            moved = self._gripper + np.array([-1.0, 1.0]) * GRIPPER_SPEED * gripper
            self._gripper = np.clip(moved, -1.0, 1.0)
            data.ctrl[self._fingers] = self._bias + self._weight * self._gripper
            data.ctrl[arm.actuators] = torques
            self._touch()
            mujoco.mj_step(model, data)

    def _touch(self) -> None:
        if self._side.size and self._data.ncon:
            first, second = self._side[self._data.contact.geom].T
            met = (first >= 0) & (second >= 0)
            self.touched[first[met], second[met]] = self.touched[second[met], first[met]] = True

    def take(self, *, before: bool = False) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Copy the gripper's current action and the controller's state, now or ``before`` the last step."""
        if before:
            return self._before
        return self._gripper.copy(), held_by(self._controller)

    def put(self, gripper: NDArray[np.float64], controller: Mapping[str, Any]) -> None:
        """Write both back."""
        self._gripper = gripper.copy()
        give_back(self._controller, controller)
