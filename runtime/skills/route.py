"""Ways of the free gripper to a pose that may lie sideways: the first that the whole arm can follow unhindered.

:mod:`runtime.skills.transit` comes from above; a handle is approached from the front, with the hand lying down.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from runtime.skills.frames import Pose, axis_angle, rotation_vector
from runtime.skills.motion import Motion, reach
from runtime.skills.reach import Reach
from runtime.skills.transit import CEILING
from runtime.skills.world import World

__all__ = ["between", "clear", "loose", "route", "travel"]

Array = NDArray[np.float64]

STEP, TURN = 0.015, 0.11  # what the arm does in a control step at full speed: metres, radians
SPARSE = 3  # control steps between two poses that are looked at
SOFT = 1.0  # metres, deeper than anything is
RISES = (0.08, 0.16, 0.24)  # metres


def between(start: Pose, goal: Pose) -> Iterator[Pose]:
    """The poses on the way, as the arm goes it: position and rotation each at full speed, ``goal`` last."""
    offset, turn = goal.position - start.position, rotation_vector(goal.rotation @ start.rotation.T)
    distance, angle = float(np.linalg.norm(offset)), float(np.linalg.norm(turn))
    steps = max(distance / STEP, angle / TURN)
    axis = turn / angle if angle > 1e-9 else np.array([0.0, 0.0, 1.0])
    for step in np.arange(SPARSE, steps, SPARSE):
        moved = min(1.0, step * STEP / distance) if distance > 1e-9 else 1.0
        turned = axis_angle(axis, min(angle, step * TURN))
        yield Pose(start.position + moved * offset, turned @ start.rotation)
    yield goal


def loose(world: World) -> dict[int, float]:
    """The bodies of movable objects, with a depth that any contact keeps below: they give way when they are touched."""
    index = world.index
    return {int(b): SOFT for name in index.entities if index.free_joint(name) is not None for b in index.bodies(name)}


def clear(
    reach_: Reach,
    start: Pose,
    joints: Array,
    ways: Sequence[Pose],
    *,
    aperture: float,
    touches: Mapping[int, float] | None = None,
) -> bool:
    """Whether the arm can follow ``ways`` from ``start`` without running into anything but what it ``touches``.

    ``joints`` (7,) is the arm at ``start``; call ``reach_.begin`` before.
    """
    for goal in ways:
        for pose in between(start, goal):
            at = reach_.solve(pose, joints, aperture=aperture, touches=touches)
            if not at.feasible:
                return False
            joints = at.joints
        start = goal
    return True


def route(world: World, reach_: Reach, goal: Pose, *, aperture: float) -> list[Pose] | None:
    """Poses to pass through, ``goal`` last; None where every way that is tried runs into something.

    Where all ways are obstructed, movable objects count no more.
    """
    start = world.eef
    joints = reach_.begin()
    for touches in ({}, loose(world)):
        for ways in _ways(start, goal):
            if clear(reach_, start, joints, ways, aperture=aperture, touches=touches):
                return ways
    return None


def _ways(start: Pose, goal: Pose) -> Iterator[list[Pose]]:
    yield [goal]
    up = np.array([0.0, 0.0, 1.0])
    for back in (0.08, 0.16):
        yield [goal.backed(back), goal]
    for rise in RISES:
        top = min(max(start.position[2], goal.position[2]) + rise, CEILING)
        over_goal = goal.moved((top - goal.position[2]) * up)
        over_start = start.moved((top - start.position[2]) * up)
        yield [over_goal, goal]
        yield [over_start, over_goal, goal]
        yield [over_start, Pose(over_goal.backed(0.08).position, goal.rotation), goal]


def travel(world: World, ways: Sequence[Pose], gripper: float) -> Motion:
    """Pass through ``ways`` and stop at the last; True when it arrived."""
    for pose in ways[:-1]:
        yield from reach(world, pose, gripper, near=0.03, turned=0.5)
    return (yield from reach(world, ways[-1], gripper, near=0.008, turned=0.1))
