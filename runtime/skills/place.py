"""Place a held object: find where it comes to rest in its target, go over it, lower, let go, and withdraw."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from runtime.proposers.geometry import level
from runtime.proposers.targets import Place
from runtime.skills.fault import SkillFault
from runtime.skills.frames import Pose, axis_angle
from runtime.skills.heights import CELL, relief_of, underside
from runtime.skills.motion import CLOSED, EMPTY, OPEN, Action, grip, reach
from runtime.skills.pick import Holding
from runtime.skills.transit import transit
from runtime.skills.world import World

__all__ = ["Spot", "cost_of", "place", "spots"]

Array = NDArray[np.float64]

SLIPPED = 0.06  # metres that it may move in the fingers
OPENING = 6  # steps
RETREAT = 0.10
HOVER = 0.05  # metres above the place, from where it is lowered
NEAR = 0.028  # metres between the origins of two objects that count as one on the other
KEPT = 0.8  # of a region's half extent that origins are placed in
AROUND = 0.35
FLAT = 0.98  # cosine; a site that leans more than this holds what is put along its slope
SLOPE = (0.0, 0.01, 0.02, 0.03)  # metres up the slope
LEVEL = 1e-6
TURN = 0.002  # metres that a radian of turning counts as
SUNK = 0.001  # metres below where it rests: a contact is then seen
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A pose at which the object rests, and a ``cost``: its height, and its distance from the middle."""

    pose: Pose
    cost: float


def cost_of(spot: Spot) -> float:
    """A key to sort by."""
    return spot.cost


def spots(world: World, target: Place, yaw: float, holds: Callable[[Pose], bool]) -> list[Spot]:
    """Where an object comes to rest in its ``target`` when it is let go upright and turned by ``yaw``, the best first.

    Upright is along the z of the target's site: a rack holds a bottle along its slope. ``holds`` says whether the
    required fact is true with the object at a pose; where it is true nowhere, all spots are given.
    """
    entity = target.subject
    body = world.pose(entity)
    frame, half = _area(world, target)
    upright = _stood(frame.rotation[:, 2]) @ axis_angle(UP, yaw) @ level(body.rotation)
    under, corner = underside((world.cloud(entity) - body.position) @ body.rotation @ upright.T)
    relief = relief_of(world.surroundings(entity), frame.position, AROUND)
    x, y = (np.arange(-n, n + 1) * CELL for n in (KEPT * half[:2] / CELL).astype(int).clip(0, 4))
    z = (0.0,) if abs(frame.rotation[2, 2]) > FLAT else SLOPE
    found = []
    for offset in itertools.product(x, y, z):
        over = (frame.position + frame.rotation @ np.array(offset))[:2]
        height = relief.drop(under, over + corner)
        if np.isfinite(height):
            cost = height + 0.35 * float(np.hypot(*offset[:2])) + TURN * abs(yaw)
            found.append(Spot(Pose(np.array([*over, height]), upright), cost))
    found.sort(key=cost_of)
    return [spot for spot in found if holds(spot.pose.moved(-SUNK * UP))] or found


def _stood(axis: Array) -> Array:
    """The least rotation that brings the vertical to ``axis``; none where it points down."""
    turn = np.cross(UP, axis)
    sine = float(np.linalg.norm(turn))
    if sine < LEVEL or axis[2] < 0.0:
        return np.eye(3)
    return axis_angle(turn / sine, float(np.arctan2(sine, axis[2])))


def _area(world: World, target: Place) -> tuple[Pose, Array]:
    """Frame and half extents of where the object's origin has to be, seen from above."""
    if target.site is not None:
        return world.site_pose(target.site), world.site_half(target.site)
    return Pose(world.pose(str(target.parent)).position, np.eye(3)), np.full(3, NEAR)


def place(world: World, holding: Holding, spot: Spot, release: float) -> Generator[Action, None, None]:
    """Bring what is held to ``spot``, let go ``release`` metres above it, withdraw.

    Raises :class:`SkillFault` where it was lost on the way.
    """
    drop = spot.pose.moved(np.array([0.0, 0.0, release]))
    goal = drop @ holding.local.inverse()
    yield from transit(world, goal.moved(np.array([0.0, 0.0, HOVER])), CLOSED, carried=holding.entity)
    # It may have slipped or turned in the fingers.
    slipped = world.eef.inverse() @ world.pose(holding.entity)
    if np.linalg.norm(slipped.position - holding.local.position) > SLIPPED or world.aperture < EMPTY:
        raise SkillFault("lost", f"`{holding.entity}` fell out of the gripper")
    shift = drop.position[:2] - (goal @ slipped).position[:2]
    goal = goal.moved(np.array([*shift, 0.0]))
    yield from reach(world, goal, CLOSED, near=0.005, speed=0.6, steps=40)
    yield from grip(world, OPEN, OPENING)
    yield from reach(world, world.eef.backed(RETREAT), OPEN, near=0.02, steps=20)
