"""Where objects come to rest, and the grasps that fit them there, in LIBERO's scenes."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from tests.runtime.worlds.libero.skills.stages import staged

pytestmark = pytest.mark.sim

UP = np.array([0.0, 0.0, 1.0])


def spots_by_turns(stage):
    """For each set of turns that a transfer tries together, the spots."""
    from runtime.worlds.libero.skills.place import spots
    from runtime.worlds.libero.skills.transfer import _turns

    world, place, holds = stage.world, stage.place(), stage.holds()
    return [[s for turn in turns for s in spots(world, place, turn, holds)] for turns in _turns(world, place)]


def test_the_bottle_lies_along_the_slope_of_the_rack_with_its_fact_true():
    stage = staged("libero_goal", 9)
    found = spots_by_turns(stage)[0]
    site = stage.world.site_pose(stage.place().site).rotation
    body = stage.world.pose("wine_bottle_1").rotation
    long = np.argmax(np.abs(body[2]))
    assert abs(site[2, 2]) < 0.9  # the rack slopes
    assert len(found) >= 20
    for spot in found:
        assert abs(spot.pose.rotation[:, long] @ site[:, 2]) > 0.999
        assert np.array_equal(spot.entry, UP)
    holds = stage.holds()
    assert all(holds(spot.pose.moved(-0.001 * UP)) for spot in found[:20])


def test_what_goes_into_a_compartment_is_first_aligned_with_its_sides():
    stage = staged("libero_10", 5)
    found = spots_by_turns(stage)[0]
    site = stage.world.site_pose(stage.place().site).rotation
    assert len(found) >= 20
    body = stage.world.pose("black_book_1").rotation
    assert np.abs(site.T @ body).max(axis=1).min() < 0.9  # it does not lie so yet
    for spot in found:
        axes = np.abs(site.T @ spot.pose.rotation)
        assert axes.max(axis=1) == pytest.approx(np.ones(3), abs=1e-3)


def test_what_is_too_tall_to_stand_in_a_drawer_is_laid_down():
    stage = staged("libero_90", 32)
    *standing, lying = spots_by_turns(stage)
    assert not any(standing)
    assert len(lying) >= 20
    world = stage.world
    body = world.pose("ketchup_1")
    upright = np.ptp((world.cloud("ketchup_1") - body.position)[:, 2])
    for spot in lying[:: len(lying) // 10]:
        local = (world.cloud("ketchup_1") - body.position) @ body.rotation @ spot.pose.rotation.T
        assert np.ptp(local[:, 2]) < 0.6 * upright


def test_the_mug_enters_the_microwave_from_sides_that_are_open_and_never_from_above():
    stage = staged("libero_10", 9)
    found = spots_by_turns(stage)[0]
    assert len(found) >= 5
    assert all(abs(spot.entry[2]) < 1e-9 for spot in found)
    holds = stage.holds()
    assert all(holds(spot.pose.moved(-0.001 * UP)) for spot in found)
    world, place = stage.world, stage.place()
    region, half = world.site_pose(place.site), world.site_half(place.site)
    for spot in found:
        assert (np.abs(region.rotation.T @ (spot.pose.position - region.position)) <= half + 0.01).all()
        assert spot.before[:2] @ spot.entry[:2] > 0.17  # the hand stands outside before it


@pytest.mark.parametrize(
    ("suite", "index", "entity"), [("libero_goal", 8, "akita_black_bowl_1"), ("libero_90", 32, "ketchup_1")]
)
def test_a_planned_grasp_and_release_run_into_nothing(suite, index, entity):
    """By a collision check of its own: neither the robot nor what it holds lies in anything else."""
    from runtime.worlds.libero.skills.reach import Reach
    from runtime.worlds.libero.skills.transfer import transfers

    stage = staged(suite, index)
    world = stage.world
    reach = Reach(world)
    plans = list(islice(transfers(world, reach, stage.place(), stage.holds()), 2))
    assert plans
    for plan in plans:
        body, aperture = world.pose(entity), 0.5 * plan.grasp.width + 0.002
        local = plan.grasp.pose.inverse() @ body
        grasp = reach.solve(plan.grasp.pose, reach.begin())
        assert deepest(stage, grasp.joints, entity, body, 0.04, held=False) > -2.1e-3
        released = plan.spot.pose.moved(plan.release * UP)
        hand = released @ local.inverse()
        reach.begin()
        at = reach.solve(hand, grasp.joints, held=(entity, local), aperture=aperture)
        assert max(grasp.position_error, at.position_error) < 6e-3
        assert deepest(stage, at.joints, entity, released, aperture, held=True) > -2.1e-3


def deepest(stage, joints, entity, pose, aperture, *, held):
    """The least distance (m) between the robot, with what it holds, and everything else."""
    import mujoco

    model, index, arm = stage.sim.model, stage.player.scene.index, stage.player.scene.arm
    data = mujoco.MjData(model)
    data.qpos[:] = stage.sim.data.qpos
    data.qpos[arm.qpos] = joints
    data.qpos[model.jnt_qposadr[model.actuator_trnid[arm.fingers, 0]]] = (aperture, -aperture)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(pose.rotation).ravel())
    data.qpos[index.qpos_slice(index.free_joint(entity))] = [*pose.position, *quat]
    mujoco.mj_fwdPosition(model, data)
    ours = stage.player.shapes.robot[model.geom_bodyid]
    ours[index.contact_geoms(entity)] |= held
    pairs = data.contact.geom
    return data.contact.dist[ours[pairs[:, 0]] != ours[pairs[:, 1]]].min(initial=0.0)
