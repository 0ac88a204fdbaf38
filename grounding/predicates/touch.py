"""Contact as robosuite's success conditions ask for it: two entities that touch, and an object between two fingers."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from grounding.predicates.arguments import two_names
from grounding.predicates.contact import ContactTerm
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["grasped", "touching"]

FINGERPADS = ("left_fingerpad", "right_fingerpad")
"""What robosuite calls the pads of a gripper (``GripperModel.important_geoms``)."""


def touching(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``Touching(first, second)``: robosuite's ``check_contact``; raises ``SIM001`` for an unknown name."""
    contact = ContactTerm(scene, *two_names(fact))
    return Grounding(lambda _: (), all_of, contact=contact)


def grasped(scene: Scene, fact: Fact, schema: Schema) -> Grounding:  # noqa: ARG001  a factory's signature
    """Ground ``Grasped(object, gripper)``: both fingerpads of the gripper touch it, as in robosuite's ``_check_grasp``.

    The pads are parts of the scene's naming, ``GRIPPER_left_fingerpad`` and its like. Raises ``SIM001`` if the scene
    has no such object or parts.
    """
    name, gripper = two_names(fact)
    pads = [ContactTerm(scene, f"{gripper}_{pad}", name) for pad in FINGERPADS]

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        return [pad(data) for pad in pads]

    return Grounding(terms, all_of)
