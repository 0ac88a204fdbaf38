"""The route ``rack_contact_site``: an object brought into contact with a rack, in the rack's local frame.

Source (paper, table "Typed gates and state-correction families"): rack-contact failures are corrected in
a rack-local frame. A rack's shelf is rarely level, so the axes of the object are turned onto those of the site, or of a
slat near it, and it is then lowered. What the contacts cannot hold against gravity is tried last.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from runtime.worlds.libero.proposers.candidates import StateCandidate, offer, ranked
from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.placement import Mover, Placement, drop
from runtime.worlds.libero.proposers.poses import leaving_batches, site_window
from runtime.worlds.libero.scene.geometry import cube_rotations
from runtime.worlds.libero.scene.targets import PlacementTarget, place_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Request
    from runtime.loop.records import Proposal

    Array = NDArray[np.float64]

__all__ = ["HeuristicRackContact"]

_ACROSS = (0.0, -0.4, 0.4)  # of the site's half size along its first axis
_OVER_M = (0.0, 0.01, 0.03, 0.06, 0.09)  # along the site's third axis, in which LIBERO's `under` reaches 10 cm
_NEAR_M = 0.03  # a geom whose box comes this near to the site's centre is part of the shelf
_SAME_RAD = 0.02  # frames nearer than this count as one


class HeuristicRackContact:
    """Lays an object on a rack."""

    name = "heuristic_rack_contact"

    def __init__(self, schema: Schema) -> None:
        """``schema`` is not needed: the scene determines where to place."""
        self.schema = schema

    def propose(self, request: Request) -> Proposal | None:
        """Return candidate number ``request.candidate``, or None when no rack site is named or no more are left."""
        return offer(request, "rack_contact_site", self.name, self.candidates(request))

    def candidates(self, request: Request) -> Iterator[StateCandidate]:
        """All candidates, best first."""
        place = place_of(request.scene, request.diagnosis.fact)
        if place is None or place.site is None or place.parent is None:
            return
        if not request.diagnosis.fact.polarity:
            yield from ranked(request, leaving_batches(request, place))
        else:
            yield from ranked(
                request, _batches(Clearance(request.scene, request.qpos), place, place.parent, place.site)
            )


def _batches(clearance: Clearance, place: PlacementTarget, rack: str, site: str) -> Iterator[list[StateCandidate]]:
    window = site_window(clearance, place)
    frames = _frames(clearance, rack, site)
    mover = Mover(clearance, place.subject)
    for x, y, offset in _points(clearance, site):
        yield [
            landing
            for (kind, frame), (number, cube) in itertools.product(frames, enumerate(cube_rotations()))
            for landing in drop(
                mover,
                Placement(x, y, frame @ cube, f"{offset}, axes along {kind}, face {number}"),
                window,
            )
        ]


def _points(clearance: Clearance, site: str) -> list[tuple[float, float, str]]:
    index = clearance.scene.site(site)
    centre = clearance.data.site_xpos[index].copy()
    matrix = clearance.data.site_xmat[index].reshape(3, 3).copy()
    half = clearance.model.site_size[index]
    found = []
    for over, across in itertools.product(_OVER_M, _ACROSS):
        # upstream's `under` tests matrix @ (origin - centre), so its inverse leads from the rack's frame to the world
        world = centre + matrix.T @ np.array([across * half[0], 0.0, half[2] + over])
        found.append((float(world[0]), float(world[1]), f"{over:.3f} m over {site}, {across:.1f} across"))
    return found


def _frames(clearance: Clearance, rack: str, site: str) -> list[tuple[str, Array]]:
    """The site's frame and those of the rack's geoms near it, as (name, matrix), alike ones once."""
    model, data, scene = clearance.model, clearance.data, clearance.scene
    index = scene.site(site)
    centre = data.site_xpos[index]
    found = []
    for geom in scene.contact_geoms(rack).tolist():
        matrix = data.geom_xmat[geom].reshape(3, 3).copy()
        local = matrix.T @ (centre - data.geom_xpos[geom]) - model.geom_aabb[geom, :3]
        if np.all(np.abs(local) <= model.geom_aabb[geom, 3:] + _NEAR_M):
            found.append((f"geom {model.geom(geom).name}", matrix))
    found.append((site, data.site_xmat[index].reshape(3, 3).copy()))
    distinct: list[tuple[str, Array]] = []
    for name, matrix in found:
        if not any(_alike(matrix, other) for _, other in distinct):
            distinct.append((name, matrix))
    return distinct


def _alike(one: Array, two: Array) -> bool:
    """Whether two frames differ by a turn of the cube and less than ``_SAME_RAD``."""
    traces = np.einsum("ij,nij->n", one.T @ two, cube_rotations())
    return bool(np.max(traces) >= 1.0 + 2.0 * np.cos(_SAME_RAD))
