"""Place a held object: find a resting pose in its target, move above it, lower, release, and withdraw."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.scene.geometry import level
from runtime.worlds.libero.scene.targets import PlacementTarget
from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose, axis_angle, rotation_vector
from runtime.worlds.libero.skills.heights import CELL, relief_of, underside
from runtime.worlds.libero.skills.motion import CLOSED, EMPTY, OPEN, Action, grip, reach
from runtime.worlds.libero.skills.pick import Holding
from runtime.worlds.libero.skills.transit import transit
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["PlacingSpot", "cost_of", "cramped", "place", "spots"]

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])

SLIPPED = 0.06  # metres that it may move in the fingers
OPENING = 6  # steps
RETREAT = 0.10
HOVER = 0.05  # metres above the place, from where it is lowered
NEAR = 0.028  # metres between the origins of two objects that count as one on the other
KEPT = 0.8  # of a region's half extent that origins are placed in
AROUND = 0.35
CRAMPED = 0.02  # metres above the floor
GAP = 0.01  # metres between neighbours
ENTERED = 12  # spots behind an opening, that are looked at
OUTSIDE = 0.18  # metres from a place behind an opening to where the hand stands before it
LIFTED = 0.01  # metres above the place, on the way in and out
SIDES = tuple(np.array([np.cos(a), np.sin(a), 0.0]) for a in np.arange(8) * np.pi / 4)
FLAT = 0.98  # cosine; a site that leans more than this holds what is put along its slope
SLOPE = (0.0, 0.01, 0.02, 0.03)  # metres up the slope
LEVEL = 1e-6
MOST = 10  # cells from the middle
OFF_CENTRE = 0.35  # metres of height that a metre from the middle counts as
TURN = 0.002  # metres that a radian of turning counts as
SUNK = 0.001  # metres below where it rests: a contact is then seen


@dataclass(frozen=True, slots=True, eq=False)
class PlacingSpot:
    """A pose at which the object rests, and a ``cost``: its height, and its distance from the middle.

    It is entered from the direction ``entry`` (3,): from above, or through an opening at the side.
    """

    pose: Pose
    cost: float
    entry: Array = field(default_factory=UP.copy)

    @property
    def before(self) -> Array:
        """The offset (3,) from which it is brought to its place."""
        return HOVER * UP if self.entry[2] > FLAT else OUTSIDE * self.entry + LIFTED * UP


def cost_of(spot: PlacingSpot) -> float:
    """A key to sort by."""
    return spot.cost


def spots(
    world: SkillWorld, target: PlacementTarget, turn: Array, holds: Callable[[Pose], bool], sharing: int = 1
) -> list[PlacingSpot]:
    """Resting poses of an object in its ``target`` when it is released upright, then turned by ``turn`` (3, 3).

    Upright is along the z of the target's site: a rack holds a bottle along its slope. The best come first. ``holds``
    says whether the required fact is true with the object at a pose; other poses are left out, unless it is true
    nowhere in a place without walls. A target with a ceiling is entered from the side. ``sharing`` objects of this size
    must fit in the target.
    """
    frame, half = _area(world, target)
    body = world.pose(target.subject)
    upright = _stood(frame.rotation[:, 2]) @ turn @ level(body.rotation)
    cloud = (world.cloud(target.subject) - body.position) @ body.rotation @ upright.T
    around = world.surroundings(target.subject)
    middles = _middles(cloud, frame, half, sharing)
    price = TURN * float(np.linalg.norm(rotation_vector(turn)))
    found = _resting(cloud, upright, around, frame, half, middles, price)
    good = [spot for spot in found if holds(spot.pose.moved(-SUNK * UP))]
    if good or not target.contains:
        return good or found
    top = frame.position[2] + float(np.abs(frame.rotation[2]) @ half)
    low = around[around[:, 2] < frame.position[2]]  # what it can rest on inside is no ceiling
    below = _resting(cloud, upright, low, frame, half, middles, price)
    inside = [spot for spot in below if holds(spot.pose.moved(-SUNK * UP))]
    some = inside[:: len(inside) // ENTERED + 1]
    near = around[np.abs(around - frame.position).max(axis=1) < AROUND]
    near = near[near[:, 2] < top]
    return [entered for spot in some for entered in _entered(spot, cloud, near)]


def cramped(world: SkillWorld, target: PlacementTarget, spot: PlacingSpot) -> bool:
    """Whether ``spot`` is on the rim of what the object has to be in, rather than on its floor."""
    if target.site is None or not target.contains:
        return False
    body = world.pose(target.subject)
    cloud = (world.cloud(target.subject) - body.position) @ body.rotation @ spot.pose.rotation.T
    under, corner = underside(cloud)
    frame = world.site_pose(target.site)
    floor = relief_of(
        world.points([int(world.model.site_bodyid[world.index.site(target.site)])]), frame.position, AROUND
    )
    return bool(spot.pose.position[2] - floor.drop(under, frame.position[:2] + corner) > CRAMPED)


def _resting(
    cloud: Array, upright: Array, around: Array, frame: Pose, half: Array, middles: Array, cost: float
) -> list[PlacingSpot]:
    """Spots in the area, by height: where ``cloud``, about the object's origin, comes to lie on ``around``."""
    under, corner = underside(cloud)
    relief = relief_of(around, frame.position, AROUND)
    x, y = (np.arange(-n, n + 1) * CELL for n in (KEPT * half[:2] / CELL).astype(int).clip(0, MOST))
    z = (0.0,) if abs(frame.rotation[2, 2]) > FLAT else SLOPE
    found = []
    for offset in itertools.product(x, y, z):
        over = (frame.position + frame.rotation @ np.array(offset))[:2]
        height = relief.drop(under, over + corner)
        if np.isfinite(height):
            aside = float(np.linalg.norm(middles - offset[:2], axis=1).min())
            price = cost + height + OFF_CENTRE * aside
            found.append(PlacingSpot(Pose(np.array([*over, height]), upright), price))
    return sorted(found, key=cost_of)


def _middles(cloud: Array, frame: Pose, half: Array, sharing: int) -> Array:
    """Positions (k, 2) of ``sharing`` objects side by side in the area, along its side with the most room."""
    if sharing <= 1:
        return np.zeros((1, 2))
    size = np.ptp(cloud @ frame.rotation, axis=0)[:2]
    axis = int(np.argmin(size / half[:2]))
    pitch = min(size[axis] + GAP, 2 * KEPT * half[axis] / (sharing - 1))
    middles = np.zeros((sharing, 2))
    middles[:, axis] = pitch * (np.arange(sharing) - 0.5 * (sharing - 1))
    return middles


def _entered(spot: PlacingSpot, cloud: Array, around: Array) -> Iterator[PlacingSpot]:
    """The spot with every side from which the object can be brought in, as a box that sweeps through ``around``."""
    low, high = cloud.min(axis=0) + spot.pose.position, cloud.max(axis=0) + spot.pose.position
    for side in SIDES:
        start = OUTSIDE * np.minimum(side, 0.0)
        stop = OUTSIDE * np.maximum(side, 0.0)
        swept = (around > low + start + SUNK) & (around < high + stop - SUNK + LIFTED * UP)
        hits = around[swept.all(axis=1)]
        if abs(side[0] * side[1]) > SUNK:  # the swept box of a diagonal is too large: look along the way
            hits = hits[_along(hits, low, high, side)]
        hits = hits[hits[:, 2] > low[2] + LIFTED] if len(hits) else hits
        if not len(hits):
            yield PlacingSpot(spot.pose, spot.cost, side)


def _along(points: Array, low: Array, high: Array, side: Array) -> NDArray[np.bool_]:
    """Which ``points`` (n, 3) the box meets on its way along ``side``."""
    met = np.zeros(len(points), dtype=np.bool_)
    for part in np.linspace(0.0, OUTSIDE, 12):
        met |= ((points > low + part * side) & (points < high + part * side)).all(axis=1)
    return met


def _stood(axis: Array) -> Array:
    """The least rotation that brings the vertical to ``axis``; none where it points down."""
    turn = np.cross(UP, axis)
    sine = float(np.linalg.norm(turn))
    if sine < LEVEL or axis[2] < 0.0:
        return np.eye(3)
    return axis_angle(turn / sine, float(np.arctan2(sine, axis[2])))


def _area(world: SkillWorld, target: PlacementTarget) -> tuple[Pose, Array]:
    """Frame and half extents of where the object's origin has to be.

    The z of the frame is vertical where one axis of the site is: a drawer's site has it along another.
    """
    if target.site is None:
        return Pose(world.pose(str(target.parent)).position, np.eye(3)), np.full(3, NEAR)
    frame, half = world.site_pose(target.site), world.site_half(target.site)
    axis = int(np.argmax(np.abs(frame.rotation[2])))
    if abs(frame.rotation[2, axis]) < FLAT:
        return frame, half
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    rotation = frame.rotation[:, order]
    if rotation[2, 2] < 0.0:
        rotation = rotation * np.array([1.0, -1.0, -1.0])
    return Pose(frame.position, rotation), half[order]


def place(world: SkillWorld, holding: Holding, spot: PlacingSpot, release: float) -> Generator[Action, None, None]:
    """Bring the held object to ``spot``, release it ``release`` metres above, withdraw.

    Raises :class:`SkillFault` if it is lost on the way.
    """
    drop = spot.pose.moved(np.array([0.0, 0.0, release]))
    goal = drop @ holding.local.inverse()
    yield from transit(world, goal.moved(spot.before), CLOSED, carried=holding.entity)
    # The object may have slipped or turned in the fingers.
    slipped = world.eef.inverse() @ world.pose(holding.entity)
    if np.linalg.norm(slipped.position - holding.local.position) > SLIPPED or world.aperture < EMPTY:
        raise SkillFault("lost", f"`{holding.entity}` fell out of the gripper")
    shift = drop.position[:2] - (goal @ slipped).position[:2]
    goal = goal.moved(np.array([*shift, 0.0]))
    yield from reach(world, goal, CLOSED, near=0.005, speed=0.6, steps=40)
    yield from grip(world, OPEN, OPENING)
    if spot.entry[2] > FLAT:
        yield from reach(world, world.eef.backed(RETREAT), OPEN, near=0.02, steps=20)
    else:
        yield from reach(world, world.eef.moved(spot.before), OPEN, near=0.02, steps=25)
