"""The route ``source_joint_pose``: a joint inside its threshold's side, or the object itself inside a region.

Source (paper, table "Typed gates and state-correction families"): source/joint failures are corrected in source or
joint coordinates.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from runtime.worlds.libero.proposers.candidates import StateCandidate, offer, ranked
from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.joints import SINK_M, moved, side_values
from runtime.worlds.libero.proposers.poses import landing_batches, leaving_batches
from runtime.worlds.libero.scene.targets import place_of, slot_of, threshold_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from onto_compiler.schema import JointThreshold, Schema
    from runtime.loop.proposer import Request
    from runtime.loop.records import Proposal

__all__ = ["HeuristicSourceJointPose"]

COLLIDES = 2  # flaw: the joint's body, or what it carries, sinks into something


class HeuristicSourceJointPose:
    """Moves articulated joints for ``joint_state`` and free objects for ``in_region``."""

    name = "heuristic_source_joint_pose"

    def __init__(self, schema: Schema) -> None:
        """Read joint thresholds from ``schema``."""
        self.schema = schema

    def propose(self, request: Request) -> Proposal | None:
        """Return candidate number ``request.candidate``, or None when it asks for neither or no more are left."""
        return offer(request, "source_joint_pose", self.name, self.candidates(request))

    def candidates(self, request: Request) -> Iterator[StateCandidate]:
        """All candidates, best first."""
        fact = request.diagnosis.fact
        threshold = threshold_of(self.schema, fact)
        if threshold is not None:
            yield from ranked(request, [list(_joint_states(request, threshold))])
            return
        place = place_of(request.scene, fact)
        if place is not None and fact.polarity:
            yield from ranked(request, landing_batches(request, place, slot_of(request.required, fact)))
        elif place is not None:
            yield from ranked(request, leaving_batches(request, place))


def _joint_states(request: Request, threshold: JointThreshold) -> Iterator[StateCandidate]:
    """States with one joint, or where the fact asks for all of them every joint, on the satisfied side."""
    scene, polarity = request.scene, request.diagnosis.fact.polarity
    name = request.diagnosis.fact.native.arguments[0]
    joints = [int(j) for j in scene.joints(name) if int(j) != _free(request, name)]
    together = threshold.every_joint == polarity
    values = {j: list(side_values(threshold, _limits(request, j), polarity)) for j in joints}
    groups = [tuple(joints)] if together else [(j,) for j in joints]
    for group, step in itertools.product(groups, range(max((len(v) for v in values.values()), default=0))):
        if not group or any(step >= len(values[j]) for j in group):
            continue
        qpos, notes, deepest = request.qpos, [], 0.0
        for joint in group:
            qpos, carried, depth = moved(Clearance(scene, qpos), joint, values[joint][step])
            deepest = max(deepest, depth)
            label = f"{scene.joint_at(int(scene.model.jnt_qposadr[joint]))} to {values[joint][step]:.4f}"
            notes.append(label + (f", carrying {', '.join(carried)}" if carried else ""))
        yield StateCandidate(qpos, "; ".join(notes), COLLIDES if deepest > SINK_M else 0, max(deepest, SINK_M))


def _limits(request: Request, joint: int) -> tuple[float, float] | None:
    model = request.scene.model
    if not model.jnt_limited[joint]:
        return None
    low, high = model.jnt_range[joint]
    return float(low), float(high)


def _free(request: Request, name: str) -> int | None:
    return request.scene.free_joint(name) if name in request.scene.entities else None
