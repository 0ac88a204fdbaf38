"""A monitor says what grounding and diagnosis say, margins aside."""

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np
import pytest

from grounding.observation import Evidence
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import MAN
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from runtime.loop.monitor import GoalMonitor

XML = """
<mujoco>
  <worldbody>
    <body name="plate_1_main"><geom name="plate_1_g0" type="box" size="0.1 0.1 0.02" group="0"/></body>
    <body name="bowl_1_main" pos="0 0 0.2">
      <freejoint/><geom name="bowl_1_g0" type="sphere" size="0.03" group="0"/>
    </body>
    <body name="mug_1_main" pos="0 0.2 0.2">
      <freejoint/><geom name="mug_1_g0" type="sphere" size="0.03" group="0"/>
    </body>
  </worldbody>
</mujoco>
"""
MODEL = mujoco.MjModel.from_xml_string(XML)
SCENE = Scene(MODEL)
KNOWLEDGE = load_knowledge()

NOT_WATCHED = {"margin", "limit", "source", "precondition"}


def on(name, *, polarity=True, threshold=0.0):
    entities = (Entity(name, MAN + "Object"), Entity("plate_1", MAN + "Object"))
    return Fact(MAN + "on", entities, NativeAtom("On", (name, "plate_1")), "on_object", polarity, threshold)


GOALS = {
    "one": RequiredABox("one", "", "p", (on("bowl_1"),)),
    "two": RequiredABox("two", "", "p", (on("bowl_1"), on("mug_1"))),
    "denied": RequiredABox("denied", "", "p", (on("bowl_1", polarity=False), on("mug_1"))),
    "tolerant": RequiredABox("tolerant", "", "p", (on("bowl_1", threshold=-0.15), on("mug_1"))),
    "strict": RequiredABox("strict", "", "p", (on("bowl_1", threshold=0.0005), on("mug_1"))),
    "either": RequiredABox("either", "", "p", (on("bowl_1"), on("mug_1")), alternatives=((0,), (1,))),
}


def monitor(required, grounder=None):
    made = grounder or SimGrounder(SCENE, required.facts, KNOWLEDGE.schema)
    return GoalMonitor(required, made, KNOWLEDGE.tables)


def states():
    """Forwarded states with either object on the plate, near it, or away."""
    for bowl in (0.2, 0.06, 0.0499):
        for mug in (0.2, 0.0499):
            for aside in (0.0, 0.05):
                data = mujoco.MjData(MODEL)
                data.qpos[:3], data.qpos[7:10] = (0, aside, bowl), (0, aside - 0.06, mug)
                mujoco.mj_forward(MODEL, data)
                yield data


@pytest.mark.parametrize("name", GOALS)
def test_what_is_unmet_is_what_is_diagnosed(name):
    watched = monitor(GOALS[name])
    patterns = set()
    for _ in range(2):  # the second time from what was kept
        for data in states():
            found, diagnosed = watched.unmet(data), watched.diagnose(data)
            patterns.add(tuple(u.index for u in found))
            assert [dataclasses.asdict(u) for u in found] == [
                {k: v for k, v in dataclasses.asdict(d).items() if k not in NOT_WATCHED} for d in diagnosed
            ]
    assert len(patterns) > 1


def test_a_diagnosis_keeps_its_margin_and_step():
    (data, *_) = states()
    (bowl, mug) = monitor(GOALS["two"]).diagnose(data, step=3)
    assert np.isfinite([bowl.margin, mug.margin]).all()
    assert (bowl.source, bowl.limit) == ("sim", "contact")


def test_a_grounding_function_without_a_plan_may_contradict_its_own_margin():
    """Such a fact is violated, not false, and only its margin says so."""

    class Odd(SimGrounder):
        def __init__(self):
            super().__init__(SCENE, GOALS["one"].facts, KNOWLEDGE.schema)
            self._groundings = (lambda _: Evidence(truth=True, margin=-1.0),)

    (data, *_) = states()
    watched = monitor(GOALS["one"], Odd())
    (found,) = watched.unmet(data)
    assert found.truth
    assert found.status == watched.diagnose(data)[0].status
