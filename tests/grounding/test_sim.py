"""The grounder on a small scene of its own: no LIBERO needed."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from grounding.predicates import registry
from grounding.predicates.boxes import box_distance
from grounding.predicates.contact import ContactTerm
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError, Span
from onto_compiler.required import Entity, Fact, NativeAtom

XML = """
<mujoco>
  <worldbody>
    <body name="table" pos="0 0 0.5">
      <geom name="table_top" type="box" size="1 1 0.05" group="0"/>
      <site name="table_goal_region" type="box" size="0.2 0.1 0.007" pos="0.3 0 0.06"/>
    </body>
    <body name="block_1_main" pos="0 0 0.6">
      <freejoint name="block_1_joint0"/>
      <geom name="block_1_g0" type="box" size="0.03 0.03 0.03" group="0"/>
      <geom name="block_1_g1" type="box" size="0.04 0.04 0.04" group="1" contype="0" conaffinity="0"/>
      <site name="block_1_default_site" size="0.01"/>
    </body>
    <body name="ball_1_main" pos="0.5 0 0.6">
      <freejoint name="ball_1_joint0"/>
      <geom name="ball_1_g0" type="sphere" size="0.03" group="0"/>
    </body>
    <body name="cabinet_1_main" pos="-0.5 0 0.6" euler="0 0 40">
      <geom name="cabinet_1_g0" type="box" size="0.1 0.1 0.05" group="0"/>
      <body name="cabinet_1_drawer">
        <joint name="cabinet_1_slide" type="slide" axis="1 0 0" range="-0.2 0.01"/>
        <geom name="cabinet_1_g1" type="box" size="0.08 0.08 0.01" pos="0 0 0.06" group="0"/>
        <geom name="cabinet_1_g2" type="capsule" size="0.01 0.02" pos="0.1 0 0.06" group="0"/>
        <site name="cabinet_1_top_region" type="box" size="0.08 0.06 0.02" pos="0 0 0.07"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
ONTOLOGY = load_schema()
OPEN = next(t.iri for t in ONTOLOGY.thresholds.values() if (t.category, t.native) == ("wooden_cabinet", "Open"))
CLOSED = next(t.iri for t in ONTOLOGY.thresholds.values() if (t.category, t.native) == ("wooden_cabinet", "Close"))


def fact(grounded_by, native, *arguments, threshold="", span=None):
    entities = (*(Entity(a, "") for a in arguments), *([Entity("threshold", threshold)] if threshold else ()))
    return Fact("urn:p", entities, NativeAtom(native, arguments), grounded_by, span=span)


FACTS = (
    fact("on_object", "On", "ball_1", "block_1"),
    fact("on_site", "On", "block_1", "table_goal_region"),
    fact("on_site", "On", "block_1", "cabinet_1_top_region"),
    fact("in_site", "In", "ball_1", "cabinet_1_top_region"),
    fact("joint_threshold", "Open", "cabinet_1_top_region", threshold=OPEN),
    fact("joint_threshold", "Close", "cabinet_1", threshold=CLOSED),
    fact("placed_in_region", "On", "cabinet_1", "table_goal_region"),
)


MODEL = mujoco.MjModel.from_xml_string(XML)


@pytest.fixture
def model():
    return MODEL


@pytest.fixture(scope="module")
def scene():
    return Scene(MODEL)


def state(model, scene, **where):
    """A forwarded state: positions of entities, or the value of a joint."""
    data = mujoco.MjData(model)
    for name, value in where.items():
        joint = scene.free_joint(name) if name in scene.entities else int(model.joint(name).id)
        data.qpos[scene.qpos_slice(joint)][: np.size(value)] = value
    mujoco.mj_forward(model, data)
    return data


def problems(call, *arguments):
    with pytest.raises(OntoError) as caught:
        call(*arguments)
    return caught.value.problems


# The index ------------------------------------------------------------------------------------------------------------


def test_a_scene_lists_entities_and_regions(scene):
    assert scene.entities == ("block_1", "ball_1", "cabinet_1")
    assert scene.sites == ("table_goal_region", "cabinet_1_top_region")


def test_a_scene_gives_an_entity_its_bodies_contact_geoms_and_joints(model, scene):
    def names(kind, ids):
        return [kind(int(i)).name for i in ids]

    assert model.body(scene.root_body("cabinet_1")).name == "cabinet_1_main"
    assert names(model.body, scene.bodies("cabinet_1")) == ["cabinet_1_main", "cabinet_1_drawer"]
    assert names(model.geom, scene.contact_geoms("block_1")) == ["block_1_g0"]
    assert names(model.geom, scene.contact_geoms("cabinet_1")) == ["cabinet_1_g0", "cabinet_1_g1", "cabinet_1_g2"]
    assert names(model.joint, scene.joints("cabinet_1")) == ["cabinet_1_slide"]
    assert scene.free_joint("cabinet_1") is None


def test_a_regions_carrier_and_joints_are_those_of_its_site(model, scene):
    assert scene.site_parent("table_goal_region") is None
    assert scene.site_parent("cabinet_1_top_region") == "cabinet_1"
    assert [model.joint(int(j)).name for j in scene.joints("cabinet_1_top_region")] == ["cabinet_1_slide"]
    assert scene.joints("table_goal_region").size == 0


def test_a_scene_says_where_qpos_and_qvel_hold_a_joint(scene):
    ball = scene.free_joint("ball_1")
    assert (scene.qpos_slice(ball), scene.dof_slice(ball)) == (slice(7, 14), slice(6, 12))
    (slide,) = scene.joints("cabinet_1")
    assert (scene.qpos_slice(slide), scene.dof_slice(slide)) == (slice(14, 15), slice(12, 13))
    assert [scene.joint_at(a) for a in (0, 6, 7, 14)] == [
        "block_1_joint0",
        "block_1_joint0",
        "ball_1_joint0",
        "cabinet_1_slide",
    ]


def test_the_ids_of_a_scene_cannot_be_changed(scene):
    with pytest.raises(ValueError, match="read-only"):
        scene.bodies("block_1")[0] = 3


def test_a_scene_leaves_its_model_unchanged():
    model = mujoco.MjModel.from_xml_string(XML)
    before = model.body_pos.copy(), model.geom_pos.copy(), model.site_size.copy()
    SimGrounder(Scene(model), FACTS, ONTOLOGY).observe(state(model, Scene(model)))
    assert all(
        np.array_equal(a, b) for a, b in zip(before, (model.body_pos, model.geom_pos, model.site_size), strict=True)
    )


@pytest.mark.parametrize(
    ("method", "name", "code", "hint"),
    [
        ("root_body", "blok_1", "SIM001", "did you mean `block_1`?"),
        ("contact_geoms", "table_goal_region", "SIM001", ""),
        ("free_joint", "nothing_like_it", "SIM001", ""),
        ("site", "table_gaol_region", "SIM002", "did you mean `table_goal_region`?"),
        ("site_parent", "block_1", "SIM002", ""),
        ("joints", "cabinet_1_topregion", "SIM002", "did you mean `cabinet_1_top_region`?"),
    ],
)
def test_an_unknown_name_is_answered_with_a_near_one(scene, method, name, code, hint):
    (problem,) = problems(getattr(scene, method), name)
    assert (problem.code, problem.hint) == (code, hint)
    assert f"`{name}`" in problem.message


# Margins --------------------------------------------------------------------------------------------------------------

metres = st.floats(-0.12, 0.12)
anchors = st.sampled_from([(0.3, 0.0, 0.6), (-0.5, 0.0, 0.7), (0.5, 0.0, 0.63)])


@settings(max_examples=300, deadline=None)
@given(anchor=anchors, near=st.tuples(metres, metres, metres), off=st.tuples(metres, metres, metres), slide=metres)
def test_the_sign_of_the_margin_is_the_truth(anchor, near, off, slide):
    block = np.array(anchor) + near
    model = MODEL
    scene = Scene(model)
    data = state(model, scene, block_1=block, ball_1=block + off, cabinet_1_slide=slide)
    grounder = SimGrounder(scene, FACTS, ONTOLOGY)
    observed = grounder.observe(data)
    assert not ((observed.margin > 0) & ~observed.truth).any()
    assert not ((observed.margin < 0) & observed.truth).any()
    for terms in grounder.terms(data):
        assert all(t.holds if t.margin > 0 else not t.holds for t in terms if t.margin != 0)


def test_a_block_at_rest_in_its_region_has_the_margin_of_the_nearest_side(model, scene):
    grounder = SimGrounder(scene, FACTS[1:2], ONTOLOGY)
    observed = grounder.observe(state(model, scene, block_1=(0.45, 0.0, 0.58)))
    assert observed.truth.tolist() == [True]
    assert observed.limit == ("height",)
    assert observed.margin[0] == pytest.approx(0.02 - 0.002)
    observed = grounder.observe(state(model, scene, block_1=(0.51, 0.0, 0.6)))
    assert (observed.truth[0], observed.limit) == (False, ("x",))
    assert observed.margin[0] == pytest.approx(-0.01)


def test_apart_the_contact_margin_is_minus_the_gap(model, scene):
    contact = ContactTerm(scene, "block_1", "ball_1")
    term = contact(state(model, scene, block_1=(0, 0, 1), ball_1=(0.1, 0, 1)))
    assert not term.holds
    assert term.margin == pytest.approx(-0.04, abs=1e-6)


def test_touching_the_contact_margin_is_the_depth(model, scene):
    contact = ContactTerm(scene, "block_1", "ball_1")
    term = contact(state(model, scene, block_1=(0, 0, 1), ball_1=(0.058, 0, 1)))
    assert term.holds
    assert term.margin == pytest.approx(0.002, abs=1e-6)


@settings(max_examples=200, deadline=None)
@given(where=st.tuples(st.floats(-0.9, 0.0), st.floats(-0.4, 0.4), st.floats(0.5, 1.0)), slide=metres)
@example(where=(-0.390625, 0.0, 0.96875), slide=0.0)  # mj_geomDistance answers 0 for the box 32 cm below
def test_the_gap_to_boxes_is_the_smallest_over_all_pairs(where, slide):
    scene = Scene(MODEL)
    data = state(MODEL, scene, block_1=where, cabinet_1_slide=slide)
    contact = ContactTerm(scene, "block_1", "cabinet_1")
    term = contact(data)
    block, capsule = MODEL.geom("block_1_g0").id, MODEL.geom("cabinet_1_g2").id
    boxes = [box(data, block, MODEL.geom(f"cabinet_1_g{i}").id) for i in (0, 1)]
    gap = min(*boxes, contact._distance(data, block, capsule, 100.0))
    if not term.holds:
        assert term.margin == pytest.approx(-gap, abs=1e-6)


def box(data, first, second):
    return box_distance(
        *((data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3), MODEL.geom_size[g]) for g in (first, second))
    )


@settings(max_examples=200, deadline=None)
@given(
    where=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.7, 1.2)),
    turn=st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1),
)
def test_the_distance_of_two_boxes_is_mujocos_wherever_that_is_consistent(where, turn):
    scene = Scene(MODEL)
    data = mujoco.MjData(MODEL)
    data.qpos[scene.qpos_slice(scene.free_joint("block_1"))] = [*where, *(np.array(turn) / np.linalg.norm(turn))]
    mujoco.mj_forward(MODEL, data)
    first, second = MODEL.geom("block_1_g0").id, MODEL.geom("cabinet_1_g0").id
    distance, witness = box(data, first, second), np.zeros(6)
    found = mujoco.mj_geomDistance(MODEL, data, first, second, 100.0, witness)
    if found > 0 and abs(np.linalg.norm(witness[3:] - witness[:3]) - found) < 1e-6:
        assert distance == pytest.approx(found, abs=1e-6)
    else:
        assert distance >= 0


def test_boxes_that_overlap_have_no_distance():
    cube = np.zeros(3), np.eye(3), np.ones(3)
    tall = np.array([0.0, 0.0, 0.5]), np.eye(3), np.array([0.1, 0.1, 5.0])  # its edges pierce the cube's faces
    assert box_distance(cube, tall) == 0.0


@pytest.mark.parametrize(
    ("centre", "turned", "distance"),
    [
        ((3.0, 0.0, 0.0), False, 1.0),  # face to face
        ((3.0, 3.0, 0.0), False, np.sqrt(2.0)),  # edge along edge
        ((3.0, 3.0, 3.0), False, np.sqrt(3.0)),  # corner to corner
        ((0.0, 0.0, 4.0), True, 4.0 - 2.0 * np.sqrt(2.0)),  # edge across edge
    ],
)
def test_the_distance_of_two_boxes_is_exact_for_each_pair_of_features(centre, turned, distance):
    half = np.sqrt(0.5)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, half, -half], [0.0, half, half]])
    about_y = np.array([[half, 0.0, half], [0.0, 1.0, 0.0], [-half, 0.0, half]])
    first = np.zeros(3), about_x if turned else np.eye(3), np.ones(3)
    second = np.array(centre), about_y if turned else np.eye(3), np.ones(3)
    assert box_distance(first, second) == pytest.approx(distance)
    assert box_distance(second, first) == pytest.approx(distance)


def test_an_open_drawer_is_any_joint_and_a_closed_one_all(model, scene):
    grounder = SimGrounder(scene, FACTS[4:6], ONTOLOGY)
    for value, expected in ((-0.2, [True, False]), (-0.05, [False, False]), (0.005, [False, True])):
        observed = grounder.observe(state(model, scene, cabinet_1_slide=value))
        assert observed.truth.tolist() == expected
        assert observed.margin == pytest.approx([-0.14 - value, value])
        assert observed.limit == ("qpos", "qpos")


def test_a_fixture_is_placed_by_its_origin_alone(model, scene):
    placed = fact("placed_in_region", "On", "block_1", "table_goal_region")
    grounder = SimGrounder(scene, [placed], ONTOLOGY)
    for x, holds in ((0.3, True), (0.49, True), (0.51, False)):
        observed = grounder.observe(state(model, scene, block_1=(x, 0.0, 3.0)))
        assert observed.truth.tolist() == [holds]
        assert observed.margin[0] == pytest.approx(min(0.1, 0.2 - abs(x - 0.3)))


def test_an_observation_is_aligned_with_its_facts(model, scene):
    observed = SimGrounder(scene, FACTS, ONTOLOGY).observe(state(model, scene), step=7)
    assert (observed.source, observed.step, len(observed)) == ("sim", 7, len(FACTS))
    assert observed.observed.all()
    assert np.isnan(observed.score).all()
    assert np.isfinite(observed.margin).all()


# Faults ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("address", "joint"), [(2, "block_1_joint0"), (9, "ball_1_joint0"), (14, "cabinet_1_slide")])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_state_that_is_not_finite_is_refused_by_the_name_of_its_joint(model, scene, address, joint, value):
    data = state(model, scene)
    data.qpos[address] = value
    (problem,) = problems(SimGrounder(scene, FACTS, ONTOLOGY).observe, data)
    assert problem.code == "SIM003"
    assert f"`{joint}`" in problem.message


def test_a_state_of_another_scene_is_refused(scene):
    other = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    (problem,) = problems(SimGrounder(scene, FACTS, ONTOLOGY).observe, mujoco.MjData(other))
    assert problem.code == "SIM004"


def test_every_fault_of_a_task_is_reported_at_its_place(scene):
    span = Span("task.bddl", 12, 5, 12, 20)
    wrong = [
        fact("on_objekt", "On", "ball_1", "block_1", span=span),
        fact("on_object", "On", "ball_2", "block_1", span=span),
        fact("on_site", "On", "ball_1", "top", span=span),
        fact("in_site", "In", "ball_1", span=span),
        fact("joint_threshold", "Open", "cabinet_1", threshold="urn:none", span=span),
        fact("joint_threshold", "Open", "block_1", threshold=OPEN, span=span),
    ]
    found = problems(lambda: SimGrounder(scene, [*FACTS, *wrong], ONTOLOGY))
    assert [p.code for p in found] == ["SIM001", "SIM002", "SIM005", "SIM006", "SIM006", "SIM006"]
    assert {(p.file, p.line, p.column) for p in found} == {("task.bddl", 12, 5)}
    hints = {p.code: p.hint for p in found if p.code != "SIM006"}
    assert hints == {"SIM001": "did you mean `ball_1`?", "SIM002": "", "SIM005": "did you mean `on_object`?"}


# The registry ---------------------------------------------------------------------------------------------------------


def test_every_grounding_that_the_ontology_names_is_registered_and_loads():
    named = {b.grounded_by for b in ONTOLOGY.bindings} | {p.grounded_by for p in ONTOLOGY.predicates.values()}
    named |= {getattr(b, "premise_grounded_by", None) for b in ONTOLOGY.bindings}
    named -= {None, ""}
    assert named == {
        *("in_site", "joint_threshold", "on_object", "on_site", "placed_in_region"),
        *("at_target", "free_of", "velocity_matches"),
        *("at_level", "grasped", "inside_site", "near_site", "touching"),
    }
    assert all(callable(registry.factory(name)) for name in named)


def test_an_unregistered_grounding_has_no_factory():
    assert registry.factory("on_objekt") is None
