"""Poses to try for a place: offsets in the frame of the region or landmark, and turns about the vertical."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.joints import SINK_M, end_values, moved
from runtime.worlds.libero.proposers.placement import ENCLOSED, Mover, Placement, Window, drop, rest_orientations, yaws
from runtime.worlds.libero.scene.geometry import align_yaw, extent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from grounding.scenes import Scene
    from runtime.loop.proposer import Request
    from runtime.worlds.libero.proposers.candidates import StateCandidate
    from runtime.worlds.libero.scene.targets import PlacementTarget

    Array = NDArray[np.float64]

__all__ = ["landing_batches", "leaving_batches", "search_window", "site_window"]

_EIGHTHS = tuple(np.radians((0.0, 90.0, 180.0, 270.0, 45.0, 135.0, 225.0, 315.0)))
_COARSE, _FINE = (0.0, -0.4, 0.4, -0.8, 0.8), (-0.2, 0.0, 0.2)  # of a region's half size
_SECONDARY = 9  # offsets at which orientations other than the first are tried
_SLOT = 0.6  # of a region's half size: how far from its centre the outermost of several objects are put
_RING_M = (0.008, 0.016, 0.024)  # offsets from a landmark's origin, inside the 3 cm of LIBERO's On(object, object)
_UNDER_LOW, _UNDER_HIGH, _IN_LOW = -0.005, 0.10, -0.01  # m; libero/envs/objects/site_object.py, under and in_box
_ROOF_M = 0.02
_AWAY_M = (0.08, 0.12, 0.16, 0.2, 0.25, 0.3)  # how far an object is moved that must leave a place


def landing_batches(request: Request, place: PlacementTarget, slot: tuple[int, int]) -> Iterator[list[StateCandidate]]:
    """Batches of landings of ``place.subject``: one batch for each offset, nearest to its slot first.

    When the region rides on a joint (a drawer), landings that nothing of its parent covers come first: as the joint is,
    then with the joint near an end of its range, each followed by itself with the joint put back and what rests on it
    carried along. Landings in a covered region come last.
    """
    scene, qpos = request.scene, request.qpos
    clearance = Clearance(scene, qpos)
    joints = [] if place.site is None else [int(j) for j in scene.joints(place.site) if scene.model.jnt_limited[int(j)]]
    if not joints:
        yield from _landings(clearance, place, slot)
        return
    yield from _landings(clearance, place, slot, covered=False)
    for joint in joints:
        low, high = (float(v) for v in scene.model.jnt_range[joint])
        present = float(qpos[scene.qpos_slice(joint)][0])
        label = scene.joint_at(int(scene.model.jnt_qposadr[joint]))
        for value in end_values((low, high), present):
            slid, _, depth = moved(clearance, joint, value)
            if depth > SINK_M:
                continue
            for batch in _landings(Clearance(scene, slid), place, slot, covered=False):
                yield [replace(c, note=f"{c.note}; {label} moved to {value:.4f}") for c in batch]
                yield [
                    replace(c, qpos=back, note=f"{c.note}; {label} moved to {value:.4f} and back")
                    for c in batch
                    if (back := _put_back(scene, c.qpos, joint, present, place.subject)) is not None
                ]
    yield from _landings(clearance, place, slot, covered=True)


def leaving_batches(request: Request, place: PlacementTarget) -> Iterator[list[StateCandidate]]:
    """Batches of landings of ``place.subject`` away from where it is, nearest first: for a fact that must not hold."""
    clearance = Clearance(request.scene, request.qpos)
    mover = Mover(clearance, place.subject)
    upright = rest_orientations(request.scene, request.qpos, place.subject)[0]
    window = search_window(clearance, place, wanted=False)
    for away in _AWAY_M:
        poses = (
            Placement(
                float(mover.home[0] + away * np.cos(angle)),
                float(mover.home[1] + away * np.sin(angle)),
                upright,
                f"{away:.2f} m away from {place.site or place.parent}, towards {np.degrees(angle):.0f} deg",
            )
            for angle in _EIGHTHS
        )
        yield [landing for pose in poses for landing in drop(mover, pose, window)]


def search_window(clearance: Clearance, place: PlacementTarget, *, wanted: bool) -> Window:
    """Heights as :func:`site_window` has them, or any down to the foot of a place that is not ``wanted``."""
    window = site_window(clearance, place)
    if wanted:
        return window
    foot = window.low
    if place.parent is not None:
        low, _ = extent(clearance.model, clearance.data, clearance.scene.contact_geoms(place.parent))
        foot = min(foot, float(low[2]))
    return Window(foot, window.roof + 1.0, window.roof)


def _put_back(scene: Scene, qpos: Array, joint: int, value: float, subject: str) -> Array | None:
    slid, carried, depth = moved(Clearance(scene, qpos), joint, value)
    return slid if subject in carried and depth <= SINK_M else None


def _landings(
    clearance: Clearance, place: PlacementTarget, slot: tuple[int, int], *, covered: bool | None = None
) -> Iterator[list[StateCandidate]]:
    """Landings at each offset; with ``covered``, only at those that the place's parent does or does not cover."""
    window = site_window(clearance, place)
    frame = _frame(clearance, place)
    lids = _lids(clearance, place)
    flaws = ENCLOSED if covered else 0
    offsets = list(_offsets(clearance, place, slot))
    mover = Mover(clearance, place.subject)
    for number, orientation in enumerate(rest_orientations(clearance.scene, clearance.start, place.subject)):
        aligned = align_yaw(orientation, frame) if place.contains else 0.0
        turns = [aligned + eighth for eighth in _EIGHTHS]
        for x, y, offset in offsets[: _SECONDARY if number else None]:
            if covered is not None and covered != any(lid.covers(x, y) for lid in lids):
                continue
            yield [
                landing
                for matrix, angle in yaws(orientation, turns)
                for landing in drop(
                    mover,
                    Placement(x, y, matrix, f"{offset}, turned {np.degrees(angle):.0f} deg"),
                    window,
                    flaws,
                )
            ]


@dataclass(frozen=True, slots=True)
class _Lid:
    """The horizontal rectangle (m) of a geom that lies above a region."""

    low: tuple[float, float]
    high: tuple[float, float]

    def covers(self, x: float, y: float) -> bool:
        return self.low[0] <= x <= self.high[0] and self.low[1] <= y <= self.high[1]


def _lids(clearance: Clearance, place: PlacementTarget) -> list[_Lid]:
    if place.site is None or place.parent is None:
        return []
    scene, model, data = clearance.scene, clearance.model, clearance.data
    clearance.place(clearance.start)
    height = data.site_xpos[scene.site(place.site)][2]
    boxes = [extent(model, data, np.array([g])) for g in scene.contact_geoms(place.parent)]
    return [_Lid((low[0], low[1]), (high[0], high[1])) for low, high in boxes if low[2] > height]


def site_window(clearance: Clearance, place: PlacementTarget) -> Window:
    """Heights that the native predicate allows the origin, and the height from which to descend."""
    scene, data, model = clearance.scene, clearance.data, clearance.model
    clearance.place(clearance.start)
    roof = -np.inf
    if place.parent is not None:
        low, high = extent(model, data, scene.contact_geoms(place.parent))
        roof = float(high[2])
    if place.site is None:
        reach = float(high[2] - low[2])
        return Window(float(low[2]), float(high[2]) + max(reach, 0.1), roof + _ROOF_M)
    site = scene.site(place.site)
    centre, size = data.site_xpos[site], model.site_size[site]
    matrix = data.site_xmat[site].reshape(3, 3)
    if place.contains:
        half = float(np.abs(matrix @ size)[2])
        bottom, top = centre[2] - half + _IN_LOW, centre[2] + half
    else:
        edges = (-size[0], size[0]), (-size[1], size[1]), (size[2] + _UNDER_LOW, size[2] + _UNDER_HIGH)
        # upstream tests matrix @ (origin - centre), so that the way back to the world is by the transpose
        heights = centre[2] + (np.array(list(itertools.product(*edges))) @ matrix)[:, 2]
        bottom, top = heights.min(), heights.max()
    return Window(float(bottom), float(top), max(roof, float(top)) + _ROOF_M)


def _frame(clearance: Clearance, place: PlacementTarget) -> Array:
    scene, data = clearance.scene, clearance.data
    if place.site is not None:
        return np.asarray(data.site_xmat[scene.site(place.site)].reshape(3, 3))
    body = scene.root_body(place.parent or place.subject)
    return np.asarray(data.xmat[body].reshape(3, 3))


def _offsets(clearance: Clearance, place: PlacementTarget, slot: tuple[int, int]) -> Iterator[tuple[float, float, str]]:
    """Horizontal positions for the origin, with the offset's words for the note."""
    scene, data, model = clearance.scene, clearance.data, clearance.model
    clearance.place(clearance.start)
    if place.site is None:
        origin = data.xpos[scene.root_body(place.parent or place.subject)].copy()
        frame = _frame(clearance, place)
        local = [np.zeros(3)] + [radius * np.array([np.cos(a), np.sin(a), 0.0]) for radius in _RING_M for a in _EIGHTHS]
        heading = np.arctan2(frame[1, 0], frame[0, 0])
        for step in local:
            c, s = np.cos(heading), np.sin(heading)
            x, y = origin[0] + c * step[0] - s * step[1], origin[1] + s * step[0] + c * step[1]
            yield float(x), float(y), f"offset ({step[0]:.3f}, {step[1]:.3f}) m from {place.parent}"
        return
    site = scene.site(place.site)
    centre = data.site_xpos[site].copy()
    half = np.abs(data.site_xmat[site].reshape(3, 3) @ model.site_size[site])[:2]
    axis = int(np.argmax(half))
    number, count = slot
    wanted = np.zeros(2)
    if count > 1:
        wanted[axis] = _SLOT * (2.0 * number / (count - 1) - 1.0)
    grid = {tuple(wanted), *itertools.product(_COARSE, repeat=2), *itertools.product(_FINE, repeat=2)}
    for fraction in sorted(grid, key=lambda f: (round(float(np.linalg.norm(f - wanted)), 6), f)):
        x, y = centre[:2] + np.array(fraction) * half
        yield float(x), float(y), f"offset ({fraction[0]:.2f}, {fraction[1]:.2f}) of {place.site}"
