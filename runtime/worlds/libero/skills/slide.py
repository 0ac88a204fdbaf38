"""Slide a flat object over the surface that it lies on: set the open fingers behind it and push.

Two spread finger tips guide a round rim like a fork; a grasp of a sloping rim would slip.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.scene.targets import PlacementTarget
from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose, frame, nearest_twin
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.motion import OPEN, Action, action_towards, reach
from runtime.worlds.libero.skills.pick import APPROACH
from runtime.worlds.libero.skills.place import RETREAT, UP
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.transit import transit
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Slide", "lies_flat", "slide", "slides"]

Array = NDArray[np.float64]

FLAT = 0.03  # metres; what is no higher is slid rather than lifted
SAME = 0.02  # metres between two heights that count as one
BEHIND = 0.014  # metres from the object's rim to the finger tips, before the push
ABOVE = 0.003  # metres from the support to the finger tips
TILTS = (0.0, 0.35, 0.7, 0.95)  # rad, of the hand over the object
TURNS = (0.0, 0.35, -0.35, 0.7, -0.7)  # rad, of the push against the straight way
ARRIVED = 0.006  # metres
PUSHED = 90  # steps at most
SPEED = 0.6
DOWN = 3.0  # how much stiffer the height is held than the rest: a rim wants to lift the fingers
STUCK = 15  # steps without the object moving


@dataclass(frozen=True, slots=True, eq=False)
class Slide:
    """Push ``entity`` from the gripper's ``start``, its hand leaning by ``tilt`` (rad), up to ``goal`` (2,)."""

    entity: str
    start: Pose
    tilt: float
    goal: Array


def lies_flat(world: SkillWorld, target: PlacementTarget) -> bool:
    """Whether the subject is low, and its target is a region of the surface that it lies on."""
    if target.site is None or target.parent is not None:
        return False
    cloud = world.cloud(target.subject)
    level = world.site_pose(target.site).position[2]
    return float(np.ptp(cloud[:, 2])) < FLAT and abs(float(cloud[:, 2].min()) - level) < SAME


def slides(world: SkillWorld, reach_: Reach, entity: str, goal: Array) -> Iterator[Slide]:
    """Ways to push ``entity`` to ``goal`` (2,) that the arm can begin, the straightest and most upright first."""
    cloud, body = world.cloud(entity), world.pose(entity)
    way = _heading(goal - body.position[:2])
    joints = reach_.begin()
    for turn in TURNS:
        along = np.array([*_turned(way, turn), 0.0])
        back = float(-((cloud - body.position) @ along).min())
        tip = body.position - (back + BEHIND) * along
        tip[2] = cloud[:, 2].min() + ABOVE
        for tilt in TILTS:
            rotation = nearest_twin(_fork(along, tilt), world.eef.rotation)
            pose = Pose(tip - TIP * rotation[:, 2], rotation)
            reach_.begin()
            if reach_.solve(pose, joints).feasible and reach_.solve(pose.backed(APPROACH), joints).feasible:
                yield Slide(entity, pose, tilt, goal)
                break


def slide(world: SkillWorld, plan: Slide) -> Generator[Action, None, None]:
    """Carry out ``plan``; raises :class:`SkillFault` where the object does not move along."""
    yield from transit(world, plan.start.backed(APPROACH), OPEN)
    yield from reach(world, plan.start, OPEN, steps=30)
    height = world.eef.position[2]
    idle, best = 0, np.inf
    for _ in range(PUSHED):
        left = plan.goal - world.pose(plan.entity).position[:2]
        distance = float(np.linalg.norm(left))
        if distance < ARRIVED:
            break
        idle = 0 if distance < best - 1e-3 else idle + 1
        best = min(best, distance)
        if idle > STUCK:
            raise SkillFault("missed", f"`{plan.entity}` does not slide any further")
        now = world.eef
        # Stay behind the object, on the line through its middle and the goal.
        behind = (now.position - world.pose(plan.entity).position)[:2]
        heading = left / distance
        rotation = nearest_twin(_fork(np.array([*heading, 0.0]), plan.tilt), now.rotation)
        aside = behind - (behind @ heading) * heading
        step = np.array([*(0.06 * heading - aside), DOWN * (height - now.position[2])])
        yield action_towards(world, Pose(now.position + step, rotation), OPEN, SPEED)
    yield from reach(world, world.eef.moved(-0.02 * np.array([*_heading(left), 0.0])), OPEN, steps=8)
    yield from reach(world, world.eef.moved(RETREAT * UP), OPEN, near=0.02, steps=20)


def _fork(along: Array, tilt: float) -> Array:
    """The gripper's rotation for a push ``along``: the fingers side by side across it, the hand leaning over it."""
    approach = -np.sin(tilt) * along - np.cos(tilt) * UP
    return frame(approach, np.cross(UP, along))


def _heading(vector: Array) -> Array:
    return np.asarray(vector[:2] / max(float(np.linalg.norm(vector[:2])), 1e-9))


def _turned(way: Array, angle: float) -> tuple[float, float]:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    return c * way[0] - s * way[1], s * way[0] + c * way[1]
