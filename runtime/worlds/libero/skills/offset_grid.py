"""Candidates from a finite grid of offsets beside a landmark, tried in order until the verifier accepts one.

For LIBERO-90 Task 76 the paper uses an OSC-Pose pick-and-place controller with a "finite offset grid", which supplies
another candidate after a rejection; it gives no offsets. This grid is ours. It ignores the region of the fact: it
starts far from the landmark, where the hand has room to release low, and comes nearer.
"""

from __future__ import annotations

import itertools
from collections.abc import Generator, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from onto_compiler.schema import Schema
from runtime.worlds.libero.scene.geometry import level
from runtime.worlds.libero.scene.targets import PlacementTarget, place_of
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.grasping import Grasp
from runtime.worlds.libero.skills.heights import relief_of, underside
from runtime.worlds.libero.skills.motion import Action
from runtime.worlds.libero.skills.pick import grasps_of, pick
from runtime.worlds.libero.skills.place import UP, PlacingSpot, place
from runtime.worlds.libero.skills.protocol import SkillRequest
from runtime.worlds.libero.skills.reach import Reach, Reached
from runtime.worlds.libero.skills.transfer import RELEASES, reachable
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["ASIDE", "AWAY", "Offset", "OffsetGrid", "offsets"]

Array = NDArray[np.float64]

AWAY = (0.4, 0.3, 0.2)  # metres from the landmark's origin, along the axis of the side that the fact names
ASIDE = (0.0, 0.1, -0.1)  # metres across that axis
GRASPS = 12  # that are checked for each offset
SAME = 0.01  # metres
AROUND = 0.35


@dataclass(frozen=True, slots=True, eq=False)
class Offset:
    """Take ``entity`` by ``grasp`` and let it go ``release`` metres above ``spot``, which counts as tried with it."""

    entity: str
    grasp: Grasp
    spot: PlacingSpot
    release: float
    note: str

    @property
    def poses(self) -> tuple[Pose, ...]:
        """The spot, so that the same grasp can be used with another spot."""
        return (self.spot.pose,)

    def run(self, world: SkillWorld, _: Reach) -> Generator[Action, None, None]:
        """The motion; raises :class:`~runtime.worlds.libero.skills.fault.SkillFault` where it gives up."""
        holding = yield from pick(world, self.entity, self.grasp)
        yield from place(world, holding, self.spot, self.release)


class OffsetGrid:
    """Puts an object down beside the landmark that a fact names; serves facts of two entities about a region."""

    name = "offset_grid"

    def __init__(self, schema: Schema) -> None:
        self._schema = schema

    def candidates(self, request: SkillRequest) -> Iterator[Offset]:
        """One plan for each offset at which the arm can let the object go, in the order of the grid."""
        world, fact = request.world, request.fact
        target = place_of(world.index, fact)
        landmark = fact.arguments[-1].name
        if target is None or target.site is None or not fact.polarity or landmark not in world.index.entities:
            return
        entity = target.subject
        grasps = list(itertools.islice(reachable(world, request.reach, grasps_of(world, entity), ()), GRASPS))
        for (away, aside), spot in _spots(world, target, landmark):
            if any(np.linalg.norm(spot.pose.position - pose.position) < SAME for pose in request.tried):
                continue
            found = _released(request, entity, spot, grasps)
            if found is not None:
                grasp, release = found
                at = f"{1000 * away:.0f} mm from {landmark}, {1000 * aside:.0f} mm aside"
                yield Offset(entity, grasp, spot, release, f"{at}, let go {1000 * release:.0f} mm above")


def offsets(side: Array) -> Iterator[tuple[tuple[float, float], Array]]:
    """The grid: for each (away, aside) the offset (3,) in the world, where ``side`` (2,) points to the landmark's side.

    The side is taken along the nearest axis of the workspace; aside is to the left of it.
    """
    axis = int(np.argmax(np.abs(side)))
    along = np.zeros(3)
    along[axis] = np.sign(side[axis])
    across = np.cross(UP, along)
    for aside, away in itertools.product(ASIDE, AWAY):
        yield (away, aside), away * along + aside * across


def _spots(
    world: SkillWorld, target: PlacementTarget, landmark: str
) -> Iterator[tuple[tuple[float, float], PlacingSpot]]:
    origin = world.pose(landmark).position
    body = world.pose(target.subject)
    upright = level(body.rotation)
    cloud = (world.cloud(target.subject) - body.position) @ body.rotation @ upright.T
    under, corner = underside(cloud)
    around = world.surroundings(target.subject)
    for names, offset in offsets((world.site_pose(str(target.site)).position - origin)[:2]):
        over = (origin + offset)[:2]
        height = relief_of(around, over, AROUND).drop(under, over + corner)
        if np.isfinite(height):
            yield names, PlacingSpot(Pose(np.array([*over, height]), upright), 0.0)


def _released(
    request: SkillRequest, entity: str, spot: PlacingSpot, grasps: list[tuple[Grasp, Reached]]
) -> tuple[Grasp, float] | None:
    """The first grasp with which the object can be let go at ``spot``, as low as the hand has room for."""
    body = request.world.pose(entity)
    request.reach.begin()
    for grasp, at in grasps:
        local = grasp.pose.inverse() @ body
        for release in RELEASES:
            hand = spot.pose.moved(release * UP) @ local.inverse()
            held = entity, local
            if request.reach.solve(hand, at.joints, held=held, aperture=0.5 * grasp.width + 0.002).feasible:
                return grasp, release
    return None
