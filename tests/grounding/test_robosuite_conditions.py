"""What robosuite's success conditions are made of, on a small scene: robosuite is not needed."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grounding.scenes import Naming, Scene
from grounding.sim import SimGrounder
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom

XML = """
<mujoco>
  <worldbody>
    <body name="Table" pos="0 0 0.5">
      <geom name="slab" type="box" size="1 1 0.05" group="0"/>
      <site name="table_top" pos="0 0 0.05"/>
      <site name="table_box" type="box" size="0.1 0.2 0.05" pos="0.3 0.3 0.1"/>
    </body>
    <body name="Cube_main" pos="0 0 0.9">
      <freejoint/>
      <geom name="cube_g0" type="box" size="0.02 0.02 0.02" group="0"/>
    </body>
    <body name="hand" pos="0 0 0.9">
      <body name="left" pos="0 -0.04 0"><joint name="Left_Finger" type="slide" axis="0 1 0" range="0 0.04"/>
        <geom name="left_pad" type="box" size="0.01 0.01 0.01" group="0"/></body>
      <body name="right" pos="0 0.04 0"><joint name="right_finger" type="slide" axis="0 -1 0" range="0 0.04"/>
        <geom name="right_pad" type="box" size="0.01 0.01 0.01" group="0"/></body>
      <site name="grip"/>
    </body>
  </worldbody>
</mujoco>
"""
NAMING = Naming(
    roots={"table": "Table", "cube": "Cube_main"},
    joints={"hand_finger": ("Left_Finger",)},
    parts={"hand_left_fingerpad": ("left_pad",), "hand_right_fingerpad": ("right_pad",)},
)
SCHEMA = load_schema()
RS = "https://w3id.org/onto-evwm/robosuite#"
LEVEL, NEAR = (SCHEMA.predicates[RS + name].tolerance for name in ("at_level", "near"))


def fact(predicate, grounded_by, *names):
    entities = tuple(Entity(name, "") for name in names)
    return Fact(predicate, entities, NativeAtom(grounded_by, names), grounded_by)


FACTS = (
    fact(RS + "at_level", "at_level", "cube", "table_top"),
    fact(RS + "near", "near_site", "cube", "grip"),
    fact(RS + "touching", "touching", "cube", "table"),
    fact(RS + "grasped", "grasped", "cube", "hand"),
    fact("urn:inside", "inside_site", "cube", "table_box"),
)
SCENE = Scene(mujoco.MjModel.from_xml_string(XML), NAMING)
GROUNDER = SimGrounder(SCENE, FACTS, SCHEMA)


def seen(place, fingers=(0.0, 0.0)):
    data = mujoco.MjData(SCENE.model)
    data.qpos[:3] = place
    data.qpos[7:] = fingers
    mujoco.mj_forward(SCENE.model, data)
    observation = GROUNDER.observe(data)
    assert np.array_equal(GROUNDER.truth(data), observation.truth)
    names = (each.grounded_by for each in FACTS)
    return dict(zip(names, zip(observation.truth, observation.margin, strict=True), strict=True))


@given(st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(0.5, 1.2)))
@settings(max_examples=60, deadline=None)
def test_height_distance_and_box_are_their_formulas(place):
    found = seen(place)
    expected = {
        "at_level": 0.55 + LEVEL - place[2],
        "near_site": NEAR - math.dist(place, (0.0, 0.0, 0.9)),
        "inside_site": min(0.1 - abs(place[0] - 0.3), 0.2 - abs(place[1] - 0.3), 0.05 - abs(place[2] - 0.6)),
    }
    for name, margin in expected.items():
        assert found[name][1] == pytest.approx(margin, abs=1e-12)
        if abs(margin) > 1e-9:
            assert bool(found[name][0]) is (margin > 0)


def test_both_pads_make_a_grasp():
    closings = ((0, 0), (0.02, 0), (0, 0.02), (0.02, 0.02))
    held = [bool(seen((0, 0, 0.9), fingers)["grasped"][0]) for fingers in closings]
    assert held == [False, False, False, True]
    assert seen((0, 0, 0.9))["grasped"][1] == pytest.approx(-0.01, abs=1e-6)


def test_a_touch_has_the_depth_or_the_gap():
    assert seen((0.5, 0.5, 0.569))["touching"][0]
    assert seen((0.5, 0.5, 0.6))["touching"] == (False, pytest.approx(-0.03, abs=1e-6))


def test_names_are_the_worlds():
    assert SCENE.entities == ("table", "cube")
    assert [SCENE.model.joint(int(joint)).name for joint in SCENE.joints("hand_finger")] == ["Left_Finger"]
    with pytest.raises(OntoError) as raised:
        SimGrounder(SCENE, [fact(RS + "grasped", "grasped", "cube", "claw")], SCHEMA)
    assert raised.value.problems[0].code == "SIM001"
    with pytest.raises(OntoError) as raised:
        SimGrounder(SCENE, [fact(RS + "touching", "near_site", "cube", "grip")], SCHEMA)
    assert "has no tolerance" in raised.value.problems[0].message
