"""What holds of every proposal, whichever proposer makes it, in small scenes."""

from __future__ import annotations

import numpy as np
import pytest

from runtime.worlds.libero.proposers.object_relation import HeuristicObjectRelation
from runtime.worlds.libero.proposers.rack_contact import HeuristicRackContact
from runtime.worlds.libero.proposers.source_joint_pose import HeuristicSourceJointPose
from runtime.worlds.libero.proposers.source_joint_residual import HeuristicSourceJointResidual
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim

CASES = {
    "joint to open": (HeuristicSourceJointPose, scenes.OPEN_DRAWER, 0.0),
    "joint to close": (HeuristicSourceJointPose, scenes.CLOSE_DRAWER, 0.12),
    "object to a table region": (HeuristicSourceJointPose, scenes.ON_TABLE, 0.0),
    "object on an object": (HeuristicObjectRelation, scenes.ON_TRAY, 0.0),
    "object on a fixture": (HeuristicObjectRelation, scenes.ON_CHEST, 0.0),
    "object in a closed drawer": (HeuristicObjectRelation, scenes.IN_DRAWER, 0.0),
    "object in an open drawer": (HeuristicObjectRelation, scenes.IN_DRAWER, 0.19),
    "object on a rack": (HeuristicRackContact, scenes.ON_RACK, 0.0),
    "search for a joint": (HeuristicSourceJointResidual, scenes.OPEN_DRAWER, 0.1),
    "search for a region": (HeuristicSourceJointResidual, scenes.ON_TABLE, 0.0),
    "search for a relation": (HeuristicSourceJointResidual, scenes.ON_TRAY, 0.0),
}


@pytest.fixture(scope="module", params=CASES, ids=lambda name: name.replace(" ", "-"))
def case(request, world):
    proposer, fact, slide = CASES[request.param]
    return proposer(scenes.SCHEMA), fact, world.slide(slide)


@pytest.fixture(scope="module")
def first(case, world):
    """The first candidate."""
    proposer, fact, qpos = case
    return proposer.propose(world.request(fact, qpos=qpos))


def test_eleven_cases_are_covered():
    assert len(CASES) == 11
    assert len({proposer for proposer, _, _ in CASES.values()}) == 4


def test_a_proposal_satisfies_its_fact_and_lasts(case, first, world):
    _, fact, qpos = case
    assert not world.request(fact, qpos=qpos).observe(qpos).truth[0]
    assert world.held_after(first, fact) == (True, True)


def test_only_the_listed_addresses_change(case, first):
    assert first.changed
    assert np.array_equal(np.flatnonzero(first.qpos != case[2]), first.changed)


def test_joints_stay_in_their_range_and_quaternions_are_normalised(first, world):
    slide = first.qpos[world.model.joint("chest_1_slide").qposadr[0]]
    assert -0.01 <= slide <= 0.2
    free = world.scene.qpos_slice(world.scene.free_joint("box_1"))
    assert np.linalg.norm(first.qpos[free][3:]) == pytest.approx(1.0, abs=1e-9)


def test_nothing_sinks_in_deeper_than_a_millimetre(case, first, world):
    assert scenes.deepest_new_overlap(world.model, case[2], first.qpos) < 1e-3


def test_the_same_request_gives_the_same_proposal_and_is_left_as_it_was(case, first, world):
    proposer, fact, qpos = case
    request = world.request(fact, qpos=qpos)
    before = request.qpos.copy()
    again = proposer.propose(request)
    assert np.array_equal(again.qpos, first.qpos)
    assert (again.changed, again.note, again.candidate) == (first.changed, first.note, first.candidate)
    assert np.array_equal(request.qpos, before)


def test_the_next_candidate_is_another_one(case, first, world):
    proposer, fact, qpos = case
    second = proposer.propose(world.request(fact, qpos=qpos, candidate=1))
    assert (first.candidate, second.candidate) == (0, 1)
    assert not np.array_equal(first.qpos, second.qpos)


def test_candidates_run_out(case, world):
    proposer, fact, qpos = case
    assert proposer.propose(world.request(fact, qpos=qpos, candidate=100_000)) is None


@pytest.mark.parametrize(
    ("proposer", "fact"),
    [
        (HeuristicObjectRelation, scenes.OPEN_DRAWER),
        (HeuristicRackContact, scenes.ON_TRAY),
        (HeuristicRackContact, scenes.OPEN_DRAWER),
        (HeuristicSourceJointPose, scenes.fact("On", "chest_1", "table_goal_region", grounded_by="placed_in_region")),
    ],
)
def test_a_proposer_has_nothing_for_a_fact_outside_its_coordinates(proposer, fact, world):
    assert proposer(scenes.SCHEMA).propose(world.request(fact)) is None
