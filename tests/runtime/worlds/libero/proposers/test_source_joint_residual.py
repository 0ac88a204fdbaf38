from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.worlds.libero.proposers.source_joint_residual import HeuristicSourceJointResidual, compass
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_the_search_comes_within_its_smallest_step_of_a_peak(x, y):
    seen = []

    def value(point):
        seen.append(point)
        return -float(np.abs(point - [x, y]).sum())

    compass(value, np.array([0.2, 0.2]), evaluations=400)
    assert min(np.abs(point - [x, y]).max() for point in seen) <= 0.02
    assert len(seen) <= 400


def test_the_search_keeps_to_its_number_of_evaluations():
    seen = []
    compass(lambda point: seen.append(point) or float(point.sum()), np.array([1.0, 1.0, 1.0]), evaluations=17)
    assert len(seen) == 17


def test_joints_that_must_all_pass_are_moved_together():
    """The smallest margin of two joints grows only when both move."""
    best = []
    compass(lambda point: best.append(float(point.min())) or best[-1], np.array([0.1, 0.1]))
    assert max(best) > 0.1


def test_the_rejected_state_itself_is_not_offered(world):
    request = world.request(scenes.OPEN_DRAWER, qpos=world.slide(0.16))
    assert request.observe(request.qpos).truth[0]
    proposals = HeuristicSourceJointResidual(scenes.SCHEMA).candidates(request)
    states = [candidate.qpos for candidate in proposals]
    assert states
    assert not any(np.array_equal(qpos, request.qpos) for qpos in states)


def test_a_near_miss_is_corrected_by_about_the_residual(world):
    """The box lies 4 mm beside the region; the search does not carry it across the table."""
    qpos = world.qpos.copy()
    where = world.scene.qpos_slice(world.scene.free_joint("block_1"))
    qpos[where.start] = 0.1 + 0.03 + 0.004
    fact = scenes.fact("On", "block_1", "table_goal_region", grounded_by="on_site")
    request = world.request(fact, qpos=qpos)
    assert not request.observe(qpos).truth[0]
    proposal = HeuristicSourceJointResidual(scenes.SCHEMA).propose(request)
    moved = np.linalg.norm(proposal.qpos[where][:2] - qpos[where][:2])
    assert 0.004 < moved < 0.06
    assert world.held_after(proposal, fact) == (True, True)


def test_a_fact_without_joints_or_a_movable_object_has_no_candidate(world):
    fact = scenes.fact("On", "rack_1", "table_goal_region", grounded_by="placed_in_region")
    assert HeuristicSourceJointResidual(scenes.SCHEMA).propose(world.request(fact)) is None
