"""Predicates of motion in the plane, held to the published success and to MuJoCo's own distances."""

import math
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from grounding.predicates.planar import apart, clearance
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.bddl import lift, parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.rdf import NAV
from onto_compiler.required import Entity, Fact, NativeAtom

pytestmark = pytest.mark.sim

XML = """
<mujoco>
  <size nuserdata="6"/>
  <custom><numeric name="goal_state" data="2"/><numeric name="late_state" data="3"/></custom>
  <worldbody>
    <body name="ball_main" pos="3 -1 0">
      <joint name="x" type="slide" axis="1 0 0"/> <joint name="y" type="slide" axis="0 1 0"/>
      <geom name="ball_g0" type="sphere" size="0.1"/>
    </body>
    <body name="goal_main"/> <body name="late_main"/> <body name="lost_main"/>
    <body name="wall_main" pos="3 -1 0">
      <geom name="w0" type="box" size="0.5 0.5 0.2" pos="1 0 0"/>
      <geom name="w1" type="box" size="0.5 1 0.2" pos="-2 0 0"/>
    </body>
    <body name="cart_main"><joint name="c" type="slide" axis="0 1 0"/><geom name="c0" size="0.1"/></body>
    <body name="log_main">
      <joint name="lx" type="slide" axis="1 0 0"/> <joint name="ly" type="slide" axis="0 1 0"/>
      <geom name="log_g0" type="capsule" size="0.1 0.2"/>
    </body>
  </worldbody>
</mujoco>
"""
MODEL = mujoco.MjModel.from_xml_string(XML)
SCENE = Scene(MODEL)
SCHEMA = load_schema()
COORDINATE = st.floats(-4, 4)


def fact(name, first="ball", second="goal"):
    arguments = (Entity(first, NAV + "Ball"), Entity(second, NAV + "Target"))
    return Fact(NAV + name, arguments, NativeAtom(name, (first, second)), name)


GROUNDER = SimGrounder(SCENE, [fact("at_target"), fact("velocity_matches"), fact("free_of", second="wall")], SCHEMA)


def observed(state, goal):
    data = mujoco.MjData(MODEL)
    data.qpos[:2], data.qvel[:2] = state[:2], state[2:]
    data.userdata[2:] = goal
    mujoco.mj_kinematics(MODEL, data)
    return data, GROUNDER.observe(data)


@settings(deadline=None)
@given(state=st.tuples(*[COORDINATE] * 4), goal=st.tuples(*[COORDINATE] * 4))
def test_truth_is_the_published_success_and_the_sign_of_the_margin(state, goal):
    _, found = observed(state, goal)
    state, goal = np.array(state), np.array(goal)
    assert found.truth[0] == (np.linalg.norm(goal[:2] - state[:2]) < 0.5)
    assert found.truth[1] == (np.linalg.norm(goal[2:] - state[2:]) < 0.5)
    assert (found.truth == (found.margin > 0)).all()
    assert found.limit == ("distance", "velocity", "clearance")


@settings(deadline=None)
@given(goal=st.tuples(COORDINATE, COORDINATE), angle=st.floats(0, 2 * math.pi), steps=st.integers(-9, 9))
@example(goal=(0.0, 0.0), angle=0.0, steps=0)
@example(goal=(0.0, 0.0), angle=0.0, steps=-1)
@example(goal=(0.0, 0.0), angle=0.0, steps=-3)
@example(goal=(1.0, 0.0), angle=1.8619555613814174, steps=0)
def test_truth_is_the_published_success_at_the_edge_of_the_target(goal, angle, steps):
    radius = 0.5
    for _ in range(abs(steps)):
        radius = math.nextafter(radius, math.inf * steps)
    state = (goal[0] + radius * math.cos(angle), goal[1] + radius * math.sin(angle), 0.0, 0.0)
    _, found = observed(state, (*goal, 0.0, 0.0))
    assert found.truth[0] == (np.linalg.norm(np.array(goal) - np.array(state[:2])) < 0.5)
    assert found.truth[0] == (found.margin[0] > 0)


def test_exactly_at_the_edge_is_not_at_the_target():
    _, found = observed((0.5, 0, 0, 0), (0, 0, 0, 0))
    assert (found.truth[0], found.margin[0]) == (False, 0.0)


@settings(deadline=None)
@given(x=COORDINATE, y=COORDINATE)
def test_clearance_is_mujocos_distance_to_the_nearest_box(x, y):
    data, found = observed((x, y, 0, 0), (0, 0, 0, 0))
    ball = MODEL.geom("ball_g0").id
    nearest = min(mujoco.mj_geomDistance(MODEL, data, ball, MODEL.geom(box).id, 20.0, None) for box in ("w0", "w1"))
    margin = found.margin[2]
    if margin > 0.08 - 0.1:  # the centre is in no box
        assert margin == pytest.approx(0.08 + nearest, abs=1e-6)
    else:
        assert not found.truth[2]
        assert nearest < -0.08


def test_within_a_box_the_clearance_is_the_way_out():
    boxes = np.array([[0.0, 0.0, 2.0, 1.0], [2.0, 0.0, 3.0, 1.0]])
    points = np.array([[0.3, 0.5], [1.0, 0.9], [-3.0, -4.0], [2.0, 1.5]])
    assert clearance(points, boxes).tolist() == pytest.approx([-0.3, -0.1, 5.0, 0.5])
    assert apart(points[None], points[:, None]).shape == (4, 4)


@pytest.mark.parametrize(
    ("wrong", "code", "said"),
    [
        (fact("at_target", "nobody"), "SIM001", "nobody"),
        (fact("at_target", second="lost"), "SIM006", "no state of `lost`"),
        (fact("velocity_matches", second="late"), "SIM006", "no state of `late`"),
        (fact("at_target", "cart"), "SIM006", "`cart` does not"),
        (fact("velocity_matches", "cart"), "SIM006", "`cart` does not"),
        (fact("free_of", "log", "wall"), "SIM006", "`log` and `wall` are not"),
        (fact("free_of", "ball", "cart"), "SIM006", "`ball` and `cart` are not"),
    ],
)
def test_what_cannot_be_grounded_is_refused(wrong, code, said):
    with pytest.raises(OntoError) as caught:
        SimGrounder(SCENE, [wrong], SCHEMA)
    [problem] = caught.value.problems
    assert problem.code == code
    assert said in problem.message


def test_a_predicate_without_a_tolerance_is_refused_at_its_place_in_the_task(tmp_path):
    turtle, task = tmp_path / "lab.ttl", tmp_path / "task.bddl"
    turtle.write_text(
        f"""@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix nav: <{NAV}> .
        @prefix skos: <http://www.w3.org/2004/02/skos/core#> . @prefix my: <https://example.org/my#> .
        my:near a nav:TargetRelation ; skos:notation "near" ; core:arity 2 ;
            core:domain nav:Agent ; core:range nav:Target .
        my:lift a core:Binding ; core:native "Near" ; core:nativeDomain "pointmaze" ; core:order 10 ;
            core:nativeArgument1 nav:Agent ; core:nativeArgument2 nav:Target ; core:lifts my:near ;
            core:groundedBy "at_target" ."""
    )
    task.write_text(
        "(define (problem p) (:domain pointmaze) (:language Go) (:fixtures goal - target) (:objects ball - ball)\n"
        " (:init) (:goal (And (Near ball goal))))"
    )
    schema = load_schema(turtle)
    required, _ = lift(parse_file(task), schema, "task")
    with pytest.raises(OntoError) as caught:
        SimGrounder(SCENE, required.facts, schema)
    [problem] = caught.value.problems
    assert (problem.code, Path(problem.file), problem.line, problem.column) == ("SIM006", task, 2, 22)
    assert "core:tolerance" in problem.hint
