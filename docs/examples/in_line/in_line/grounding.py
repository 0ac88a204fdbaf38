"""How far two objects are from a common line, measured in a MuJoCo state."""

from collections.abc import Callable

import mujoco

from grounding.observation import Evidence
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

TOLERANCE = 0.01  # metres between the two origins along y


def in_line(scene: Scene, fact: Fact, _: Schema) -> Callable[[mujoco.MjData], Evidence]:
    """Ground a fact of two objects: the y of both origins differs by no more than the tolerance."""
    thing, other = (scene.root_body(name) for name in fact.native.arguments)

    def evidence(data: mujoco.MjData) -> Evidence:
        margin = TOLERANCE - abs(float(data.xpos[thing][1] - data.xpos[other][1]))
        return Evidence(truth=margin >= 0, margin=margin, limit="y")

    return evidence
