from __future__ import annotations

import mujoco
import numpy as np
import pytest

from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.object_relation import HeuristicObjectRelation
from runtime.worlds.libero.proposers.placement import (
    TOUCH_M,
    UNBALANCED,
    Mover,
    Placement,
    Window,
    drop,
    rest_orientations,
)
from runtime.worlds.libero.proposers.source_joint_pose import HeuristicSourceJointPose
from runtime.worlds.libero.proposers.source_joint_residual import HeuristicSourceJointResidual
from tests.runtime.worlds.libero.proposers import conftest as scenes

pytestmark = pytest.mark.sim

TABLE_M, HALF_M = 0.42, 0.02
WINDOW = Window(0.41, 0.6, 0.6)


def origin(world, qpos, entity):
    return qpos[world.scene.qpos_slice(world.scene.free_joint(entity))][:3]


def mover(world):
    return Mover(Clearance(world.scene, world.qpos), "box_1")


def test_an_object_is_lowered_until_it_just_touches(world):
    (landing,) = drop(mover(world), Placement(-0.1, 0.0, np.eye(3), ""), WINDOW)
    height = origin(world, landing.qpos, "box_1")[2]
    assert 0.0 < TABLE_M + HALF_M - height < 1e-3
    clearance = Clearance(world.scene, landing.qpos)
    sunk = clearance.overlap(clearance.pairs(clearance.geom_mask(world.scene.bodies("box_1").tolist())))
    assert TOUCH_M / 2 < sunk <= TOUCH_M
    assert landing.flaws == 0


def test_what_lies_on_the_object_comes_along(world):
    offset = origin(world, world.qpos, "crumb_1") - origin(world, world.qpos, "box_1")
    (landing,) = drop(mover(world), Placement(-0.1, 0.0, np.eye(3), "here"), WINDOW)
    moved = origin(world, landing.qpos, "crumb_1") - origin(world, landing.qpos, "box_1")
    assert np.linalg.norm(moved) == pytest.approx(np.linalg.norm(offset), abs=1e-6)
    assert "carrying crumb_1" in landing.note


def test_an_object_over_the_edge_is_flawed(world):
    (landing,) = drop(mover(world), Placement(0.505, 0.0, np.eye(3), ""), WINDOW)
    assert landing.flaws & UNBALANCED


def test_nothing_lands_where_nothing_is_below(world):
    assert not list(drop(mover(world), Placement(0.7, 0.0, np.eye(3), ""), WINDOW))


def test_a_roof_gives_a_landing_above_and_one_below(world):
    landings = list(drop(mover(world), Placement(0.0, -0.4, np.eye(3), ""), WINDOW))
    heights = [origin(world, landing.qpos, "box_1")[2] for landing in landings]
    assert len(heights) == 2
    assert heights[0] == pytest.approx(0.54, abs=1e-3)
    assert heights[1] == pytest.approx(0.454, abs=1e-3)


def test_a_leaning_object_rests_upright(world):
    qpos = world.qpos.copy()
    where = world.scene.qpos_slice(world.scene.free_joint("block_1"))
    quat = np.zeros(4)
    mujoco.mju_axisAngle2Quat(quat, np.array([1.0, 0, 0]), 0.1)
    qpos[where.start + 3 : where.stop] = quat
    assert np.allclose(rest_orientations(world.scene, qpos, "block_1")[0][:, 2], [0, 0, 1])


def test_a_region_in_use_is_shared_without_touching_what_stands_there(world):
    """The block stands in the middle of the goal region."""
    proposal = HeuristicSourceJointPose(scenes.SCHEMA).propose(world.request(scenes.ON_TABLE))
    assert np.array_equal(origin(world, proposal.qpos, "block_1"), origin(world, world.qpos, "block_1"))
    assert scenes.deepest_new_overlap(world.model, world.qpos, proposal.qpos) < 1e-3


def test_half_a_region_over_the_edge_is_used_where_the_object_stands(world):
    edge = scenes.fact("On", "block_1", "table_edge_region", grounded_by="on_site")
    proposal = HeuristicSourceJointPose(scenes.SCHEMA).propose(world.request(edge))
    assert origin(world, proposal.qpos, "block_1")[0] < 0.5
    assert world.held_after(proposal, edge) == (True, True)


def test_two_objects_of_one_region_leave_each_other_room(world):
    facts = (
        scenes.fact("On", "box_1", "chest_1_top_side", grounded_by="on_site"),
        scenes.fact("On", "block_1", "chest_1_top_side", grounded_by="on_site"),
    )
    proposer = HeuristicObjectRelation(scenes.SCHEMA)
    first = proposer.propose(world.request(*facts, index=0))
    second = proposer.propose(world.request(*facts, index=1, qpos=first.qpos))
    assert world.observer(facts)(second.qpos).truth.tolist() == [True, True]
    assert np.array_equal(origin(world, second.qpos, "box_1"), origin(world, first.qpos, "box_1"))


@pytest.mark.parametrize("shift", np.linspace(0.0, 0.004, 9))
def test_no_plate_is_missed_wherever_the_descent_begins(world, shift):
    """The roof of the chest is 4 mm thick, and the descent goes in steps as wide."""
    window = Window(0.41, 0.6, 0.6 + shift)
    heights = [
        origin(world, c.qpos, "box_1")[2] for c in drop(mover(world), Placement(0.0, -0.4, np.eye(3), ""), window)
    ]
    assert heights == pytest.approx([0.54, 0.454], abs=1e-3)


@pytest.mark.parametrize("proposer", [HeuristicObjectRelation, HeuristicSourceJointResidual])
def test_an_object_that_must_leave_a_place_is_put_beside_it(world, proposer):
    start = HeuristicObjectRelation(scenes.SCHEMA).propose(world.request(scenes.ON_TRAY)).qpos
    request = world.request(scenes.OFF_TRAY, qpos=start)
    assert request.observe(start).truth[0]
    proposal = proposer(scenes.SCHEMA).propose(request)
    assert not request.observe(proposal.qpos).truth[0]
    assert np.linalg.norm(origin(world, proposal.qpos, "box_1") - origin(world, start, "box_1")) < 0.35
    assert scenes.deepest_new_overlap(world.model, start, proposal.qpos) < 1e-3


def test_an_object_too_tall_for_a_covered_region_is_laid_on_its_side(world):
    """The drawer's floor is 84 mm below the lid; the pole is 120 mm long."""
    fact = scenes.fact("In", "pole_1", "chest_1_drawer_region", grounded_by="in_site")
    close = scenes.CLOSE_DRAWER
    request = world.request(fact, close, qpos=world.slide(0.0))
    proposal = HeuristicObjectRelation(scenes.SCHEMA).propose(request)
    assert request.observe(proposal.qpos).truth.tolist() == [True, True]
    assert scenes.deepest_new_overlap(world.model, request.qpos, proposal.qpos) < 1e-3
    assert world.held_after(proposal, fact) == (True, True)


def test_an_object_has_six_sides_to_lie_on(world):
    sides = rest_orientations(world.scene, world.qpos, "pole_1")
    assert len(sides) == 6
    assert len({tuple(np.round(matrix[2]).tolist()) for matrix in sides}) == 6
