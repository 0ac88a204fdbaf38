"""Truth without margins: compiled, and the same as the grounding functions'."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grounding.evaluate import TIE
from grounding.memory import contact_places
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom

XML = """
<mujoco>
  <worldbody>
    <body name="shelf_1_main" pos="0 0 0.5" euler="0 0 30">
      <geom name="shelf_1_g0" type="box" size="0.3 0.3 0.05" group="0"/>
      <site name="shelf_1_top_region" type="box" size="0.1 0.2 0.02" pos="0 0 0.06"/>
      <body name="shelf_1_door">
        <joint name="shelf_1_slide" type="slide" axis="1 0 0"/>
        <geom name="shelf_1_g1" type="box" size="0.05 0.05 0.01" pos="0 0 0.06" group="0"/>
        <joint name="shelf_1_turn" type="hinge" axis="0 0 1"/>
      </body>
    </body>
    <body name="cube_1_main" pos="0 0 0.7">
      <freejoint name="cube_1_joint0"/>
      <geom name="cube_1_g0" type="box" size="0.03 0.03 0.03" group="0"/>
    </body>
    <body name="ball_1_main" pos="0.5 0 0.7">
      <freejoint name="ball_1_joint0"/>
      <geom name="ball_1_g0" type="sphere" size="0.03" group="0"/>
    </body>
  </worldbody>
</mujoco>
"""
MODEL = mujoco.MjModel.from_xml_string(XML)
SCENE = Scene(MODEL)
ONTOLOGY = load_schema()
THRESHOLDS = [t for t in ONTOLOGY.thresholds.values() if t.category in {"wooden_cabinet", "flat_stove"}]


def fact(grounded_by, native, *arguments, threshold=""):
    entities = (*(Entity(a, "") for a in arguments), *([Entity("threshold", threshold)] if threshold else ()))
    return Fact("urn:p", entities, NativeAtom(native, arguments), grounded_by)


FACTS = (
    fact("on_object", "On", "ball_1", "cube_1"),
    fact("on_object", "On", "cube_1", "ball_1"),
    fact("on_object", "On", "cube_1", "cube_1"),
    fact("on_site", "On", "cube_1", "shelf_1_top_region"),
    fact("in_site", "In", "ball_1", "shelf_1_top_region"),
    fact("placed_in_region", "On", "ball_1", "shelf_1_top_region"),
    *(fact("joint_threshold", t.native, "shelf_1", threshold=t.iri) for t in THRESHOLDS),
)


def state(cube=(0, 0, 0.7), ball=(0.5, 0, 0.7), slide=0.0, turn=0.0):
    data = mujoco.MjData(MODEL)
    data.qpos[SCENE.qpos_slice(SCENE.free_joint("cube_1"))][:3] = cube
    data.qpos[SCENE.qpos_slice(SCENE.free_joint("ball_1"))][:3] = ball
    data.qpos[SCENE.qpos_slice(MODEL.joint("shelf_1_slide").id)] = slide
    data.qpos[SCENE.qpos_slice(MODEL.joint("shelf_1_turn").id)] = turn
    mujoco.mj_forward(MODEL, data)
    return data


def grounder(*facts):
    return SimGrounder(SCENE, facts or FACTS, ONTOLOGY)


metres = st.floats(-0.15, 0.15)
SHARED = grounder()


def test_every_kind_of_grounding_has_a_plan():
    assert len(THRESHOLDS) == 4
    assert all(SHARED.planned)


@settings(max_examples=400, deadline=None)
@given(cube=st.tuples(metres, metres, metres), ball=st.tuples(metres, metres, metres), slide=metres, turn=metres)
def test_truth_is_what_an_observation_says(cube, ball, slide, turn):
    at = np.array([0, 0, 0.6]) + cube
    data = state(at, at + ball, slide, turn)
    observed = SHARED.observe(data)
    assert SHARED.truth(data).tolist() == observed.truth.tolist()
    for fact, terms, margin, limit in zip(FACTS, SHARED.terms(data), observed.margin, observed.limit, strict=True):
        least = (max if fact.native.predicate in {"Open", "Turnon"} else min)(terms, key=lambda term: term.margin)
        assert (margin, limit) == (least.margin, least.name)


@pytest.mark.parametrize("index", range(len(THRESHOLDS)))
@pytest.mark.parametrize("off", [0.0, 1e-17, -1e-17, TIE / 2, -TIE / 2, 2 * TIE, -2 * TIE])
def test_at_a_bound_the_grounding_function_decides(index, off):
    threshold = THRESHOLDS[index]
    data = state(slide=threshold.bound + off, turn=threshold.bound + off)
    one = fact("joint_threshold", threshold.native, "shelf_1", threshold=threshold.iri)
    ours = grounder(one)
    assert ours.truth(data).tolist() == ours.observe(data).truth.tolist()
    assert (ours._compiled(data) == 1) == (abs(off) < TIE)


def test_one_grounder_reads_one_state_after_another():
    on, off = state(cube=(0, 0, 0.6), ball=(0, 0, 0.659)), state()
    ours = grounder(FACTS[0])
    assert [ours.truth(data).tolist() for data in (on, off, on)] == [[True], [False], [True]]
    on.qpos[SCENE.qpos_slice(SCENE.free_joint("ball_1"))][2] = 0.9
    mujoco.mj_forward(MODEL, on)
    assert ours.truth(on).tolist() == [False]


def test_what_was_answered_is_not_changed_by_the_next_question():
    ours = grounder(FACTS[0])
    first = ours.truth(state(cube=(0, 0, 0.6), ball=(0, 0, 0.659)))
    ours.truth(state())
    assert first.tolist() == [True]


def test_more_contacts_than_a_word_has_bits_are_left_to_the_grounding_functions():
    ours = grounder(*[FACTS[0], FACTS[1]] * 40)
    for data in (state(cube=(0, 0, 0.6), ball=(0, 0, 0.659)), state(ball=(0, 0, 0.6), cube=(0, 0, 0.659))):
        expected = ours.observe(data).truth
        assert expected.any()
        assert ours.truth(data).tolist() == expected.tolist()
    assert ours._compiled(data) == 16


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("known", [True, False])
def test_a_state_that_is_not_finite_is_refused(value, known):
    data, ours = state(), grounder()
    if known:
        ours.truth(data)
    data.qpos[9] = value
    with pytest.raises(OntoError) as caught:
        ours.truth(data)
    assert caught.value.problems[0].code == "SIM003"


@pytest.mark.parametrize("bodies", [1, 3])
def test_a_state_of_another_scene_is_refused(bodies):
    free = "<body><freejoint/><geom size='1'/></body>" * bodies
    other = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{free}</worldbody></mujoco>")
    with pytest.raises(OntoError) as caught:
        grounder().truth(mujoco.MjData(other))
    assert caught.value.problems[0].code == "SIM004"


def test_a_state_of_as_many_joints_but_other_bodies_is_refused():
    joints = "<body><joint type='slide'/><geom size='1'/></body>" * MODEL.nq
    other = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{joints}</worldbody></mujoco>")
    data = mujoco.MjData(other)
    assert data.qpos.size == MODEL.nq
    with pytest.raises(OntoError) as caught:
        grounder().truth(data)
    assert caught.value.problems[0].code == "SIM004"


def test_under_a_mujoco_of_another_layout_the_grounding_functions_answer(monkeypatch):
    from grounding import memory

    memory.contact_places.cache_clear()
    monkeypatch.setattr(memory, "_right", lambda _: False)
    ours, data = grounder(), state(cube=(0, 0, 0.6), ball=(0, 0, 0.659))
    assert ours.truth(data).tolist() == ours.observe(data).truth.tolist()
    assert ours._compiled is None
    monkeypatch.undo()
    memory.contact_places.cache_clear()
    assert grounder()._compiled is not None


def test_the_contacts_are_where_mujoco_has_them():
    places = contact_places()
    assert places.stride > places.geom > 0
    assert places.ncon != places.contact
