"""Moves an articulated joint together with what rests on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runtime.worlds.libero.scene.geometry import matrix_of, quaternion_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from onto_compiler.schema import JointThreshold
    from runtime.worlds.libero.proposers.clearance import Clearance

    Array = NDArray[np.float64]

__all__ = ["SINK_M", "end_values", "moved", "side_values"]

SINK_M = 9e-4  # the deepest overlap that a proposal may cause
_DEPTHS = (0.5, 0.3, 0.7, 0.85, 0.15)  # how far into the satisfied side, as a fraction of it
_UNLIMITED = 0.5  # width (rad or m) taken for a side that the joint's range does not end
_INSET = 0.02  # of the range: a joint at its very limit is pushed back by the limit's constraint


def side_values(threshold: JointThreshold, limits: tuple[float, float] | None, polarity: bool) -> Iterator[float]:  # noqa: FBT001 - the record's own field
    """Positions on the side of ``threshold`` that satisfies it (its negation without ``polarity``), the middle first.

    ``limits`` is the joint's range, or None when it has none; nothing is yielded when the side lies beyond the range.
    """
    above = threshold.above == polarity
    if above:
        low, high = threshold.bound, limits[1] if limits else threshold.bound + _UNLIMITED
    else:
        low, high = limits[0] if limits else threshold.bound - _UNLIMITED, threshold.bound
    if limits:
        low, high = max(low, limits[0]), min(high, limits[1])
    if high <= low:
        return
    for depth in _DEPTHS:
        yield low + depth * (high - low) if above else high - depth * (high - low)


def end_values(limits: tuple[float, float], present: float) -> tuple[float, ...]:
    """Near either end of a range, the end farther from ``present`` first."""
    inset = _INSET * (limits[1] - limits[0])
    ends = (limits[0] + inset, limits[1] - inset)
    return ends if abs(ends[0] - present) >= abs(ends[1] - present) else ends[::-1]


def moved(clearance: Clearance, joint: int, value: float) -> tuple[Array, tuple[str, ...], float]:
    """The starting state with ``joint`` at ``value`` and what rests on its body carried along.

    Returns ``qpos`` (nq,), the names of the carried entities and the deepest overlap (m) with anything but the fixture
    that the joint belongs to.
    """
    scene, model, data = clearance.scene, clearance.model, clearance.data
    body = int(model.jnt_bodyid[joint])
    inside = clearance.subtree(body)
    clearance.place(clearance.start)
    carried = clearance.supported_by(inside)
    before_pos, before_mat = data.xpos[body].copy(), data.xmat[body].reshape(3, 3).copy()
    qpos = clearance.start.copy()
    qpos[scene.qpos_slice(joint)] = value
    clearance.place(qpos)
    turn = data.xmat[body].reshape(3, 3) @ before_mat.T
    bodies = list(inside)
    for entity in carried:
        free = scene.free_joint(entity)
        if free is None:
            continue
        where = scene.qpos_slice(free)
        pose = qpos[where].copy()
        qpos[where] = np.concatenate(
            [data.xpos[body] + turn @ (pose[:3] - before_pos), quaternion_of(turn @ matrix_of(pose[3:]))]
        )
        bodies += scene.bodies(entity).tolist()
    clearance.place(qpos)
    whole = clearance.geom_mask(clearance.subtree(int(model.body_rootid[body])))
    return qpos, carried, clearance.overlap(clearance.pairs(clearance.geom_mask(bodies), whole))
