"""Paths through free space: up, over obstacles, and down."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.motion import Motion, reach
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["corridor_height", "transit", "way_out"]

Array = NDArray[np.float64]

HAND = 0.07  # metres on both sides of the path that the hand takes up
MARGIN = 0.025
ROOM = 0.01  # metres that are left beside what rises
CEILING = 1.55  # metres; above it the arm is stretched


def corridor_height(points: Array, start: Array, goal: Array, radius: float = HAND) -> float:
    """The largest z of ``points`` (n, 3) within ``radius`` of the segment between two places, seen from above."""
    if not len(points):
        return -np.inf
    along = goal[:2] - start[:2]
    length = float(along @ along)
    offset = points[:, :2] - start[:2]
    part = np.clip(offset @ along / length, 0.0, 1.0) if length > 1e-12 else np.zeros(len(points))
    distance = np.linalg.norm(offset - part[:, None] * along, axis=1)
    return float(points[distance < radius, 2].max(initial=-np.inf))


def way_out(cloud: Array, around: Array) -> Array:
    """The least horizontal offset (3,) after which ``cloud`` (n, 3) can rise without meeting ``around`` (m, 3).

    Zero if nothing is above it, and if every direction is blocked.
    """
    low, high = cloud.min(axis=0) - ROOM, cloud.max(axis=0) + ROOM
    above = around[(around[:, 2] > cloud[:, 2].max()) & (around[:, 2] < CEILING)]
    beside = around[(around[:, 2] > low[2] + 3 * ROOM) & (around[:, 2] < high[2])]
    for distance in (0.0, *np.arange(0.02, 0.21, 0.02)):
        for angle in np.arange(16) * np.pi / 8 if distance else (0.0,):
            offset = distance * np.array([np.cos(angle), np.sin(angle), 0.0])
            if not _inside(above, low + offset, high + offset) and not _inside(beside, low + offset, high + offset):
                return np.asarray(offset)
    return np.zeros(3)


def _inside(points: Array, low: Array, high: Array) -> bool:
    """Whether any of ``points`` lies in the box, seen from above."""
    return bool(((points[:, :2] > low[:2]) & (points[:, :2] < high[:2])).all(axis=1).any())


def transit(world: SkillWorld, goal: Pose, gripper: float, *, carried: str | None = None) -> Motion:
    """Go to ``goal`` from above, clear of everything in between; ``carried`` hangs below the gripper."""
    if np.linalg.norm(goal.position[:2] - world.eef.position[:2]) > 0.02:
        height = _over(world, goal, carried)
        for _ in range(2):  # a carried object may sag on the way up
            now = world.eef
            if now.position[2] < height - 0.01:
                up = Pose(np.array([*now.position[:2], height]), now.rotation)
                yield from reach(world, up, gripper, near=0.015, turned=1.0)
            height = _over(world, goal, carried)
        across = Pose(np.array([*goal.position[:2], height]), goal.rotation)
        yield from reach(world, across, gripper, near=0.012, turned=0.12)
    return (yield from reach(world, goal, gripper))


def _over(world: SkillWorld, goal: Pose, carried: str | None) -> float:
    """The height (m) at which the gripper passes over all obstacles between it and ``goal``."""
    now = world.eef
    below, radius = TIP, HAND
    if carried is not None:
        cloud = world.cloud(carried)
        below = max(TIP, now.position[2] - float(cloud[:, 2].min()))
        radius = max(HAND, float(np.linalg.norm(cloud[:, :2] - now.position[:2], axis=1).max()) + 0.01)
    points = world.surroundings(*([carried] if carried else []))
    over = corridor_height(points, now.position, goal.position, radius) + below + MARGIN
    return min(max(over, float(goal.position[2])), CEILING)
