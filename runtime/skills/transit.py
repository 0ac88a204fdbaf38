"""Paths through free space: up, over what stands in between, and down."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from runtime.skills.frames import Pose
from runtime.skills.grasping import TIP
from runtime.skills.motion import Motion, reach
from runtime.skills.world import World

__all__ = ["corridor_height", "transit"]

Array = NDArray[np.float64]

HAND = 0.07  # metres on both sides of the path that the hand takes up
MARGIN = 0.025
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


def transit(world: World, goal: Pose, gripper: float, *, carried: str | None = None) -> Motion:
    """Go to ``goal`` from above, clear of everything in between; ``carried`` hangs below the gripper."""
    now = world.eef
    below, radius = TIP, HAND
    if carried is not None:
        cloud = world.cloud(carried)
        below = max(TIP, now.position[2] - float(cloud[:, 2].min()))
        radius = max(HAND, float(np.linalg.norm(cloud[:, :2] - now.position[:2], axis=1).max()) + 0.01)
    points = world.surroundings(*([carried] if carried else []))
    over = corridor_height(points, now.position, goal.position, radius) + below + MARGIN
    height = min(max(over, goal.position[2]), CEILING)
    if np.linalg.norm(goal.position[:2] - now.position[:2]) > 0.02:
        if now.position[2] < height - 0.01:
            up = Pose(np.array([*now.position[:2], height]), now.rotation)
            yield from reach(world, up, gripper, near=0.015, turned=1.0)
        across = Pose(np.array([*goal.position[:2], height]), goal.rotation)
        yield from reach(world, across, gripper, near=0.012, turned=0.12)
    return (yield from reach(world, goal, gripper))
