from __future__ import annotations

import re

import numpy as np
import pytest

from onto_compiler.required import NativeAtom
from runtime.worlds.fixtures import poses_in
from tests.faults import fault

pytestmark = pytest.mark.sim


@pytest.fixture(scope="module")
def actions():
    return np.random.default_rng(0).uniform(-1, 1, (25, 7))


def run(native, actions):
    for action in actions:
        native.step(action)
    return native.data.qpos.copy()


def test_a_rollout_equals_the_plain_environment_s(ref, native, state, actions):
    from runtime.worlds.libero.simulator.actions import DUMMY_ACTION
    from runtime.worlds.libero.simulator.native_import import control_env

    plain = control_env()(
        bddl_file_name=str(ref.bddl), use_camera_obs=False, has_renderer=False, has_offscreen_renderer=False
    )
    plain.seed(0)
    plain.reset()
    plain.set_init_state(state)
    for _ in range(10):
        plain.step(list(DUMMY_ACTION))
    for action in actions:
        plain.step(action)
    native.reset_to(state)
    native.settle()
    assert np.array_equal(run(native, actions), plain.sim.data.qpos)
    assert not np.array_equal(native.data.qpos, state[1 : 1 + native.model.nq])
    plain.close()


def test_resetting_to_a_state_forgets_what_came_before(native, state, actions):
    native.reset_to(state)
    first = run(native, actions)
    native.reset_to(state)
    assert np.array_equal(run(native, actions), first)


def test_a_seeded_reset_has_the_future_of_a_new_task_of_that_seed(ref, actions):
    from runtime.worlds.libero.simulator.native import NativeTask

    with NativeTask.open(ref, 3) as new:
        first = run(new, actions)
    closing = np.full_like(actions, 0.5)
    with NativeTask.open(ref, 0) as used:
        run(used, closing)
        used.reset_seeded(3)
        assert np.array_equal(run(used, actions), first)


def test_a_snapshot_taken_in_motion_resumes_exactly(native, state, actions):
    native.reset_to(state)
    run(native, actions[:10])
    saved = native.snapshot()
    first = run(native, actions[10:])
    run(native, -actions)
    native.restore(saved)
    assert np.array_equal(run(native, actions[10:]), first)


def test_restoring_does_not_alter_the_snapshot(native, state, actions):
    native.reset_to(state)
    saved = native.snapshot()
    kept = saved.integration.copy(), saved.body_pos.copy(), saved.gripper_action.copy()
    native.restore(saved)
    run(native, actions)
    assert all(
        np.array_equal(a, b)
        for a, b in zip(kept, (saved.integration, saved.body_pos, saved.gripper_action), strict=True)
    )


def test_a_seed_fixes_the_fixtures_and_leaves_the_global_generator_alone(ref, native):
    from runtime.worlds.libero.simulator.native import NativeTask

    np.random.seed(123)  # noqa: NPY002  the global generator is what is tested
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    with NativeTask.open(ref, seed=0) as again, NativeTask.open(ref, seed=1) as other:
        assert np.array_equal(again.model.body_pos, native.model.body_pos)
        assert np.array_equal(again.model.body_quat, native.model.body_quat)
        assert not np.array_equal(other.model.body_pos, native.model.body_pos)
    assert np.array_equal(np.random.get_state()[1], before)  # noqa: NPY002


@pytest.mark.parametrize(
    ("suite", "index", "seed"), [("libero_goal", 4, 0), ("libero_10", 0, 1), ("libero_10", 3, 0), ("libero_90", 1, 2)]
)
def test_a_task_begins_as_after_libero_s_own_reset_that_builds_the_scene_anew(suite, index, seed):
    from runtime.worlds import snapshot
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask
    from runtime.worlds.libero.simulator.native_import import control_env
    from runtime.worlds.native_import import quiet

    ref = find_task(suite, index)
    with quiet():
        np.random.seed(seed)  # noqa: NPY002  LIBERO samples from it
        plain = control_env()(
            bddl_file_name=str(ref.bddl), use_camera_obs=False, has_renderer=False, has_offscreen_renderer=False
        )
        plain.seed(seed)
        plain.env.reset()
    theirs = snapshot.take(plain.env)
    with NativeTask.open(ref, seed) as task:
        ours = task.snapshot()
        for name in ("integration", "body_pos", "body_quat", "gripper_action"):
            assert np.array_equal(getattr(ours, name), getattr(theirs, name)), name
        assert ours.controller.keys() == theirs.controller.keys()
        assert all(np.array_equal(ours.controller[name], theirs.controller[name]) for name in ours.controller)
    with quiet():
        plain.close()


def test_writing_qpos_moves_and_stills_only_what_it_changes(native, state):
    from grounding.scenes import Scene

    native.reset_to(state)
    scene = Scene(native.model)
    native.data.qvel[:] = 1.0
    joint = scene.free_joint("plate_1")
    qpos = native.data.qpos.copy()
    qpos[scene.qpos_slice(joint)][0] += 0.05
    native.write_qpos(qpos)
    expected = np.ones(native.model.nv)
    expected[scene.dof_slice(joint)] = 0.0
    assert np.array_equal(native.data.qvel, expected)
    assert native.data.xpos[scene.root_body("plate_1")][0] == qpos[scene.qpos_slice(joint)][0]
    native.data.qvel[:] = 1.0
    native.write_qpos(qpos + 0.0, still=False)
    assert np.array_equal(native.data.qvel, np.ones(native.model.nv))


def test_a_state_that_broke_off_is_told_from_one_that_is_merely_finite(native, state, tmp_path, monkeypatch, caplog):
    monkeypatch.chdir(tmp_path)
    native.reset_to(state)
    saved = native.snapshot()
    native.settle(1)
    assert not native.diverged
    native.data.qvel[-1] = 1e20
    native.settle(1)
    assert np.isfinite(native.data.qpos).all()
    assert native.diverged
    assert "Nan, Inf or huge value in QVEL" in caplog.text
    assert list(tmp_path.iterdir()) == []  # MuJoCo's own log file
    native.restore(saved)
    native.settle(1)
    assert not native.diverged


def test_success_is_the_goal_s_native_predicate(native, state):
    from grounding.scenes import Scene

    goal = NativeAtom("On", ("akita_black_bowl_1", "flat_stove_1_cook_region"))
    native.reset_to(state)
    native.settle()
    assert (native.success(), native.evaluate(goal)) == (False, False)
    scene = Scene(native.model)
    qpos = native.data.qpos.copy()
    burner = native.data.site_xpos[scene.site("flat_stove_1_cook_region")]
    qpos[scene.qpos_slice(scene.free_joint("akita_black_bowl_1"))][:3] = burner + np.array([0, 0, 0.02])
    native.write_qpos(qpos)
    native.settle(8)
    assert (native.success(), native.evaluate(goal)) == (True, True)


@pytest.mark.parametrize(("method", "size"), [("reset_to", "state_size"), ("write_qpos", "nq")])
def test_a_state_of_the_wrong_length_or_not_finite_is_refused(native, method, size):
    right = native.state_size if size == "state_size" else native.model.nq
    problem = fault(getattr(native, method), np.zeros(right + 2))
    assert problem.code == "SIM004"
    assert str(right + 2) in problem.message
    assert str(right) in problem.message
    values = np.zeros(right)
    values[3] = np.nan
    assert fault(getattr(native, method), values).code == "SIM003"


def test_a_snapshot_of_another_scene_is_refused(native):
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask

    with NativeTask.open(find_task("libero_object", 0)) as other:
        assert fault(native.restore, other.snapshot()).code == "SIM004"


@pytest.mark.parametrize(
    ("predicate", "arguments", "hint"),
    [
        ("Onn", ("akita_black_bowl_1", "plate_1"), "did you mean `on`?"),
        ("On", ("akita_black_bowl", "plate_1"), "did you mean `akita_black_bowl_1`?"),
        ("Open", ("plate_1",), ""),
        ("Turnon", ("plate_1",), ""),
    ],
)
def test_an_atom_that_libero_cannot_evaluate_is_refused(native, predicate, arguments, hint):
    problem = fault(native.evaluate, NativeAtom(predicate, arguments))
    assert (problem.code, problem.hint) == ("SIM015", hint)


def test_a_file_that_is_no_task_is_refused(tmp_path):
    from runtime.worlds.libero.simulator.native import NativeTask

    assert fault(NativeTask, tmp_path / "absent.bddl").code == "SIM016"
    broken = tmp_path / "broken.bddl"
    for text in (
        "(define (problem No_Such_Problem) (:domain robosuite) (:language do))",
        "(define (problem Libero_Tabletop_Manipulation) (:domain robosuite) (:language do) (:objects a_1 - no_asset))",
        "(define (problem Libero_Tabletop_Manipulation) (:domain robosuite) (:language do) (:regions (a (:target))))",
        "(define (problem Libero_Floor_Manipulation) (:domain elsewhere) (:language do))",
        "no task at all",
        "",
    ):
        broken.write_text(text)
        problem = fault(NativeTask, broken)
        assert (problem.code, problem.file) == ("SIM016", str(broken))


def test_a_scene_without_room_for_its_objects_is_refused_and_not_tried_for_ever(tmp_path, ref):
    from runtime.worlds.libero.simulator.native import NativeTask

    text = ref.bddl.read_text()
    bowl, plate = "(-0.09999999999999999 -0.01 -0.08 0.01)", "(0.04 -0.03 0.060000000000000005 -0.01)"
    assert text.count(bowl) == text.count(plate) == 1
    (tmp_path / "crowded.bddl").write_text(text.replace(bowl, plate))  # one on the other's place
    problem = fault(NativeTask, tmp_path / "crowded.bddl")
    assert problem.code == "SIM016"
    assert problem.message.startswith("two objects have no room in region `main_table_plate_region`: ")
    assert all(name in problem.message for name in ("`plate_1`", "`akita_black_bowl_1`"))


def test_nothing_is_printed_on_stdout(ref, state, capfd):
    from runtime.worlds.libero.simulator.native import NativeTask

    with NativeTask.open(ref) as task:
        task.reset_to(state)
        task.settle(1)
        task.success()
    assert capfd.readouterr().out == ""


def test_the_versions_that_decide_a_result_are_told():
    from runtime.worlds.libero.simulator.native import versions

    assert {"python", "numpy", "mujoco", "robosuite"} <= set(versions())


@pytest.mark.parametrize(("suite", "task"), [("libero_goal", 8), ("libero_10", 9)])
def test_textures_are_all_that_a_scene_that_is_not_drawn_lacks(suite, task):
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.native import NativeTask

    with NativeTask.open(find_task(suite, task)) as one:
        bare, whole, saved = one.model, one.textured(), one.env.sim.model.get_xml()
    assert (bare.ntex, whole.ntex > 0) == (0, True)
    of_textures = ("tex_", "name", "mat_texid", "_sizes")  # names have their places behind those of textures
    for name in dir(whole):
        first, second = getattr(whole, name), getattr(bare, name)
        if isinstance(first, np.ndarray) and not name.startswith(of_textures):
            assert np.array_equal(first, second, equal_nan=first.dtype.kind == "f"), name
    assert len(re.findall("<texture ", saved)) == whole.ntex
    written = poses_in(saved, bare)
    assert np.allclose(written.body_pos, bare.body_pos, atol=1e-5)  # MJCF has six digits
