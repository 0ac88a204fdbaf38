from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.schema import JointThreshold
from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.joints import end_values, moved, side_values
from runtime.worlds.libero.proposers.object_relation import HeuristicObjectRelation
from runtime.worlds.libero.proposers.source_joint_pose import HeuristicSourceJointPose
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim


@given(st.booleans(), st.booleans(), st.floats(-2, 2), st.floats(-2, 0), st.floats(0.01, 2))
def test_values_lie_on_the_asked_side_and_in_the_range(above, polarity, bound, low, width):
    threshold = JointThreshold("t#x", "c", "Open", above, bound, False, False, "m")
    values = list(side_values(threshold, (low, low + width), polarity))
    side = [v > bound if above == polarity else v < bound for v in values]
    reachable = (low + width > bound) if above == polarity else (low < bound)
    assert all(side)
    assert all(low <= v <= low + width for v in values)
    assert bool(values) == reachable


def test_a_joint_without_limits_gets_values_near_its_bound():
    threshold = JointThreshold("t#x", "c", "Turnon", True, 0.5, True, False, "rad")
    values = list(side_values(threshold, None, True))
    assert len(values) == 5
    assert all(0.5 < v < 1.0 for v in values)


def test_the_farther_end_of_a_range_comes_first():
    assert end_values((0.0, 1.0), 0.1) == pytest.approx((0.98, 0.02))
    assert end_values((0.0, 1.0), 0.9) == pytest.approx((0.02, 0.98))


def in_open_drawer(world):
    request = world.request(scenes.IN_DRAWER, qpos=world.slide(0.19))
    return HeuristicObjectRelation(scenes.SCHEMA).propose(request).qpos


def test_a_closing_drawer_takes_along_what_lies_in_it(world):
    start = in_open_drawer(world)
    facts = (scenes.CLOSE_DRAWER, scenes.IN_DRAWER)
    proposal = HeuristicSourceJointPose(scenes.SCHEMA).propose(world.request(*facts, qpos=start))
    assert world.observer(facts)(proposal.qpos).truth.tolist() == [True, True]
    assert "carrying box_1" in proposal.note
    assert scenes.deepest_new_overlap(world.model, start, proposal.qpos) < 1e-3


def test_a_joint_moves_alone_when_nothing_rests_on_it(world):
    joint = world.model.joint("chest_1_slide").id
    qpos, carried, depth = moved(Clearance(world.scene, world.qpos), joint, 0.1)
    assert carried == ()
    assert depth <= 0.0
    assert np.flatnonzero(qpos != world.qpos).tolist() == [int(world.model.jnt_qposadr[joint])]


def test_a_drawer_that_must_stay_closed_is_filled_and_put_back(world):
    qpos = world.slide(0.0)
    facts = (scenes.IN_DRAWER, scenes.CLOSE_DRAWER)
    proposal = HeuristicObjectRelation(scenes.SCHEMA).propose(world.request(*facts, qpos=qpos))
    assert world.observer(facts)(proposal.qpos).truth.tolist() == [True, True]
    assert proposal.note.endswith("and back")
    assert proposal.qpos[world.model.joint("chest_1_slide").qposadr[0]] == pytest.approx(0.0)


def test_a_drawer_is_opened_when_nothing_asks_for_it_closed(world):
    proposal = HeuristicObjectRelation(scenes.SCHEMA).propose(world.request(scenes.IN_DRAWER, qpos=world.slide(0.0)))
    assert "chest_1_slide moved to" in proposal.note
    assert int(world.model.joint("chest_1_slide").qposadr[0]) in proposal.changed
