"""States in which one object has moved along y, to where the other is."""

import numpy as np

from onto_compiler.schema import Schema
from runtime.loop.proposer import Request
from runtime.loop.records import Proposal

STEPS = (0.0, 0.005, -0.005)  # metres from the other object's y: what is tried after a rejection


class InLineProposer:
    """Moves the first argument of an unmet fact along y to the second."""

    name = "in_line"

    def __init__(self, _: Schema) -> None:
        """Every proposer is given the schema, and this one needs nothing of it."""

    def propose(self, request: Request) -> Proposal | None:
        """Candidate number ``request.candidate``, or None if there are no more."""
        scene, names = request.scene, request.diagnosis.fact.native.arguments
        joints = [scene.free_joint(name) for name in names]
        if request.candidate >= len(STEPS) or len(joints) != 2 or None in joints:  # a fixture has no free joint
            return None
        thing, other = (scene.qpos_slice(joint).start + 1 for joint in joints)  # qpos: position, then quaternion (wxyz)
        qpos = request.qpos.copy()
        qpos[thing] = request.qpos[other] + STEPS[request.candidate]
        note = f"{names[0]} moved by {qpos[thing] - request.qpos[thing]:+.3f} m along y"
        changed = tuple(int(address) for address in np.flatnonzero(qpos != request.qpos))
        return Proposal("in_line_missing_route", self.name, request.candidate, qpos, changed, note)
