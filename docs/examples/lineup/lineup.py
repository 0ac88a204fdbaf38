"""Objects in one line: how far two of them are out of it, and a state in which they are not."""

from collections.abc import Callable

import mujoco
import numpy as np

from grounding.observation import Evidence
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.loop.proposer import Request
from runtime.loop.records import Proposal

TOLERANCE = 0.01  # metres between the two lines
STEPS = (0.0, 0.005, -0.005)  # metres off the line; what is tried after a rejection


def in_line(scene: Scene, fact: Fact, schema: Schema) -> Callable[[mujoco.MjData], Evidence]:
    """Ground ``AlignedWith(thing, other)``: the y of both origins differs by no more than the tolerance."""
    thing, other = (scene.root_body(name) for name in fact.native.arguments)

    def evidence(data: mujoco.MjData) -> Evidence:
        margin = TOLERANCE - abs(float(data.xpos[thing][1] - data.xpos[other][1]))
        return Evidence(truth=margin >= 0, margin=margin, limit="y")

    return evidence


class LineUp:
    """Proposes states in which the first object has moved along y, into the line of the second."""

    name = "line_up"

    def __init__(self, schema: Schema) -> None:
        """Every proposer is given the schema, and this one needs nothing of it."""

    def propose(self, request: Request) -> Proposal | None:
        """Candidate number ``request.candidate``, or None if there are no more."""
        if request.candidate >= len(STEPS):
            return None
        scene, names = request.scene, request.diagnosis.fact.native.arguments
        thing, other = (scene.free_joint(name) for name in names)
        if thing is None or other is None:  # a fixture: it has no free joint
            return None
        y = scene.qpos_slice(thing).start + 1  # qpos of a free joint: position, then quaternion (wxyz)
        qpos = request.qpos.copy()
        qpos[y] = request.qpos[scene.qpos_slice(other).start + 1] + STEPS[request.candidate]
        note = f"{names[0]} moved by {qpos[y] - request.qpos[y]:+.3f} m along y"
        changed = tuple(int(address) for address in np.flatnonzero(qpos != request.qpos))
        return Proposal("line_up", self.name, request.candidate, qpos, changed, note)
