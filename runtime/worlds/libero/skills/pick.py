"""Pick an object: choose a reachable grasp, approach, close, lift, and check that the object is held."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.grasping import Grasp, Search, find_grasps
from runtime.worlds.libero.skills.motion import CLOSED, EMPTY, OPEN, Action, close, reach
from runtime.worlds.libero.skills.transit import transit, way_out
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Holding", "alike", "grasps_of", "pick"]

Array = NDArray[np.float64]

APPROACH = 0.08  # metres before the grasp
LIFT = 0.05
OFF_GROUND = 0.006  # metres, while it is pulled out from under something
KEPT = 0.5  # share of the gripper's rise that a held object must follow
NEIGHBOURHOOD = 0.25
FAR = 0.02  # metres from the grasp, at which closing makes no sense


@dataclass(frozen=True, slots=True, eq=False)
class Holding:
    """The held object, and its pose in the gripper's frame."""

    entity: str
    local: Pose


def grasps_of(world: SkillWorld, entity: str, search: Search | None = None) -> list[Grasp]:
    """All free grasps of an entity, the best first."""
    cloud = world.cloud(entity)
    around = world.surroundings(entity)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    centre = np.append(world.data.xipos[world.index.root_body(entity)][:2], 0.5 * (low[2] + high[2]))
    near = world.near(around, centre, NEIGHBOURHOOD)
    # The surface below the object limits the depth; the tips stay 3 mm above it.
    return find_grasps(cloud, near[near[:, 2] > low[2] + 0.002], centre, float(low[2]) + 0.003, world.eef, search)


def alike(a: Pose, b: Pose) -> bool:
    """Whether two grasps are nearly the same."""
    across = abs(float(a.rotation[:, 0] @ b.rotation[:, 0]))
    return float(np.linalg.norm(a.position - b.position)) < 0.012 and across > 0.95


def pick(world: SkillWorld, entity: str, grasp: Grasp) -> Generator[Action, None, Holding]:
    """Grasp and lift ``entity``; raises :class:`SkillFault` if it is not held."""
    body = world.pose(entity)
    local = body.inverse() @ grasp.pose  # the grasp follows the object if it moves meanwhile
    yield from transit(world, grasp.pose.backed(APPROACH), OPEN)
    goal = world.pose(entity) @ local
    yield from reach(world, goal, OPEN, near=0.004, speed=0.7, steps=50)
    if np.linalg.norm(world.eef.position - goal.position) > FAR:
        raise SkillFault("unreachable", f"the gripper did not reach its grasp of `{entity}`")
    point = world.pose(entity).inverse() @ goal  # where it is held: what is held at its end hangs down
    before = goal.position[2]
    if not (yield from close(world, goal)):
        raise SkillFault("lost", f"the fingers closed beside `{entity}`")
    out = way_out(world.cloud(entity), world.surroundings(entity))
    if out.any():
        yield from reach(world, world.eef.moved(out + np.array([0.0, 0.0, OFF_GROUND])), CLOSED, near=0.012, speed=0.6)
    start = world.eef
    before += start.position[2] - goal.position[2]
    yield from reach(world, start.moved(np.array([0.0, 0.0, LIFT])), CLOSED, near=0.012, steps=20)
    risen = float((world.pose(entity) @ point).position[2] - before)
    if risen < KEPT * (world.eef.position[2] - start.position[2]) or world.aperture < EMPTY:
        raise SkillFault("lost", f"`{entity}` was not lifted: it rose {1000 * risen:.0f} mm")
    return Holding(entity, world.eef.inverse() @ world.pose(entity))
