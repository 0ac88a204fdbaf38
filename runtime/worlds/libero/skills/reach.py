"""Inverse kinematics on a copy of the state: whether the gripper can reach a pose, and what it would collide with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.frames import Pose, rotation_vector
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Reach", "Reached"]

Array = NDArray[np.float64]

ROUNDS = 40
DAMPING = 0.02
POSITION_WEIGHT, ROTATION_WEIGHT = 1.0, 0.3  # a radian counts as 30 cm
CLOSE = 1e-3
ROOM = 0.1  # rad, that joints stay away from their limits: the controller does not see them
SKIN = -0.002  # metres that a contact may lie inside another body
OPEN = 0.04


@dataclass(frozen=True, slots=True, eq=False)
class Reached:
    """Joint positions (7,), the remaining error (m, rad), and the deepest contact with the surroundings (m)."""

    joints: Array
    position_error: float
    rotation_error: float
    penetration: float

    @property
    def feasible(self) -> bool:
        """Whether the pose is reached to 6 mm and 0.06 rad without collision."""
        return self.position_error < 6e-3 and self.rotation_error < 0.06 and self.penetration < -SKIN


class Reach:
    """Solves poses on a scratch copy of the world's state."""

    def __init__(self, world: SkillWorld) -> None:
        self._world = world
        self._model = world.model
        self._data = mujoco.MjData(world.model)
        self._arm = world.sim.scene.arm
        low, high = world.model.jnt_range[world.model.dof_jntid[self._arm.dof]].T
        self._low, self._high = low + ROOM, high - ROOM
        self._robot = world.shapes.robot[world.model.geom_bodyid]

    def begin(self, changes: Mapping[int, float] | None = None) -> Array:
        """Copy the world's state, ``changes`` (by ``qpos`` address) made; returns the arm's joint positions (7,)."""
        self._data.qpos[:] = self._world.data.qpos
        for address, value in (changes or {}).items():
            self._data.qpos[address] = value
        return np.array(self._data.qpos[self._arm.qpos])

    def solve(
        self,
        pose: Pose,
        start: Array,
        *,
        held: tuple[str, Pose] | None = None,
        aperture: float = OPEN,
        touches: Mapping[int, float] | None = None,
    ) -> Reached:
        """Reach ``pose`` from the joint positions ``start``; ``held`` is an entity and its pose in the gripper's frame.

        ``touches`` are bodies that may be touched, and how deep (m) the contact may be before it counts. Call
        :meth:`begin` before. Joint limits are kept; the posture drifts towards the home posture as OSC's does.
        """
        model, data, arm = self._model, self._data, self._arm
        joints = start.copy()
        home = np.asarray(self._world.sim.scene.home.controller["initial_joint"])
        jacp, jacr = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        error = np.zeros(6)
        for _ in range(ROUNDS):
            data.qpos[arm.qpos] = joints
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            error[:3] = pose.position - data.site_xpos[arm.site]
            error[3:] = rotation_vector(pose.rotation @ data.site_xmat[arm.site].reshape(3, 3).T)
            if np.linalg.norm(error[:3]) < CLOSE and np.linalg.norm(error[3:]) < 5 * CLOSE:
                break
            mujoco.mj_jacSite(model, data, jacp, jacr, arm.site)
            jacobian = np.concatenate([POSITION_WEIGHT * jacp[:, arm.dof], ROTATION_WEIGHT * jacr[:, arm.dof]])
            weighted = np.concatenate([POSITION_WEIGHT * error[:3], ROTATION_WEIGHT * error[3:]])
            inverse = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + DAMPING**2 * np.eye(6))
            null = np.eye(7) - inverse @ jacobian
            joints = np.clip(joints + inverse @ weighted + 0.1 * null @ (home - joints), self._low, self._high)
        depth = self._penetration(pose, held, aperture, touches)
        return Reached(joints, float(np.linalg.norm(error[:3])), float(np.linalg.norm(error[3:])), depth)

    def _penetration(
        self, pose: Pose, held: tuple[str, Pose] | None, aperture: float, touches: Mapping[int, float] | None
    ) -> float:
        """Depth (m) of the deepest contact of the robot with the rest; the held entity moves along and may touch."""
        model, data, world = self._model, self._data, self._world
        fingers = world.sim.scene.arm.fingers
        data.qpos[model.jnt_qposadr[model.actuator_trnid[fingers, 0]]] = (aperture, -aperture)
        ours = self._robot
        if held is not None:
            name, local = held
            joint = world.index.free_joint(name)
            if joint is not None:
                placed = pose @ local
                where = world.index.qpos_slice(joint)
                quat = np.zeros(4)
                mujoco.mju_mat2Quat(quat, np.ascontiguousarray(placed.rotation).ravel())
                data.qpos[where] = np.concatenate([placed.position, quat])
            ours = ours.copy()
            ours[world.index.contact_geoms(name)] = True
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        if not data.ncon:
            return 0.0
        geoms = data.contact.geom
        crossing = ours[geoms[:, 0]] != ours[geoms[:, 1]]
        distance = data.contact.dist.copy()
        for body, depth in (touches or {}).items():
            distance[(model.geom_bodyid[geoms] == body).any(axis=1)] += depth
        return float(max(0.0, -(distance[crossing].min(initial=0.0))))
