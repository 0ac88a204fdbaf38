"""Plans that pair a grasp with a spot: both must be reachable, and the object and hand must fit."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.scene.geometry import align_yaw
from runtime.worlds.libero.scene.targets import PlacementTarget
from runtime.worlds.libero.skills.aside import Way, free_spots
from runtime.worlds.libero.skills.frames import Pose, axis_angle, nearest_twin, wrapped
from runtime.worlds.libero.skills.grasping import Grasp, Search
from runtime.worlds.libero.skills.motion import Action
from runtime.worlds.libero.skills.pick import APPROACH, alike, grasps_of, pick
from runtime.worlds.libero.skills.place import UP, PlacingSpot, cost_of, place, spots
from runtime.worlds.libero.skills.press import inward, leans, press
from runtime.worlds.libero.skills.reach import Reach, Reached
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Transfer", "leaving", "reachable", "transfer", "transfers"]

Array = NDArray[np.float64]
T = TypeVar("T")

TRIED = 80  # grasps that are checked for reach, spread over the object
PAIRED = 25  # of those in reach, that are paired with spots
ENTERED = 40  # spots behind an opening, that are checked for each grasp
SPOTS = 6  # the best, that are checked for each grasp
RELEASES = (0.008, 0.02, 0.035, 0.05, 0.07, 0.09)  # metres above the spot, the lowest that leaves the hand room
QUARTERS = (0.0, np.pi / 2, -np.pi / 2, np.pi)
YAWS = (0.0, np.pi / 4, -np.pi / 4, np.pi / 2, -np.pi / 2)
LEANING = 0.6  # at least, of the approach along the way in: the hand stays outside
LYING = Search(yaws=16, tilts=(0.8, 1.0, 1.2))
TILTED = Search(yaws=16, tilts=(0.35, 0.7, 1.0))


class Again(Generic[T]):
    """An iterable that caches the items of an iterator, so that it can be iterated again."""

    def __init__(self, source: Iterator[T]) -> None:
        self._source = source
        self._cached: list[T] = []

    def __iter__(self) -> Iterator[T]:
        yield from self._cached
        for item in self._source:
            self._cached.append(item)
            yield item


@dataclass(frozen=True, slots=True, eq=False)
class Transfer:
    """Grasp the subject of ``place`` by ``grasp`` and release it ``release`` metres above ``spot``."""

    place: PlacementTarget
    grasp: Grasp
    spot: PlacingSpot
    release: float


def transfers(
    world: SkillWorld,
    reach: Reach,
    place_: PlacementTarget,
    holds: Callable[[Pose], bool],
    tried: Sequence[Pose] = (),
    sharing: int = 1,
) -> Iterator[Transfer]:
    """Transfers of ``place_.subject`` to its place, the best first; none near a ``tried`` grasp.

    Upright grasps come before tilted ones, and the object's present rotation before others about the vertical.
    ``holds`` says whether the required fact is true with the object at a pose; ``sharing`` objects go to the place.
    """
    targets = [
        found
        for turns in _turns(world, place_)
        if (found := _sampled(chain.from_iterable(spots(world, place_, turn, holds, sharing) for turn in turns)))
    ]
    enclosed = all(spot.entry[2] < 0.5 for found in targets for spot in found)
    yield from _paired(world, reach, place_, targets, tried, (LYING,) if enclosed else (None, TILTED))


def leaving(
    world: SkillWorld,
    reach: Reach,
    place_: PlacementTarget,
    holds: Callable[[Pose], bool],
    tried: Sequence[Pose] = (),
    ways: Sequence[Way] = (),
) -> Iterator[Transfer]:
    """Transfers of ``place_.subject`` from its place to a free spot, the nearest first.

    As :func:`transfers`; ``ways`` are to be kept free.
    """
    found = _sampled(free_spots(world, place_.subject, holds, ways))
    aside = PlacementTarget(place_.subject, None, None, contains=False)
    if found:
        yield from _paired(world, reach, aside, [found], tried, (None, TILTED))


def _paired(
    world: SkillWorld,
    reach: Reach,
    place_: PlacementTarget,
    targets: Sequence[Sequence[PlacingSpot]],
    tried: Sequence[Pose],
    searches: Sequence[Search | None],
) -> Iterator[Transfer]:
    """Each grasp with the first spot of each of ``targets`` that it can be let go at."""
    entity = place_.subject
    body = world.pose(entity)
    for search in searches:
        grasps = Again(reachable(world, reach, grasps_of(world, entity, search), tried))
        for found in targets:
            for grasp, at in islice(grasps, PAIRED):
                local = grasp.pose.inverse() @ body
                best = next(_released(reach, at, entity, local, found, grasp.width), None)
                if best is not None:
                    yield Transfer(place_, grasp, *best)


def _sampled(found: Iterable[PlacingSpot]) -> list[PlacingSpot]:
    """The best spots and some of the others, from above; where there are none, some of every side and depth."""
    ordered = sorted(found, key=cost_of)
    above = [spot for spot in ordered if spot.entry[2] > 0.5]
    if above:
        return above[:SPOTS] + above[SPOTS :: max(1, len(above) // SPOTS)]
    return ordered[:: max(1, len(ordered) // ENTERED)]


def _turns(world: SkillWorld, place_: PlacementTarget) -> Iterator[tuple[Array, ...]]:
    """Turns of the upright object to be tried together: what goes into something is first aligned with its sides.

    Last, what is too tall to stand in something is laid down.
    """
    inside = place_.site is not None and place_.contains
    aligned = 0.0
    if inside:
        aligned = align_yaw(world.pose(place_.subject).rotation, world.site_pose(str(place_.site)).rotation)
        yield tuple(axis_angle(UP, wrapped(aligned + quarter)) for quarter in QUARTERS)
    yield from ((axis_angle(UP, yaw),) for yaw in YAWS)
    if inside:
        standing = axis_angle(UP, aligned)
        sides = (np.array([np.cos(quarter), np.sin(quarter), 0.0]) for quarter in QUARTERS)
        yield tuple(axis_angle(side, np.pi / 2) @ standing for side in sides)


def transfer(world: SkillWorld, plan: Transfer) -> Generator[Action, None, None]:
    """Carry out ``plan``; raises :class:`~runtime.worlds.libero.skills.fault.SkillFault` where it fails."""
    entity, upright = plan.place.subject, plan.spot.pose.rotation
    holding = yield from pick(world, entity, plan.grasp)
    yield from place(world, holding, plan.spot, plan.release)
    way = inward(world, plan.place)
    if way is not None and leans(world, entity, upright):
        yield from press(world, entity, way, upright)


def reachable(
    world: SkillWorld, reach: Reach, grasps: Sequence[Grasp], tried: Sequence[Pose]
) -> Iterator[tuple[Grasp, Reached]]:
    """Those of ``grasps`` that the arm reaches without running into anything, none near another."""
    start = reach.begin()
    seen = list(tried)
    for grasp in islice(grasps, 4000):
        if any(alike(grasp.pose, pose) for pose in seen):
            continue
        seen.append(grasp.pose)
        near = Pose(grasp.pose.position, nearest_twin(grasp.pose.rotation, world.eef.rotation))
        for twin in (near, Pose(near.position, near.rotation * np.array([-1.0, -1.0, 1.0]))):
            reach.begin()
            at = reach.solve(twin, start)
            if at.feasible and reach.solve(twin.backed(APPROACH), at.joints).feasible:
                yield Grasp(twin, grasp.width, grasp.cost), at
                break
        if len(seen) > TRIED:
            return


def _released(
    reach: Reach, at: Reached, entity: str, local: Pose, found: Sequence[PlacingSpot], width: float
) -> Iterator[tuple[PlacingSpot, float]]:
    """The spots that the object can be brought to with the hand on it, each with how far above it is let go."""
    reach.begin()

    def free(spot: PlacingSpot, offset: Array) -> bool:
        pose = spot.pose.moved(offset) @ local.inverse()
        return reach.solve(pose, at.joints, held=(entity, local), aperture=0.5 * width + 0.002).feasible

    for spot in found:
        if spot.entry[2] < 0.5:
            approach = (spot.pose.rotation @ local.inverse().rotation)[:, 2]
            if approach @ spot.entry > -LEANING:
                continue
            low = RELEASES[0] * UP
            if free(spot, low) and all(free(spot, low + part * spot.before) for part in (0.35, 0.7, 1.0)):
                yield spot, RELEASES[0]
        elif free(spot, RELEASES[-1] * UP):  # what cannot be let go from above cannot be lowered either
            yield spot, next((height for height in RELEASES[:-1] if free(spot, height * UP)), RELEASES[-1])
