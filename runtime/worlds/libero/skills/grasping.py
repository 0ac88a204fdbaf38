"""Where two fingers can close on an object: a search over yaw, tilt, offsets and depth on surface points.

The gripper is three boxes in the frame of the grip site (x closes, y lateral, z approaches): two fingers and the hand.
A grasp is free when no surface point lies in a box, and holds when points of the object lie between the pads.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grounding.jit import compiled
from runtime.worlds.libero.skills.frames import Pose, frame

__all__ = ["TIP", "Grasp", "find_grasps"]

Array = NDArray[np.float64]

TIP = 0.0093  # metres from the grip site to the finger tips, along the approach
_INNER, _OUTER = 0.0380, 0.0625  # of an open finger, along the closing axis
_FINGER_Y, _PAD_Y = 0.0145, 0.0080  # half widths
_FINGER_Z = 0.060  # a finger's length above its tip
_PAD_Z = (0.005, 0.021)  # the pad, above the tip
_HAND_X, _HAND_Y = 0.106, 0.0335  # half widths
_HAND_Z = (0.037, 0.131)  # the hand, above the tip
_STEP_X, _STEP_Y = 0.004, 0.008
_FEWEST = 3  # points between the pads
_TIGHT = 0.074  # metres, the widest that is gripped


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """A pose of the grip site in the world, the ``width`` between the fingers, and a ``cost`` (lower is better)."""

    pose: Pose
    width: float
    cost: float


@compiled
def _hits(points: Array, x0: float, y0: float, tip: float) -> bool:
    """Whether any point lies in a finger or in the hand."""
    for i in range(points.shape[0]):
        up = tip - points[i, 2]
        if up < -0.0015 or up > _HAND_Z[1]:
            continue
        x, y = abs(points[i, 0] - x0), abs(points[i, 1] - y0)
        if up < _FINGER_Z and y < _FINGER_Y and _INNER < x < _OUTER:
            return True
        if up > _HAND_Z[0] and y < _HAND_Y and x < _HAND_X:
            return True
    return False


@compiled
def _between(points: Array, x0: float, y0: float, tip: float) -> bool:
    """Whether any point lies where the fingers will close."""
    for i in range(points.shape[0]):
        up = tip - points[i, 2]
        if -0.0015 < up < _FINGER_Z and abs(points[i, 1] - y0) < _FINGER_Y and abs(points[i, 0] - x0) <= _INNER:
            return True
    return False


@compiled
def _pad(points: Array, x0: float, y0: float, tip: float) -> tuple[int, float, float]:
    """How many points lie between the pads, and the least and largest of their x."""
    count, low, high = 0, np.inf, -np.inf
    for i in range(points.shape[0]):
        up = tip - points[i, 2]
        if _PAD_Z[0] <= up <= _PAD_Z[1] and abs(points[i, 1] - y0) <= _PAD_Y:
            x = points[i, 0]
            if abs(x - x0) < _INNER:
                count += 1
                low, high = min(low, x), max(high, x)
    return count, low, high


@compiled
def _top(target: Array, x0: float, y0: float) -> float:
    """The first surface that closing pads would meet; infinite if there is none."""
    top = np.inf
    for i in range(target.shape[0]):
        if abs(target[i, 1] - y0) <= _PAD_Y and abs(target[i, 0] - x0) < _STEP_Y + _STEP_X:
            top = min(top, target[i, 2])
    return top


@compiled
def _fits(target: Array, around: Array, x0: float, y0: float, tip: float, row: Array) -> bool:
    """Whether the gripper can close there; ``row`` is then (x, y, tip, width, count), x amid what is held."""
    count, low, high = _pad(target, x0, y0, tip)
    centre = 0.5 * (low + high)
    if count < _FEWEST or high - low > _TIGHT or abs(centre - x0) > _STEP_X:
        return False
    row[0], row[1], row[2], row[3], row[4] = centre, y0, tip, high - low, count
    free = not (_hits(target, centre, y0, tip) or _hits(around, centre, y0, tip))
    return free and not _between(around, centre, y0, tip)


@compiled
def _search(target: Array, around: Array, depths: Array, floor: float, out: Array) -> int:
    """Write feasible (x, y, tip, width, count, depth) rows into ``out``; points are in the gripper's axes."""
    found = 0
    low_y, high_y = target[:, 1].min(), target[:, 1].max()
    low_x, high_x = target[:, 0].min(), target[:, 0].max()
    ny = int((high_y - low_y) / _STEP_Y) + 1
    nx = int((high_x - low_x) / _STEP_X) + 1
    for iy in range(ny):
        y0 = 0.5 * (low_y + high_y) + (iy - 0.5 * (ny - 1)) * _STEP_Y
        for ix in range(nx):
            x0 = 0.5 * (low_x + high_x) + (ix - 0.5 * (nx - 1)) * _STEP_X
            top = _top(target, x0, y0)
            if top == np.inf:
                continue
            for depth in depths:
                tip = min(top + depth, floor)
                if found < out.shape[0] and _fits(target, around, x0, y0, tip, out[found]):
                    out[found, 5] = tip - top
                    found += 1
    return found


@dataclass(frozen=True, slots=True)
class Search:
    """Directions that are tried: ``yaws`` of the closing axis (rad) and ``tilts`` of the approach from the vertical."""

    yaws: int = 16
    tilts: Sequence[float] = (0.0,)
    depths: Sequence[float] = (0.009, 0.012, 0.016, 0.024, 0.032, 0.042)


def find_grasps(
    target: Array, around: Array, centre: Array, floor: float, current: Pose, search: Search | None = None
) -> list[Grasp]:
    """Grasps of the surface points ``target`` (n, 3) that stay clear of ``around`` (m, 3), the best first.

    ``centre`` (3,) is the object's centre of mass, ``floor`` the height (m) that the tips must stay above.
    """
    search = search or Search()
    grasps: list[Grasp] = []
    out = np.empty((4000, 6))
    for yaw in np.arange(search.yaws) * math.pi / search.yaws:
        closing = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        lateral = np.array([-closing[1], closing[0], 0.0])
        for tilt in search.tilts:
            for side in (1.0, -1.0) if tilt else (1.0,):
                approach = math.sin(tilt) * side * lateral - math.cos(tilt) * np.array([0.0, 0.0, 1.0])
                rotation = frame(approach, closing)
                local = np.ascontiguousarray((target - centre) @ rotation)
                others = np.ascontiguousarray((around - centre) @ rotation)
                limit = (centre[2] - floor) / math.cos(tilt)
                count = _search(local, others, np.array(search.depths), limit, out)
                grasps += [_grasp(row, rotation, centre, tilt, current) for row in out[:count]]
    return sorted(grasps, key=lambda grasp: grasp.cost)


def _grasp(row: Array, rotation: Array, centre: Array, tilt: float, current: Pose) -> Grasp:
    x0, y0, tip, width, count, depth = (float(v) for v in row)
    position = centre + rotation @ np.array([x0, y0, tip - TIP])
    arm = math.hypot(x0, y0)
    twist = 1.0 - abs(float(rotation[:, 0] @ current.rotation[:, 0]))
    few = max(0.0, 12.0 - count) / 12.0
    shallow = max(0.0, 0.029 - depth)
    cost = (
        6.0 * arm
        + 10.0 * abs(y0)
        + 0.15 * twist
        + 0.25 * few
        + 0.4 * tilt
        + 8.0 * shallow
        + 1.5 * max(0.0, width - 0.06)
    )
    return Grasp(Pose(position, rotation), width, cost)
