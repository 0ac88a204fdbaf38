"""``Open``, ``Close``, ``Turnon``, ``Turnoff``: hinges and slides against the threshold that the ontology declares.

Which joints are read is LIBERO's choice (``base_object_states.py``): all of an object's, or those of the body that
carries a region. ``Open`` and ``Turnon`` ask for any joint, ``Close`` and ``Turnoff`` for all: they are no negations of
each other.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from grounding.plans import Joints
from grounding.predicates.arguments import one_name, unsuited
from grounding.predicates.terms import Grounding, Term, all_of, any_of
from grounding.scenes import Scene
from onto_compiler.problems import near
from onto_compiler.required import Fact
from onto_compiler.schema import JointThreshold, Schema

__all__ = ["joint_threshold"]


def joint_threshold(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground a joint state; the fact's second argument is the IRI of its :class:`JointThreshold`.

    The margin is ``qpos - bound`` or ``bound - qpos``, in the joint's unit (radians or metres). Raises ``SIM002`` for
    an unknown name, ``SIM006`` when the threshold is not declared or a joint is neither hinge nor slide.
    """
    name = one_name(fact)
    threshold = _threshold(fact, schema)
    model = scene.model
    joints = [int(joint) for joint in scene.joints(name)]
    if any(scene.qpos_slice(joint).stop - scene.qpos_slice(joint).start != 1 for joint in joints):
        raise unsuited(fact, f"`{name}` moves freely, so `{fact.native}` has no single joint position to compare")
    addresses = [(int(model.jnt_qposadr[joint]), model.joint(joint).name) for joint in joints]
    sign, bound, inclusive = (1.0 if threshold.above else -1.0), threshold.bound, threshold.inclusive

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        qpos = data.qpos
        margins = [(sign * (float(qpos[address]) - bound), joint) for address, joint in addresses]
        return tuple(Term("qpos", m, m > 0.0 or (inclusive and m == 0.0), joint) for m, joint in margins)

    plan = Joints(tuple(address for address, _ in addresses), sign, bound, threshold.every_joint)
    return Grounding(terms, all_of if threshold.every_joint else any_of, plan)


def _threshold(fact: Fact, schema: Schema) -> JointThreshold:
    iri = fact.arguments[1].type if len(fact.arguments) > 1 else ""
    threshold = schema.threshold(iri)
    if threshold is None:
        known = [each.iri for each in schema.thresholds.values()]
        raise unsuited(fact, f"`{fact}` names no declared joint threshold", near(iri, known))
    return threshold
