"""Poses of the gripper: a position and a rotation whose columns are closing, lateral and approach direction."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = ["Pose", "axis_angle", "frame", "nearest_twin", "rotation_vector", "turn", "wrapped"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """``position`` (3,) in metres and ``rotation`` (3, 3), local to world."""

    position: Array
    rotation: Array

    def __matmul__(self, other: Pose) -> Pose:
        """The composition of two transforms: ``other`` is relative to this pose."""
        return Pose(self.position + self.rotation @ other.position, self.rotation @ other.rotation)

    def inverse(self) -> Pose:
        """The pose of the world in the frame of this one."""
        return Pose(-self.rotation.T @ self.position, self.rotation.T)

    def moved(self, offset: Array) -> Pose:
        """The same pose, shifted by ``offset`` (3,) in the world."""
        return Pose(self.position + offset, self.rotation)

    def backed(self, distance: float) -> Pose:
        """The same pose, withdrawn by ``distance`` against its approach direction."""
        return Pose(self.position - distance * self.rotation[:, 2], self.rotation)


def frame(approach: Array, closing: Array) -> Array:
    """The rotation (3, 3) whose z is ``approach`` and whose x is ``closing``, made perpendicular to it."""
    z = approach / np.linalg.norm(approach)
    x = closing - (closing @ z) * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def nearest_twin(rotation: Array, current: Array) -> Array:
    """``rotation`` or the same turned by half a turn about its approach: a gripper has two equal fingers."""
    twin = rotation * np.array([-1.0, -1.0, 1.0])
    return rotation if np.trace(rotation.T @ current) >= np.trace(twin.T @ current) else twin


def rotation_vector(rotation: Array) -> Array:
    """Axis times angle (3,) of a rotation (3, 3)."""
    quat, vector = np.zeros(4), np.zeros(3)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(rotation).ravel())
    mujoco.mju_quat2Vel(vector, quat, 1.0)
    return vector


def axis_angle(axis: Array, angle: float) -> Array:
    """Rotation (3, 3) by ``angle`` (rad) about the unit vector ``axis``."""
    quat, flat = np.zeros(4), np.zeros(9)
    mujoco.mju_axisAngle2Quat(quat, axis, angle)
    mujoco.mju_quat2Mat(flat, quat)
    return flat.reshape(3, 3)


def turn(start: Array, goal: Array) -> float:
    """Angle (rad) between two rotations."""
    return float(np.linalg.norm(rotation_vector(goal @ start.T)))


def wrapped(angle: float) -> float:
    """The same angle (rad) between minus pi and pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
