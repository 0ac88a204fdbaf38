"""Motions arrive where they are sent, and inverse kinematics knows which places those are."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.runtime.worlds.libero.skills.stages import staged

pytestmark = pytest.mark.sim

numbers = st.floats(-1.0, 1.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


@pytest.fixture
def stage():
    return staged("libero_goal", 8)


def carried_out(stage, motion):
    """How many steps the motion took, and what it returned."""
    steps = 0
    while True:
        try:
            action = next(motion)
        except StopIteration as end:
            return steps, end.value
        stage.sim.step(action)
        steps += 1


@given(vectors, vectors, vectors, st.floats(0.1, 1.0))
def test_an_action_points_along_the_straight_way_and_keeps_to_its_speed(here, there, twist, speed):
    from runtime.worlds.libero.skills.frames import Pose, axis_angle
    from runtime.worlds.libero.skills.motion import action_towards

    size = np.linalg.norm(twist)
    rotation = axis_angle(twist / size, size) if size > 1e-6 else np.eye(3)
    action = action_towards(SimpleNamespace(eef=Pose(here, np.eye(3))), Pose(there, rotation), 1.0, speed)
    assert np.abs(action[:6]).max(initial=0.0) <= speed + 1e-9
    assert action[6] == 1.0
    way = there - here
    assert np.linalg.norm(np.cross(action[:3], way)) <= 1e-9
    assert action[:3] @ way >= 0.0
    assert np.linalg.norm(np.cross(action[3:6], twist)) <= 1e-6


OFFSETS = [(0.0, 0.0, 0.1), (0.1, -0.1, -0.05), (-0.1, 0.15, 0.05), (0.05, 0.2, 0.0)]


@pytest.mark.parametrize("offset", OFFSETS)
def test_a_pose_that_can_be_reached_is_reached(stage, offset):
    from runtime.worlds.libero.skills.frames import Pose, axis_angle
    from runtime.worlds.libero.skills.motion import OPEN, reach
    from runtime.worlds.libero.skills.reach import Reach

    world = stage.world
    goal = Pose(world.eef.position + offset, axis_angle(np.array([0.0, 0.0, 1.0]), 0.4) @ world.eef.rotation)
    solver = Reach(world)
    before = stage.sim.data.qpos.copy()
    assert solver.solve(goal, solver.begin()).feasible
    assert np.array_equal(stage.sim.data.qpos, before)  # on a copy
    _, arrived = carried_out(stage, reach(world, goal, OPEN))
    assert arrived
    assert np.linalg.norm(world.eef.position - goal.position) < 0.006


def test_a_pose_out_of_reach_or_within_the_table_is_not_feasible(stage):
    from runtime.worlds.libero.skills.frames import Pose
    from runtime.worlds.libero.skills.motion import OPEN, reach
    from runtime.worlds.libero.skills.reach import Reach

    world = stage.world
    solver = Reach(world)
    far = world.eef.moved(np.array([0.9, 0.0, 0.0]))
    at = solver.solve(far, solver.begin())
    assert at.position_error > 0.05
    assert not at.feasible
    plate = world.pose("plate_1").position
    low = Pose(plate - [0.0, 0.0, 0.02], world.eef.rotation)
    at = solver.solve(low, solver.begin())
    assert at.penetration > 0.002
    assert not at.feasible
    steps, arrived = carried_out(stage, reach(world, far, OPEN))
    assert not arrived
    assert steps < 80  # it gives up where it makes no progress


def test_fingers_close_until_they_stand_still_and_open_again(stage):
    from runtime.worlds.libero.skills.motion import OPEN, close, grip

    world = stage.world
    assert world.aperture > 0.07
    steps, _ = carried_out(stage, close(world))
    assert 8 <= steps <= 20
    assert world.aperture < 3e-3
    carried_out(stage, grip(world, OPEN, 15))
    assert world.aperture > 0.07


def test_a_transit_touches_nothing_on_its_way_across_the_table(stage):
    from runtime.worlds.libero.skills.frames import Pose
    from runtime.worlds.libero.skills.motion import OPEN, reach
    from runtime.worlds.libero.skills.transit import transit

    world = stage.world
    bottle, bowl = (world.pose(name).position for name in ("wine_bottle_1", "akita_black_bowl_1"))
    rotation = world.eef.rotation
    aside = bottle[:2] - bowl[:2]
    beyond = bottle[:2] + 0.12 * aside / np.linalg.norm(aside)
    start, goal = (Pose(np.array([*where, 1.05]), rotation) for where in (bowl[:2], beyond))
    assert carried_out(stage, reach(world, start, OPEN))[1]
    standing = world.cloud("wine_bottle_1")[:, 2].max()
    before = {name: world.pose(name).position for name in stage.player.scene.index.entities}
    highest = 0.0
    motion = transit(world, goal, OPEN)
    for action in motion:
        stage.sim.step(action)
        highest = max(highest, world.eef.position[2])
    assert standing > 1.0  # as low as the gripper starts, the straight way leads through the bottle
    assert highest > standing + 0.02
    after = {name: world.pose(name).position for name in before}
    assert all(np.linalg.norm(after[name] - before[name]) < 2e-3 for name in before)


def test_the_plate_lies_flat_where_it_has_to_be_pushed_and_the_bowl_does_not():
    from runtime.worlds.libero.skills.slide import lies_flat

    plate, bowl = staged("libero_goal", 5), staged("libero_goal", 8)
    assert lies_flat(plate.world, plate.place())
    assert not lies_flat(bowl.world, bowl.place())


def test_a_push_begins_behind_the_object_at_the_height_of_its_rim():
    from itertools import islice

    from runtime.worlds.libero.skills.grasping import TIP
    from runtime.worlds.libero.skills.reach import Reach
    from runtime.worlds.libero.skills.slide import slides

    stage = staged("libero_goal", 5)
    world = stage.world
    goal = world.site_pose(stage.place().site).position[:2]
    plate = world.cloud("plate_1")
    found = list(islice(slides(world, Reach(world), "plate_1", goal), 2))
    assert found
    for plan in found:
        tip = plan.start.position + TIP * plan.start.rotation[:, 2]
        away = tip[:2] - world.pose("plate_1").position[:2]
        assert away @ (goal - world.pose("plate_1").position[:2]) < 0.0
        assert np.linalg.norm(plate[:, :2] - tip[:2], axis=1).min() > 0.01
        assert plate[:, 2].min() < tip[2] < plate[:, 2].max()


def test_what_has_tilted_leans_whichever_way_it_faces():
    import mujoco

    from runtime.worlds.libero.skills.frames import axis_angle
    from runtime.worlds.libero.skills.press import leans

    stage = staged("libero_10", 3)
    world, index, data = stage.world, stage.player.scene.index, stage.sim.data
    upright = world.pose("akita_black_bowl_1").rotation
    where = index.qpos_slice(index.free_joint("akita_black_bowl_1"))
    found = []
    for axis, angle in (((0, 0, 1), 1.0), ((1, 0, 0), 0.1), ((1, 0, 0), 0.3), ((0, 1, 0), -0.3), ((1, 0, 0), 1.5)):
        turned = axis_angle(np.array(axis, dtype=float), angle) @ upright
        mujoco.mju_mat2Quat(data.qpos[where][3:], np.ascontiguousarray(turned).ravel())
        mujoco.mj_kinematics(stage.sim.model, data)
        found.append(leans(world, "akita_black_bowl_1", upright))
    assert found == [False, False, True, True, True]


def test_the_way_into_a_drawer_is_the_one_that_shuts_it():
    from runtime.worlds.libero.skills.press import inward

    stage = staged("libero_10", 3)
    world, place, index = stage.world, stage.place(1), stage.player.scene.index
    way = inward(world, place)
    body = world.model.site_bodyid[index.site(place.site)]
    (joint,) = (joint for joint in index.joints(place.site) if world.model.jnt_bodyid[joint] == body)
    before = world.site_pose(place.site).position
    stage.sim.data.qpos[world.model.jnt_qposadr[joint]] *= 0.5  # half shut
    stage.sim.settle(1)
    moved = world.site_pose(place.site).position - before
    assert np.linalg.norm(moved) > 0.02
    assert way @ moved / np.linalg.norm(moved) > 0.99
    on_a_plate = staged("libero_goal", 8)
    assert inward(on_a_plate.world, on_a_plate.place()) is None
