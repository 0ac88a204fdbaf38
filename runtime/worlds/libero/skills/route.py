"""Paths of the free gripper to a pose that may be horizontal: the first without collision of the arm.

:mod:`runtime.worlds.libero.skills.transit` comes from above; a handle is approached from the front, with the hand
lying down.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.frames import Pose, axis_angle, rotation_vector, turn
from runtime.worlds.libero.skills.motion import Motion, action_towards
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.transit import CEILING
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["between", "clear", "glide", "loose", "route", "travel"]

Array = NDArray[np.float64]

STEP, TURN = 0.015, 0.11  # what the arm does in a control step at full speed: metres, radians
WAIT = 15  # control steps
SPARSE = 3  # control steps between two poses that are looked at
LAG, LAG_TURN = 0.04, 0.35  # metres and radians of lag at which the moving goal waits
SOFT = 1.0  # metres, deeper than anything is
RISES = (0.08, 0.16, 0.24)  # metres


def between(start: Pose, goal: Pose, every: float = SPARSE) -> Iterator[Pose]:
    """The poses on the straight way, one in ``every`` control steps at full speed, ``goal`` last."""
    line = _Line(start, goal)
    for step in np.arange(every, line.steps, every):
        yield line.at(step / line.steps)
    yield goal


class _Line:
    """A straight way on which position and rotation advance together."""

    def __init__(self, start: Pose, goal: Pose) -> None:
        self._start, self._goal = start, goal
        self._offset = goal.position - start.position
        twist = rotation_vector(goal.rotation @ start.rotation.T)
        self._angle = float(np.linalg.norm(twist))
        self._axis = twist / self._angle if self._angle > 1e-9 else np.array([0.0, 0.0, 1.0])
        self.steps = max(float(np.linalg.norm(self._offset)) / STEP, self._angle / TURN, 1.0)

    def at(self, fraction: float) -> Pose:
        """The pose after a share of the way."""
        if fraction >= 1.0:
            return self._goal
        turned = axis_angle(self._axis, fraction * self._angle)
        return Pose(self._start.position + fraction * self._offset, turned @ self._start.rotation)


def loose(world: SkillWorld) -> dict[int, float]:
    """The bodies of movable objects, with a depth above that of any contact: they may be pushed."""
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
    """Whether the arm can follow ``ways`` from ``start`` without collision, except with bodies that it ``touches``.

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


def route(world: SkillWorld, reach_: Reach, goal: Pose, *, aperture: float) -> list[Pose] | None:
    """Poses to pass through, ``goal`` last; None if every path that is tried collides.

    If all paths collide, movable objects are ignored.
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


def travel(world: SkillWorld, ways: Sequence[Pose], gripper: float, *, near: float = 0.01) -> Motion:
    """Pass through ``ways`` and stop at the last, to ``near`` (m); True when it arrived."""
    for pose in ways[:-1]:
        yield from glide(world, pose, gripper, near=0.03, turned=0.4)
    return (yield from glide(world, ways[-1], gripper, near=near, turned=0.1))


def glide(
    world: SkillWorld,
    goal: Pose,
    gripper: float,
    *,
    near: float,
    turned: float,
    most: int | None = None,
    until: Callable[[], bool] | None = None,
) -> Motion:
    """Follow the straight line to ``goal`` with a goal that moves ahead, and waits if the arm lags behind.

    A hand that turns much would leave the line by ten centimetres if it were sent to the end at once. True if it
    arrived to ``near`` (m) and ``turned`` (rad), or ``until``; ``most`` is the largest number of steps.
    """
    line = _Line(world.eef, goal)
    done = 0.0
    for _ in range(int(3 * line.steps) + WAIT if most is None else most):
        now = world.eef
        if until is not None and until():
            return True
        if float(np.linalg.norm(goal.position - now.position)) < near and turn(now.rotation, goal.rotation) < turned:
            return True
        here = line.at(done)
        behind = float(np.linalg.norm(here.position - now.position))
        if behind < LAG and turn(now.rotation, here.rotation) < LAG_TURN:
            done = min(1.0, done + 1.0 / line.steps)
        yield action_towards(world, line.at(done), gripper)
    return False
