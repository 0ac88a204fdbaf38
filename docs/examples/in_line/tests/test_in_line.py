"""The package as it is installed: its files pass `onto check`, and what it registers measures and corrects."""

from importlib.metadata import entry_points
from pathlib import Path

import mujoco
import numpy as np
import pytest

import in_line
from grounding.scenes import Scene
from onto_compiler.bddl import lift, parse_file
from onto_compiler.check.tasks import check_all
from onto_compiler.knowledge import load_knowledge
from runtime.loop.proposer import Request
from runtime.loop.records import Diagnosis

FOLDER = Path(in_line.__file__).parent
BODY = '<body name="{name}_main" pos="0 {y} 0"><freejoint name="{name}_joint0"/><geom size="0.03"/></body>'
THINGS = BODY.format(name="akita_black_bowl_1", y=0.2) + BODY.format(name="plate_1", y=0)
MODEL = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{THINGS}</worldbody></mujoco>")
KNOWLEDGE = load_knowledge(FOLDER / "in_line.ttl")
REQUIRED, WARNINGS = lift(parse_file(FOLDER / "in_line.bddl"), KNOWLEDGE.schema, "in_line")
(FACT,) = REQUIRED.facts


def registered(group, name):
    """What this package registers under a name, for an installed package as Onto-EV-WM finds it."""
    (point,) = entry_points(group=f"onto_evwm.{group}", name=name)
    return point.load()


def evidence(qpos):
    """What the grounding function says of a state."""
    data = mujoco.MjData(MODEL)
    data.qpos[:] = qpos
    mujoco.mj_forward(MODEL, data)
    return registered("groundings", FACT.grounded_by)(Scene(MODEL), FACT, KNOWLEDGE.schema)(data)


def propose(candidate):
    """A candidate for the unmet fact in the model's first state."""
    key = (FACT.predicate, True, "https://w3id.org/onto-evwm/core#ExplicitlyFalse")
    entry = KNOWLEDGE.tables.diagnosis[key]
    diagnosis = Diagnosis(FACT, 0, entry.failure, key[2], False, -0.19, "y", "sim", entry.rule, 0)
    proposer = registered("proposers", "in_line_missing_route")(KNOWLEDGE.schema)
    rng = np.random.default_rng(0)
    return proposer.propose(
        Request(Scene(MODEL), MODEL.qpos0, np.zeros(MODEL.nv), REQUIRED, diagnosis, candidate, evidence, rng)
    )


def test_its_files_pass_onto_check():
    assert check_all([FOLDER]).problems == ()
    assert WARNINGS == ()


def test_the_margin_is_positive_where_the_predicate_holds():
    near, far = MODEL.qpos0.copy(), MODEL.qpos0.copy()
    near[1], far[1] = 0.006, -0.03
    assert evidence(near).truth
    assert evidence(near).margin == pytest.approx(0.004)
    assert not evidence(far).truth
    assert evidence(far).margin == pytest.approx(-0.02)


def test_an_unmet_fact_is_diagnosed_and_corrected():
    assert not evidence(MODEL.qpos0).truth
    for candidate in range(3):
        assert evidence(propose(candidate).qpos).truth
    assert propose(3) is None
