"""Compiled evaluation of plans: three-valued, over the memory of one ``MjData`` and the tables of its plans.

A call from Python costs as much as its arguments do, so there is one: the address of a block that says where everything
else is (:data:`SLOTS`).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from grounding.jit import compiled

__all__ = [
    "ANY_JOINT",
    "BOX",
    "DISC",
    "EVERY_JOINT",
    "NO_PLAN",
    "NUMBERS",
    "OPEN",
    "REGION",
    "SLOTS",
    "TIE",
    "evaluate",
]

TIE = 1e-9  # metres or radians from a bound
OPEN = 2  # in the place of a truth that the plan does not decide
BOX, REGION, DISC, ANY_JOINT, EVERY_JOINT, NO_PLAN = range(6)
NUMBERS = 6  # of a fact; beside its integers: kind, two ids or a range of joints, and the bit of its contact or -1
SLOTS = (
    *("ncon", "contact", "geom", "stride", "contacts", "sides", "ngeom"),
    *("qpos", "nq", "xpos", "nbody", "site_xpos", "site_xmat", "nsite"),
    *("integers", "numbers", "facts", "joints", "njoint", "truth"),
)

carray: Any = numba.carray  # type: ignore[attr-defined]  # it is there, and documented

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]


class State(NamedTuple):
    """Views of MuJoCo's memory."""

    qpos: Floats
    xpos: Floats  # (nbody, 3)
    site_xpos: Floats  # (nsite, 3)
    site_xmat: Floats  # (nsite, 9)
    joints: NDArray[np.int64]  # addresses in qpos, of all plans


def _pointer_of(typing: Any, address: Any) -> Any:  # noqa: ANN401, ARG001  numba's own types
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ANN401, ARG001  as above
        return builder.inttoptr(arguments[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


_pointer: Any = intrinsic(_pointer_of)


@compiled
def _met(slots: NDArray[np.int64]) -> np.uint64:
    """The contacts of the plans that exist, one bit each."""
    ncon, start, geom, stride, _, sides_at, ngeom = slots[:7]
    sides = carray(_pointer(sides_at), (2, ngeom), np.uint64)
    count = carray(_pointer(ncon), (1,), np.int32)[0]
    first = carray(_pointer(start), (1,), np.int64)[0] + geom
    met = np.uint64(0)
    for i in range(count):
        pair = carray(_pointer(first + i * stride), (2,), np.int32)
        a, b = pair[0], pair[1]
        if a >= 0 and b >= 0:  # a flexible body has no geom
            met |= (sides[0, a] & sides[1, b]) | (sides[0, b] & sides[1, a])
    return met


@compiled
def _state(slots: NDArray[np.int64]) -> State:
    qpos, nq, xpos, nbody, site_xpos, site_xmat, nsite = slots[7:14]
    return State(
        carray(_pointer(qpos), (nq,), np.float64),
        carray(_pointer(xpos), (nbody, 3), np.float64),
        carray(_pointer(site_xpos), (nsite, 3), np.float64),
        carray(_pointer(site_xmat), (nsite, 9), np.float64),
        carray(_pointer(slots[17]), (slots[18],), np.int64),
    )


@compiled
def _finite(values: Floats) -> bool:
    nothing = 0.0
    for value in values:
        nothing += 0.0 * value
    return nothing == 0.0


@compiled
def _less(a: float, b: float) -> float:
    """The smaller number, and NaN if there is one."""
    return b if not a <= b else a


@compiled
def _within(offset: Vector, low: Vector, high: Vector) -> float:
    least = np.inf
    for axis in range(3):
        least = _less(_less(offset[axis] - low[axis], high[axis] - offset[axis]), least)
    return least


@compiled
def _turned(frame: Floats, x: float, y: float, z: float) -> Vector:
    return (
        frame[0] * x + frame[1] * y + frame[2] * z,
        frame[3] * x + frame[4] * y + frame[5] * z,
        frame[6] * x + frame[7] * y + frame[8] * z,
    )


@compiled
def _between(a: Floats, b: Floats) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@compiled
def _of_joints(state: State, kind: int, start: int, stop: int, given: Floats) -> float:
    every = kind == EVERY_JOINT
    margin = np.inf if every else -np.inf
    for joint in state.joints[start:stop]:
        one = given[0] * (state.qpos[joint] - given[1])
        margin = min(margin, one) if every else max(margin, one)
    return margin


@compiled
def _margin(state: State, kind: int, first: int, second: int, given: Floats) -> float:
    """The margin that decides, contact aside; NaN without a plan."""
    if kind == BOX:
        x, y, z = _between(state.xpos[first], state.site_xpos[second])
        offset = _turned(state.site_xmat[second], x, y, z)
        return _within(offset, (given[0], given[1], given[2]), (given[3], given[4], given[5]))
    if kind == REGION:
        x, y, z = _turned(state.site_xmat[second], given[0], given[1], given[2])
        low, high = (-abs(x), -abs(y), -abs(z) - given[3]), (abs(x), abs(y), abs(z))
        return _within(_between(state.xpos[first], state.site_xpos[second]), low, high)
    if kind == DISC:
        x, y, z = _between(state.xpos[first], state.xpos[second])
        return _less(given[0] - math.hypot(x, y), z)
    if kind in (ANY_JOINT, EVERY_JOINT):
        return _of_joints(state, kind, first, second, given)
    return np.nan


@compiled
def evaluate(block: int) -> int:
    """Write the truth of every fact (0, 1, :data:`OPEN`) and return how many are open; -1: ``qpos`` is not finite."""
    slots = carray(_pointer(block), (20,), np.int64)
    state = _state(slots)
    if not _finite(state.qpos):
        return -1
    facts = slots[16]
    integers = carray(_pointer(slots[14]), (facts, 4), np.int64)
    numbers = carray(_pointer(slots[15]), (facts, NUMBERS), np.float64)
    truth = carray(_pointer(slots[19]), (facts,), np.uint8)
    met = _met(slots) if slots[4] else np.uint64(0)
    left = 0
    for fact in range(facts):
        kind, first, second, contact = integers[fact]
        if contact >= 0 and not (met >> np.uint64(contact)) & np.uint64(1):
            truth[fact] = 0
            continue
        margin = _margin(state, kind, first, second, numbers[fact])
        truth[fact] = 1 if margin > TIE else (0 if margin < -TIE else OPEN)
        left += truth[fact] == OPEN
    return left
