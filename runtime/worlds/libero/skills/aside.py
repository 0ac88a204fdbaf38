"""Free spots on the table or floor where an object can be set aside, out of the way of later motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.scene.geometry import level
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.heights import CELL, relief_of, underside
from runtime.worlds.libero.skills.place import PlacingSpot
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Way", "free_spots"]

Array = NDArray[np.float64]
Way = tuple[Array, Array]  # from and to, (2,) each, in the world

AWAY = np.arange(0.08, 0.5, 0.03)  # metres from where the object is
TURNS = np.arange(16) * np.pi / 8
GAP = 0.03  # metres on all sides, for the fingers
AROUND = 0.75  # metres from the object that are looked at
EVEN = 0.005  # metres of height that a surface may vary by
BORNE = 0.025  # metres from the rim to the next point of the surface
ROOM = 0.07  # metres between a way and what stands beside it: half of another object, or of the hand
BEHIND = 0.2  # metres
RIM = np.arange(8) * np.pi / 4


def free_spots(
    world: SkillWorld, entity: str, holds: Callable[[Pose], bool], ways: Sequence[Way] = ()
) -> list[PlacingSpot]:
    """Spots where ``entity`` can stand on the table or floor with nothing next to or above it, the nearest first.

    ``holds`` says whether the required fact is true with the object at a pose. Spots near one of ``ways``, the paths of
    other objects, or near where the hand starts a push are left out unless there are no others.
    """
    body = world.pose(entity)
    upright = level(body.rotation, np.pi / 2)
    cloud = (world.cloud(entity) - body.position) @ body.rotation @ upright.T
    under, corner = underside(cloud)
    radius = float(np.linalg.norm(cloud[:, :2], axis=1).max())
    ground, obstacles = _ground(world, body.position), world.points(_obstacles(world, entity))
    relief = relief_of(ground, body.position, AROUND)
    found = []
    for away, angle in product(AWAY, TURNS):
        over = body.position[:2] + away * np.array([np.cos(angle), np.sin(angle)])
        height = relief.drop(under, over + corner)
        if np.isfinite(height) and _bears(ground, over, radius) and _is_free(obstacles, over, radius + GAP):
            found.append(PlacingSpot(Pose(np.array([*over, height]), upright), float(away)))
    top = max((spot.pose.position[2] for spot in found), default=0.0)
    found = [spot for spot in found if spot.pose.position[2] > top - EVEN and holds(spot.pose)]
    clear = [spot for spot in found if all(_apart(spot, way) > radius + ROOM for way in ways)]
    return clear or found


def _obstacles(world: SkillWorld, entity: str) -> list[int]:
    """The bodies of all objects and fixtures but ``entity``."""
    return [int(body) for name in world.index.entities if name != entity for body in world.index.bodies(name)]


def _ground(world: SkillWorld, centre: Array) -> Array:
    """Surface points (n, 3) near ``centre`` of what belongs to no object, no fixture and not to the robot."""
    model, shapes = world.model, world.shapes
    owned = {int(body) for name in world.index.entities for body in world.index.bodies(name)}
    bodies = [int(body) for body in shapes.bodies if not shapes.robot[body] and int(body) not in owned]
    points = world.points(bodies)
    parts = [points[np.linalg.norm(points[:, :2] - centre[:2], axis=1) < AROUND]]
    steps = np.arange(-AROUND, AROUND, 2 * CELL)
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE):  # has no end, and no points
        x, y = (axis.ravel() for axis in np.meshgrid(centre[0] + steps, centre[1] + steps))
        parts.append(np.column_stack([x, y, np.full(x.size, world.data.geom_xpos[geom][2])]))
    return np.concatenate(parts)


def _bears(ground: Array, over: Array, radius: float) -> bool:
    """Whether the surface below a disc around ``over`` (2,) is even and reaches beyond its rim."""
    away = ground[:, :2] - over
    near = ground[np.linalg.norm(away, axis=1) < radius + BORNE]
    top = near[:, 2].max(initial=-np.inf)
    surface = near[near[:, 2] > top - EVEN, :2] - over
    rim = radius * np.stack([np.cos(RIM), np.sin(RIM)], axis=1)
    gaps = np.linalg.norm(surface[:, None] - rim, axis=2).min(axis=0, initial=np.inf)
    return bool((gaps < BORNE).all())


def _is_free(obstacles: Array, over: Array, radius: float) -> bool:
    return bool((np.linalg.norm(obstacles[:, :2] - over, axis=1) > radius).all())


def _apart(spot: PlacingSpot, way: Way) -> float:
    """Metres from ``spot`` to a way that begins ``BEHIND`` its start, seen from above."""
    start, end = way
    length = max(float(np.linalg.norm(end - start)), 1e-9)
    along, away = (end - start) / length, spot.pose.position[:2] - start
    part = np.clip(away @ along, -BEHIND, length)
    return float(np.linalg.norm(away - part * along))
