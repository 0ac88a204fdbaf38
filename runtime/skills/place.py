"""Place a held object: find where it comes to rest in its target, go over it, lower, let go, and withdraw."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.proposers.geometry import level
from runtime.proposers.targets import Place
from runtime.skills.fault import SkillFault
from runtime.skills.frames import Pose
from runtime.skills.motion import CLOSED, OPEN, Action, grip, reach
from runtime.skills.pick import Holding
from runtime.skills.reach import Reach
from runtime.skills.transit import transit
from runtime.skills.world import World

__all__ = ["Spot", "place", "resting_height", "spots"]

Array = NDArray[np.float64]

CELL = 0.01  # metres, of the height map
RELEASE = 0.008  # metres above where it rests
OPENING = 6  # steps
RETREAT = 0.10
OFFSETS = (0.0, 0.012, -0.012, 0.024, -0.024, 0.036, -0.036)


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A pose for the object to be let go at, and a ``cost``."""

    pose: Pose
    cost: float


def resting_height(cloud: Array, around: Array, reference: float) -> float:
    """By how much ``cloud`` (n, 3) can be lowered until it meets ``around`` (m, 3) from above; ``reference`` limits it.

    Both are compared in vertical columns of one centimetre. Negative where they overlap.
    """
    bottom = _extreme(cloud, np.minimum, np.inf)
    low = cloud[:, 2].min()
    relevant = around[np.abs(around[:, :2] - cloud[:, :2].mean(axis=0)).max(axis=1) < 0.3]
    top = _extreme(relevant, np.maximum, -np.inf)
    gaps = [height - top[key] for key, height in bottom.items() if key in top]
    return float(min([*gaps, low - reference]))


def _extreme(points: Array, pick: np.ufunc, empty: float) -> dict[tuple[int, int], float]:
    if not len(points):
        return {}
    keys, where = np.unique(np.floor(points[:, :2] / CELL).astype(int), axis=0, return_inverse=True)
    values = np.full(len(keys), empty)
    pick.at(values, where.ravel(), points[:, 2])
    return {(int(a), int(b)): float(v) for (a, b), v in zip(keys, values, strict=True)}


def spots(world: World, entity: str, target: Place, rotation: Array | None = None) -> list[Spot]:
    """Where ``entity`` can be let go so that it comes to rest in ``target``, the best first."""
    body = world.pose(entity)
    upright = level(body.rotation) if rotation is None else rotation
    cloud = (world.cloud(entity) - body.position) @ body.rotation @ upright.T  # around the origin, as it will be held
    if target.site is not None:
        frame, half = world.site_pose(target.site), world.site_half(target.site)
    else:
        other = world.pose(str(target.parent))
        frame, half = Pose(other.position, np.eye(3)), np.array([0.028, 0.028, 0.2])
    around = world.surroundings(entity)
    found = []
    for dx in OFFSETS:
        for dy in OFFSETS:
            if abs(dx) > 0.8 * half[0] or abs(dy) > 0.8 * half[1]:
                continue
            xy = (frame.position + frame.rotation @ np.array([dx, dy, 0.0]))[:2]
            lifted = cloud + np.array([*xy, frame.position[2] + 0.6])
            drop = resting_height(lifted, around, frame.position[2] - 0.3)
            z = frame.position[2] + 0.6 - drop
            found.append(Spot(Pose(np.array([*xy, z]), upright), float(z + 0.35 * np.hypot(dx, dy))))
    return sorted(found, key=lambda spot: spot.cost)


def place(world: World, holding: Holding, spot: Spot, reach_: Reach) -> Generator[Action, None, None]:
    """Bring what is held to ``spot`` and let go of it there; raises :class:`SkillFault` where it was lost."""
    goal = _raised(world, holding, spot, reach_)
    yield from transit(world, goal.moved(np.array([0.0, 0.0, 0.05])), CLOSED, carried=holding.entity)
    # It may have slipped or turned in the fingers.
    slipped = world.eef.inverse() @ world.pose(holding.entity)
    if np.linalg.norm(slipped.position - holding.local.position) > 0.06 or world.aperture < 1e-3:
        raise SkillFault("lost", f"`{holding.entity}` fell out of the gripper")
    shift = spot.pose.position[:2] - (goal @ slipped).position[:2]
    goal = goal.moved(np.array([*shift, 0.0]))
    yield from reach(world, goal, CLOSED, near=0.005, speed=0.6, steps=40)
    yield from grip(world, OPEN, OPENING)
    yield from reach(world, world.eef.backed(RETREAT), OPEN, near=0.02, steps=20)


def _raised(world: World, holding: Holding, spot: Spot, reach_: Reach) -> Pose:
    """The gripper's pose that brings the object to ``spot``, raised until the hand is clear of what is around."""
    start = reach_.begin()
    for height in (RELEASE, 0.02, 0.035, 0.05, 0.07, 0.09):
        object_pose = spot.pose.moved(np.array([0.0, 0.0, height]))
        pose = object_pose @ holding.local.inverse()
        if reach_.solve(pose, start, held=(holding.entity, holding.local), aperture=0.5 * world.aperture).feasible:
            return pose
    raise SkillFault("unreachable", f"the arm cannot bring `{holding.entity}` to its place")
