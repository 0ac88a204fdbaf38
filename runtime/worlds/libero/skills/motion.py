"""Motions as generators: each yields an action, reads the resulting world, and returns whether it arrived.

An action is OSC_POSE's: (7,) in [-1, 1], position, rotation vector, gripper (-1 opens, +1 closes). Steps are control
steps of 1/20 s. Because a motion never touches the simulation, the same one drives a real run, a rehearsal in a fork,
or anything else that takes actions.
"""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.frames import Pose, rotation_vector
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["CLOSED", "EMPTY", "OPEN", "Action", "Motion", "action_towards", "close", "grip", "reach"]

Array = NDArray[np.float64]
Action = NDArray[np.float64]
Motion = Generator[Action, None, bool]

OPEN, CLOSED = -1.0, 1.0
POSITION_GAIN, ROTATION_GAIN = 3.0, 2.0
POSITION_UNIT, ROTATION_UNIT = 0.05, 0.5  # what an action of 1 asks for, metres and radians
NEAR, TURNED = 0.006, 0.06
SETTLED = 2e-4  # metres a step
EMPTY = 1.5e-3  # metres between fingers that hold nothing
STALLED = 12  # steps without progress


def action_towards(world: SkillWorld, pose: Pose, gripper: float, speed: float = 1.0) -> Action:
    """The action that moves the gripper towards ``pose``; whole vectors are scaled, so that the path is straight."""
    now = world.eef
    move = POSITION_GAIN * (pose.position - now.position) / POSITION_UNIT
    twist = ROTATION_GAIN * rotation_vector(pose.rotation @ now.rotation.T) / ROTATION_UNIT
    return np.concatenate([_bounded(move, speed), _bounded(twist, speed), [gripper]])


def reach(
    world: SkillWorld,
    pose: Pose,
    gripper: float,
    *,
    near: float = NEAR,
    turned: float = TURNED,
    speed: float = 1.0,
    steps: int = 80,
    until: Callable[[], bool] | None = None,
) -> Motion:
    """Move in a straight line to ``pose``; True when it arrived to ``near`` (m) and ``turned`` (rad), or ``until``."""
    best, idle = np.inf, 0
    for _ in range(steps):
        now = world.eef
        away = float(np.linalg.norm(pose.position - now.position))
        angle = float(np.linalg.norm(rotation_vector(pose.rotation @ now.rotation.T)))
        if (away < near and angle < turned) or (until is not None and until()):
            return True
        left = away + 0.1 * angle
        idle = 0 if left < best - 5e-4 else idle + 1
        best = min(best, left)
        if idle > STALLED:
            return away < 2 * near and angle < 2 * turned
        yield action_towards(world, pose, gripper, speed)
    return False


def grip(world: SkillWorld, gripper: float, steps: int, pose: Pose | None = None) -> Motion:
    """Open or close for ``steps``, holding ``pose`` (where the gripper is, when none is given)."""
    hold = pose or world.eef
    for _ in range(steps):
        yield action_towards(world, hold, gripper)
    return True


def close(world: SkillWorld, pose: Pose | None = None, *, least: int = 8, most: int = 20) -> Motion:
    """Close until the fingers stand still; True unless they met each other."""
    hold, before = pose or world.eef, np.inf
    for step in range(most):
        if step >= least and before - world.aperture < SETTLED:
            break
        before = world.aperture
        yield action_towards(world, hold, CLOSED)
    return world.aperture > EMPTY


def _bounded(vector: Array, limit: float) -> Array:
    size = float(np.abs(vector).max())
    return vector * (limit / size) if size > limit else vector
