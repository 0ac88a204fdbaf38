"""The environment keeps Gymnasium's contract and LIBERO's: starts, ends, and what is left of an earlier episode."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from tests.faults import fault

pytestmark = pytest.mark.sim
TASK = "libero_goal/put_the_bowl_on_the_stove"


@pytest.fixture(scope="module")
def env():
    import gymnasium

    made = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task=TASK)
    yield made
    made.close()


@pytest.fixture(scope="module")
def actions():
    return np.random.default_rng(0).uniform(-1, 1, (12, 7)).astype(np.float32)


def same(first, second):
    return first.keys() == second.keys() and all(np.array_equal(first[key], second[key]) for key in first)


def run(env, actions, **start):
    observed = [env.reset(**start)[0]]
    observed += [env.step(action)[0] for action in actions]
    return observed


def test_gymnasium_s_own_checker_is_content(env):
    from gymnasium.utils.env_checker import check_env

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env.unwrapped, skip_render_check=True)
    about = [str(w.message) for w in caught]
    # A position has no bounds that physics would keep.
    assert [text for text in about if "infinity" not in text] == []


def test_a_trial_starts_from_its_official_state_and_repeats_bit_for_bit(env, actions):
    _, info = env.reset(seed=53)
    assert info["state_index"] == 3  # of 50
    first, again, other = (run(env, actions, seed=seed) for seed in (7, 7, 8))
    assert all(map(same, first, again))
    assert not same(first[0], other[0])


def test_a_reset_keeps_the_initial_state_that_was_asked_for(env, actions):
    asked = run(env, actions, options={"state_index": 11})
    kept = run(env, actions)
    assert env.unwrapped.reset()[1]["state_index"] == 11
    assert all(map(same, asked, kept))


def test_a_flat_state_of_ones_own_is_kept_as_well(env, actions):
    from runtime.worlds.libero.simulator.assets import find_task, initial_states

    state = initial_states(find_task(*TASK.split("/")))[11]
    asked = run(env, actions, options={"state_index": 11})
    own = run(env, actions, options={"state": state, "settle": 10})
    assert env.reset()[1]["state_index"] == -1
    assert all(map(same, asked, own))


@pytest.mark.parametrize("length", [0, 1, 5, 11])
def test_an_episode_does_not_depend_on_when_an_earlier_one_ended(env, actions, length):
    alone = run(env, actions, options={"state_index": 2})
    run(env, -actions[:length], options={"state_index": 5})
    assert all(map(same, alone, run(env, actions, options={"state_index": 2})))


def test_a_reset_writes_a_state_and_builds_no_scene(env, monkeypatch):
    from runtime.worlds.libero.gym import environment
    from runtime.worlds.libero.simulator import native

    def build(*_args, **_kwargs):
        raise AssertionError("a reset has built a scene")

    monkeypatch.setattr(environment, "compile_scene", build)
    monkeypatch.setattr(native.NativeTask, "__init__", build)
    model, data = env.unwrapped.simulation.model, env.unwrapped.simulation.data
    for trial in range(25):
        env.reset(seed=trial)
    assert env.unwrapped.simulation.model is model
    assert env.unwrapped.simulation.data is data


def test_advance_goes_on_and_a_seed_draws_the_same_states_again():
    import gymnasium

    made = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task=TASK, state_index=48, advance=3)
    assert [made.reset()[1]["state_index"] for _ in range(3)] == [48, 1, 4]
    drawn = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task=TASK, advance="random")

    def some(seed):
        drawn.reset(seed=seed)
        return [drawn.reset()[1]["state_index"] for _ in range(8)]

    first = some(0)
    assert first == some(0)
    assert len(set(first)) > 2


@pytest.mark.parametrize(
    ("suite", "steps"),
    [
        ("libero_spatial", 220),
        ("libero_object", 280),
        ("libero_goal", 300),
        ("libero_10", 520),
        ("libero_90", 400),
        ("libero_10_swap", 520),
        ("", 600),
    ],
)
def test_the_horizon_is_the_suite_s(suite, steps):
    from runtime.worlds.libero.scene.horizons import horizon_of

    assert horizon_of(suite) == steps


def test_an_episode_is_cut_off_at_its_horizon_and_settling_does_not_count():
    import gymnasium

    made = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task=TASK, horizon=4)
    for _ in range(2):
        made.reset()
        ends = [made.step(np.zeros(7, dtype=np.float32))[2:4] for _ in range(4)]
        assert ends == [(False, False)] * 3 + [(False, True)]
    assert made.unwrapped.simulation.steps == 14


def test_typed_facts_say_what_is_missing_and_by_how_much(env):
    _, info = env.reset(options={"state_index": 0})
    (fact,), (failure,) = info["facts"], info["failures"]
    assert (fact["predicate"], fact["arguments"]) == ("on", ("akita_black_bowl_1", "flat_stove_1_cook_region"))
    assert (fact["truth"], fact["satisfied"], fact["unit"]) == (False, False, "m")
    assert -0.3 < fact["margin"] < 0
    assert (failure["failure"], failure["route"]) == ("relation_missing", "object_relation_predicate")
    assert failure["margin"] == fact["margin"]
    assert {row["predicate"] for row in info["premise"]} == {"in_region"}
    assert (info["success"], info["is_success"], info["judge"]) == (False, False, "grounding")


def test_a_divergence_ends_the_episode_with_the_last_good_observation(env, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    env.reset(options={"state_index": 0})
    env.unwrapped.simulation.data.qvel[20] = 1e30
    observed, reward, terminated, truncated, info = env.unwrapped.step(np.zeros(7, dtype=np.float32))
    assert (reward, terminated, truncated) == (0.0, False, True)
    assert "diverged" in info["fault"]
    assert all(np.isfinite(value).all() for value in observed.values())
    assert env.reset()[1]["success"] is False
    assert list(tmp_path.iterdir()) == []  # MuJoCo would log a warning into the working folder


def test_the_current_timing_observes_the_end_of_a_step(actions):
    import gymnasium

    made = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task=TASK, timing="current")
    observed = run(made, actions)[-1]
    data = made.unwrapped.simulation.data
    assert np.array_equal(observed["robot0_joint_pos"], data.qpos[made.unwrapped.simulation.scene.arm.qpos])
    import mujoco

    mujoco.mj_forward(made.unwrapped.simulation.model, data)
    assert np.allclose(observed["robot0_eef_pos"], data.site_xpos[made.unwrapped.simulation.scene.arm.site], atol=1e-12)


def test_only_the_wanted_observables_are_given():
    import gymnasium

    keys = ("robot0_eef_pos", "plate_1_pos")
    made = gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", suite="libero_goal", index=8, observables=keys)
    observed, info = made.reset()
    assert tuple(observed) == keys
    assert info["task"] == "put_the_bowl_on_the_plate"


def test_a_predicate_of_ones_own_is_grounded_and_decides_success():
    from pathlib import Path

    from runtime.worlds.libero.gym.environment import LiberoEnv

    folder = Path(__file__).parents[5] / "docs" / "examples"
    task = str(folder / "serve_the_cheese.bddl")
    assert fault(LiberoEnv, task).code == "BDDL003"
    made = LiberoEnv(task, ontology=[str(folder / "served.ttl")])
    _, info = made.reset()
    assert (info["state_index"], info["suite"]) == (0, "")  # the seeded reset, of no suite
    assert [row["predicate"] for row in info["facts"]] == ["Served"]
    assert info["success"] is False
    assert fault(made.reset, options={"state_index": 1}).code == "SIM017"


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({}, "SIM030"),
        ({"task": TASK, "suite": "libero_goal", "index": 0}, "SIM030"),
        ({"suite": "libero_goal"}, "SIM030"),
        ({"task": "libero_goal"}, "CLI004"),
        ({"task": "libero_gaol/0"}, "SIM011"),
        ({"task": "libero_goal/10"}, "SIM012"),
        ({"task": TASK, "state_index": 50}, "SIM017"),
        ({"task": TASK, "timing": "late"}, "SIM030"),
        ({"task": TASK, "observables": ["robot0_eef_poz"]}, "SIM030"),
        ({"task": TASK, "horizon": 0}, "SIM030"),
        ({"task": TASK, "advance": "next"}, "SIM030"),
        ({"task": TASK, "image_size": (0, 4)}, "SIM030"),
        ({"task": TASK, "image_convention": "upright"}, "SIM030"),
        ({"task": TASK, "render_mode": "human"}, "SIM030"),
    ],
)
def test_an_environment_that_makes_no_sense_is_refused(options, code):
    from runtime.worlds.libero.gym.environment import LiberoEnv

    assert fault(LiberoEnv, **options).code == code


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"state_indx": 1}, "SIM030"),
        ({"state_index": -1}, "SIM017"),
        ({"state_index": 50}, "SIM017"),
        ({"state_index": "0"}, "SIM017"),
        ({"state": [0.0, 1.0]}, "SIM004"),
    ],
)
def test_a_reset_that_makes_no_sense_is_refused(env, options, code):
    env.reset(options={"state_index": 6})
    assert fault(env.unwrapped.reset, options=options).code == code
    assert env.reset()[1]["state_index"] == 6


def test_an_action_that_is_none_is_refused(env):
    env.reset()
    assert fault(env.unwrapped.step, np.zeros(6)).code == "SIM021"
    assert fault(env.unwrapped.step, np.full(7, np.nan)).code == "SIM021"
