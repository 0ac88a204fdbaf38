"""Small scenes in LIBERO's naming, and requests about them."""

from __future__ import annotations

from itertools import combinations

import mujoco
import numpy as np
import pytest

from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from onto_compiler.schema import JointThreshold, Schema
from runtime.loop.proposer import Request
from runtime.loop.records import Diagnosis

WORLD = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <body name="table" pos="0 0 0.4">
      <geom name="table_collision" type="box" size="0.5 0.5 0.02"/>
      <site name="table_goal_region" type="box" pos="0.1 0.2 0.015" size="0.03 0.03 0.007"/>
      <site name="table_edge_region" type="box" pos="0.5 0.3 0.015" size="0.03 0.03 0.007"/>
    </body>
    <body name="box_1_main" pos="-0.2 -0.2 0.44">
      <freejoint name="box_1_joint0"/>
      <geom name="box_1_g0" type="box" size="0.03 0.02 0.02"/>
    </body>
    <body name="crumb_1_main" pos="-0.2 -0.2 0.465">
      <freejoint name="crumb_1_joint0"/>
      <geom name="crumb_1_g0" type="box" size="0.005 0.005 0.005"/>
    </body>
    <body name="tray_1_main" pos="0.2 -0.2 0.42">
      <freejoint name="tray_1_joint0"/>
      <geom name="tray_1_g0" type="box" size="0.1 0.07 0.004" pos="0 0 0.004"/>
      <geom name="tray_1_g1" type="box" size="0.004 0.07 0.01" pos="0.1 0 0.01"/>
      <geom name="tray_1_g2" type="box" size="0.004 0.07 0.01" pos="-0.1 0 0.01"/>
    </body>
    <body name="block_1_main" pos="0.1 0.2 0.44">
      <freejoint name="block_1_joint0"/>
      <geom name="block_1_g0" type="box" size="0.01 0.01 0.02"/>
    </body>
    <body name="pole_1_main" pos="-0.35 -0.3 0.48">
      <freejoint name="pole_1_joint0"/>
      <geom name="pole_1_g0" type="box" size="0.012 0.015 0.06"/>
    </body>
    <body name="chest_1_main" pos="0 -0.4 0.42">
      <geom name="chest_1_g0" type="box" size="0.1 0.08 0.002" pos="0 0 0.002"/>
      <geom name="chest_1_g1" type="box" size="0.1 0.08 0.002" pos="0 0 0.098"/>
      <geom name="chest_1_g2" type="box" size="0.1 0.002 0.05" pos="0 -0.08 0.05"/>
      <site name="chest_1_top_side" type="box" pos="0 0 0.1" size="0.1 0.08 0.002"/>
      <body name="chest_1_drawer">
        <joint name="chest_1_slide" type="slide" axis="0 1 0" range="-0.01 0.2" limited="true" damping="1"/>
        <geom name="chest_1_g3" type="box" size="0.09 0.07 0.002" pos="0 0.004 0.012"/>
        <geom name="chest_1_g4" type="box" size="0.09 0.002 0.02" pos="0 0.076 0.034"/>
        <geom name="chest_1_g5" type="box" size="0.09 0.002 0.02" pos="0 -0.066 0.034"/>
        <site name="chest_1_drawer_region" type="box" pos="0 0.004 0.044" size="0.08 0.06 0.03"/>
      </body>
    </body>
    <body name="rack_1_main" pos="-0.3 0.25 0.42">
      <geom name="rack_1_g0" type="box" size="0.08 0.1 0.004" pos="0 0 0.08" euler="25 0 0"/>
      <geom name="rack_1_g1" type="box" size="0.08 0.004 0.06" pos="0 0 0.03"/>
      <site name="rack_1_top_region" type="box" pos="0 0 0.085" size="0.06 0.06 0.004"/>
    </body>
  </worldbody>
</mujoco>
"""

OPEN = JointThreshold("t#chest_open", "chest", "Open", True, 0.15, False, False, "m")
CLOSE = JointThreshold("t#chest_close", "chest", "Close", False, 0.005, False, True, "m")
SCHEMA = Schema({}, {}, {}, {}, (), {("chest", "Open"): OPEN, ("chest", "Close"): CLOSE}, {}, {}, {})


def fact(native, *names, grounded_by, threshold=None, polarity=True):
    """A fact whose typed arguments are the native ones, or a joint threshold's."""
    arguments = tuple(Entity(name, "t#Entity") for name in names)
    if threshold is not None:
        arguments += (Entity("threshold", threshold.iri),)
    return Fact("t#predicate", arguments, NativeAtom(native, names), grounded_by, polarity)


ON_TABLE = fact("On", "box_1", "table_goal_region", grounded_by="on_site")
ON_TRAY = fact("On", "box_1", "tray_1", grounded_by="on_object")
OFF_TRAY = fact("On", "box_1", "tray_1", grounded_by="on_object", polarity=False)
ON_CHEST = fact("On", "box_1", "chest_1_top_side", grounded_by="on_site")
IN_DRAWER = fact("In", "box_1", "chest_1_drawer_region", grounded_by="in_site")
ON_RACK = fact("On", "box_1", "rack_1_top_region", grounded_by="on_site")
OPEN_DRAWER = fact("Open", "chest_1_drawer_region", grounded_by="joint_threshold", threshold=OPEN)
CLOSE_DRAWER = fact("Close", "chest_1_drawer_region", grounded_by="joint_threshold", threshold=CLOSE)


class World:
    """The scene, a state that has settled, and the grounder as the loop offers it to proposers."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_string(WORLD)
        self.scene = Scene(self.model)
        self.qpos = self.settled(self.model.qpos0, 200)

    def settled(self, qpos, steps):
        """``qpos`` after ``steps`` simulated steps, from rest."""
        data = mujoco.MjData(self.model)
        data.qpos[:] = qpos
        mujoco.mj_forward(self.model, data)
        mujoco.mj_step(self.model, data, nstep=steps)
        return data.qpos

    def slide(self, value):
        """The settled state with the drawer elsewhere."""
        qpos = self.qpos.copy()
        qpos[self.model.joint("chest_1_slide").qposadr[0]] = value
        return qpos

    def observer(self, facts):
        grounder, scratch = SimGrounder(self.scene, facts, SCHEMA), mujoco.MjData(self.model)

        def observe(qpos):
            scratch.qpos[:] = qpos
            mujoco.mj_forward(self.model, scratch)
            return grounder.observe(scratch)

        return observe

    def request(self, *facts, index=0, candidate=0, qpos=None):
        """Ask for ``facts[index]`` while ``facts`` are all required."""
        qpos = self.qpos if qpos is None else qpos
        observe = self.observer(facts)
        seen = observe(qpos)
        diagnosis = Diagnosis(
            facts[index], index, "f", "s", bool(seen.truth[index]), float(seen.margin[index]), "", "sim", "r", 10
        )
        required = RequiredABox("task", "do it", "problem", tuple(facts))
        rng = np.random.default_rng(0)
        return Request(self.scene, qpos, np.zeros(self.model.nv), required, diagnosis, candidate, observe, rng)

    def held_after(self, proposal, fact, steps=500):
        """Whether ``fact`` holds right after ``proposal`` was written, and still after ``steps`` simulated steps."""
        observe = self.observer((fact,))
        then = self.settled(proposal.qpos, steps)
        return bool(observe(proposal.qpos).truth[0]), bool(observe(then).truth[0])


def deepest_new_overlap(model, before, after):
    """The largest growth (m) of any overlap between two geoms of different bodies from state ``before`` to ``after``.

    Measured pair by pair: contacts understate an overlap of two boxes, and may miss it.
    """
    pairs = [
        (g, h)
        for g, h in combinations(range(model.ngeom), 2)
        if model.body_weldid[model.geom_bodyid[g]] != model.body_weldid[model.geom_bodyid[h]]
        and (model.geom_contype[g] & model.geom_conaffinity[h] or model.geom_contype[h] & model.geom_conaffinity[g])
    ]
    depths = []
    for qpos in (before, after):
        data = mujoco.MjData(model)
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        depths.append(np.array([-min(mujoco.mj_geomDistance(model, data, g, h, 0.0, None), 0.0) for g, h in pairs]))
    return float(np.max(depths[1] - depths[0]))


@pytest.fixture(scope="session")
def world():
    """One for all tests, since nothing changes it."""
    return World()
