from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from tests.faults import fault

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def scene(ref, tmp_path_factory):
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.scene_cache import SceneCache

    return compile_scene(ref.bddl, cache=SceneCache(tmp_path_factory.mktemp("cache")))


@pytest.fixture(scope="module")
def actions():
    return np.random.default_rng(0).uniform(-1.2, 1.2, (60, 7))


@pytest.fixture(scope="module")
def native_path(native, state, actions):
    native.reset_to(state)
    path = []
    for action in actions:
        native.step(action)
        path.append(native.data.qpos.copy())
    return np.array(path)


def simulation(scene, state=None, *, exact=False):
    from runtime.worlds.libero.simulator.simulation import Simulation

    made = Simulation(scene, exact=exact)
    if state is not None:
        made.reset_to(state)
    return made


def path_of(made, actions):
    path = []
    for action in actions:
        made.step(action)
        path.append(made.data.qpos.copy())
    return np.array(path)


def test_exact_steps_equal_the_native_environment_s_bit_for_bit(scene, state, actions, native_path):
    assert np.array_equal(path_of(simulation(scene, state, exact=True), actions), native_path)


def test_compiled_steps_agree_with_the_native_environment_s(scene, state, actions, native_path):
    difference = np.abs(path_of(simulation(scene, state), actions) - native_path).max()
    assert 0 < difference < 1e-9


@pytest.mark.parametrize("exact", [True, False])
def test_a_restored_run_repeats_bit_for_bit(scene, state, actions, exact):
    made = simulation(scene, state, exact=exact)
    made.rollout(actions[:10])
    saved = made.snapshot()
    first = path_of(made, actions[10:30])
    made.rollout(actions[:3])
    made.restore(saved)
    assert np.array_equal(path_of(made, actions[10:30]), first)
    other = simulation(scene, exact=exact)
    other.restore(saved)
    assert np.array_equal(path_of(other, actions[10:30]), first)


def test_a_snapshot_moves_between_the_native_environment_and_a_simulation(scene, native, state, actions, native_path):
    native.reset_to(state)
    for action in actions[:20]:
        native.step(action)
    made = simulation(scene, exact=True)
    made.restore(native.snapshot())
    assert np.array_equal(path_of(made, actions[20:40]), native_path[20:40])
    made.reset_to(state)
    made.rollout(actions[:20])
    native.restore(made.snapshot())
    for action in actions[20:40]:
        native.step(action)
    assert np.array_equal(native.data.qpos, native_path[39])


def test_the_compiled_snapshot_drives_the_exact_loop(scene, state, actions):
    made = simulation(scene, state)
    made.rollout(actions[:5])
    exact = simulation(scene, exact=True)
    exact.restore(made.snapshot())
    assert np.abs(path_of(exact, actions[5:15]) - path_of(made, actions[5:15])).max() < 1e-9


def test_random_rotations_equal_robosuite_s(scene):
    from robosuite.utils.transform_utils import axisangle2quat, quat2mat

    from runtime.worlds.libero.simulator.osc import rotation

    vectors = np.random.default_rng(1).normal(size=(200, 3)) * np.logspace(-9, 0.5, 200)[:, None]
    quaternion, matrix = np.empty(4, dtype=np.float32), np.empty((3, 3))
    for vector in (*vectors, np.zeros(3)):
        rotation(vector, quaternion, matrix)
        assert np.array_equal(matrix, quat2mat(axisangle2quat(vector)))


def test_touches_of_every_substep_are_accumulated(scene, state):
    made = simulation(scene, state)
    made.watch(("akita_black_bowl_1", "plate_1"))
    assert not made.touched.any()
    made.settle(5)
    assert not made.touched.any()  # they stand apart
    joint = made.scene.index.free_joint("akita_black_bowl_1")
    where = made.scene.index.qpos_slice(joint)
    plate = made.scene.index.root_body("plate_1")
    made.data.qpos[where][:3] = made.data.xpos[plate] + [0, 0, 0.06]
    made.settle(8)
    assert made.touched[0, 1]
    assert made.touched[1, 0]
    made.watch(())
    assert made.touched.size == 0


def test_every_contact_that_mujoco_lists_at_the_end_was_accumulated(scene, state):
    made = simulation(scene, state)
    made.watch(tuple(made.scene.index.entities))
    made.settle(3)
    pairs = {
        tuple(sorted(made.scene.index.entities[i] for i in pair)) for pair in np.argwhere(made.touched) if pair.size
    }
    mujoco_pairs = set()
    for pair in made.data.contact.geom:
        owners = [
            next((e for e in made.scene.index.entities if g in made.scene.index.contact_geoms(e)), None) for g in pair
        ]
        if None not in owners:
            mujoco_pairs.add(tuple(sorted(owners)))
    assert mujoco_pairs <= pairs


@pytest.mark.parametrize("exact", [True, False])
def test_a_divergence_is_a_run_fault_that_carries_the_last_good_state(scene, state, actions, exact):
    from runtime.loop.faults import RunFault

    made = simulation(scene, state, exact=exact)
    made.rollout(actions[:4])
    made.data.qvel[20] = 1e30
    with pytest.raises(RunFault, match="control step 5") as caught:
        made.step(actions[4])
    assert caught.value.snapshot is not None
    assert np.isfinite(made.data.qpos).all()
    assert made.steps == 4


@pytest.mark.parametrize("exact", [True, False])
def test_an_observer_sees_the_state_before_the_last_substep_and_changes_nothing(scene, state, actions, exact):
    plain, seen = simulation(scene, state, exact=exact), simulation(scene, state, exact=exact)
    times = []
    for action in actions[:6]:
        plain.step(action)
        seen.step(action, lambda: times.append(seen.data.time))
    assert np.array_equal(plain.data.qpos, seen.data.qpos)
    ends = (np.arange(6) + 1) / 20
    assert np.allclose(np.array(times) - state[0], ends - scene.model.opt.timestep)


@pytest.mark.parametrize(
    "action",
    [np.zeros(6), np.zeros(8), [0, 0, np.nan, 0, 0, 0, 1], [np.inf] * 7, None, "up", ["0.1"] * 6 + ["up"], [{}] * 7],
)
def test_an_action_that_is_none_is_refused(scene, state, action):
    made = simulation(scene, state)
    before = made.data.qpos.copy()
    assert fault(made.step, action).code == "SIM021"
    assert np.array_equal(made.data.qpos, before)


def test_a_state_of_another_task_is_refused(scene, state):
    made = simulation(scene, state)
    assert fault(made.reset_to, state[:-1]).code == "SIM004"
    assert fault(made.reset_to, np.full_like(state, np.nan)).code == "SIM003"
    saved = made.snapshot()
    assert fault(made.restore, dataclasses.replace(saved, body_pos=saved.body_pos[1:])).code == "SIM004"


def test_resets_and_steps_need_no_more_memory(scene, state):
    import resource

    made = simulation(scene, state)
    for _ in range(50):
        made.reset_to(state)
        made.settle(2)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(300):
        made.reset_to(state)
        made.settle(2)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4096  # KiB


def test_a_state_of_the_right_length_with_numbers_in_the_wrong_places_is_refused(scene, state):
    made = simulation(scene)
    before = made.flat_state
    wrong = state.copy()
    wrong[1 : 1 + made.model.nq] = np.roll(wrong[1 : 1 + made.model.nq], 1)
    problem = fault(made.reset_to, wrong)
    assert problem.code == "SIM004"
    assert "orientation" in problem.message
    assert np.array_equal(made.flat_state, before)


def test_a_snapshot_of_another_scene_of_equal_sizes_is_refused(scene, state):
    import mujoco

    from runtime.worlds.snapshot import identity

    made = simulation(scene, state)
    other = mujoco.MjModel.from_xml_string("<mujoco><worldbody><site/></worldbody></mujoco>")
    assert identity(other) != identity(scene.model)
    saved = dataclasses.replace(made.snapshot(), scene=identity(other))
    assert fault(made.restore, saved).code == "SIM004"


def test_a_scene_is_itself_with_and_without_textures_and_wherever_its_fixtures_stand(ref, scene, native):
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.snapshot import identity

    elsewhere = compile_scene(ref.bddl, seed=1)
    assert not np.array_equal(elsewhere.model.body_pos, scene.model.body_pos)
    assert identity(native.model) == identity(elsewhere.model) == identity(scene.model) == scene.home.scene


def test_fixtures_are_not_moved_under_another_simulation(ref, scene):
    from runtime.worlds.libero.simulator.compiled import compile_scene

    elsewhere = simulation(compile_scene(ref.bddl, seed=1)).snapshot()
    shared = compile_scene(ref.bddl)
    first, second = simulation(shared), simulation(shared)
    poses = shared.model.body_pos.copy()
    problem = fault(second.restore, elsewhere)
    assert problem.code == "SIM022"
    assert np.array_equal(shared.model.body_pos, poses)
    del first
    second.restore(elsewhere)
    assert np.array_equal(shared.model.body_pos, elsewhere.body_pos)
    assert fault(simulation, shared).code == "SIM022"
    assert np.array_equal(second.snapshot().body_pos, elsewhere.body_pos)
