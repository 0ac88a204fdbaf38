"""PointMaze through Gymnasium: spaces, trials, verdicts, and the typed facts in ``info``."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.environment import PointMazeEnv
from runtime.worlds.pointmaze.gym import POINT_MAZE
from runtime.worlds.pointmaze.maze import MAZES
from runtime.worlds.pointmaze.picture import draw
from runtime.worlds.pointmaze.rollout import Rollout
from runtime.worlds.pointmaze.trials import trial, trial_in

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]


def made(**options):
    return gymnasium.make(f"runtime.worlds.pointmaze.gym:{POINT_MAZE}", **options)


@pytest.mark.parametrize("options", [{}, {"observe": "pixels", "size": 32}, {"maze": "medium"}])
def test_gymnasium_finds_no_fault(options, recwarn):
    env = made(render_mode="rgb_array", **options)
    check_env(env.unwrapped)
    said = [str(warning.message) for warning in recwarn]
    assert [text for text in said if "Box observation space" not in text] == []  # a state has no bounds
    assert env.unwrapped.render().shape == (224, 224, 3)


def test_a_seed_is_a_trial_and_an_episode_is_the_batched_rollout():
    env, actions = made(terminate=False), np.random.default_rng(0).uniform(-1, 1, (30, 2)).astype(np.float32)
    observation, info = env.reset(seed=7)
    wanted = trial(7)
    assert info["trial"] == 7
    assert np.array_equal(observation["state"], wanted.start)
    assert np.array_equal(observation["goal"], wanted.goal)
    seen = np.array([env.step(action)[0]["state"] for action in actions])
    assert np.array_equal(seen, Rollout(U_MAZE).states(wanted.start[None], actions[None].astype(float))[0, 1:])


def test_pictures_show_ball_and_goal():
    env = made(observe="pixels")
    observation, _ = env.reset(options={"trial": 3})
    assert np.array_equal(observation["pixels"], draw(U_MAZE, trial(3).start[None])[0])
    assert np.array_equal(observation["goal_pixels"], draw(U_MAZE, trial(3).goal[None])[0])


def test_success_ends_an_episode_and_the_facts_say_what_is_left():
    env = made()
    goal = [0.8, 1.35, 0.0, 0.0]
    _, info = env.reset(options={"state": [0.8, 0.8, 0.0, 1.0], "goal": goal})
    assert not info["success"]
    assert [(row["failure"], row["route"]) for row in info["failures"]] == [
        ("missing_entity_on_target", "longer_horizon"),
        ("velocity_mismatch", "match_velocity"),
    ]
    assert [(row["predicate"], row["satisfied"]) for row in info["premise"]] == [("free_of", True)]
    _, reward, terminated, truncated, info = env.step(np.array([0.0, 0.5], dtype=np.float32))
    while not terminated:
        assert (reward, truncated) == (0.0, False)
        _, reward, terminated, truncated, info = env.step(np.zeros(2, dtype=np.float32))
    assert (reward, info["success"], info["is_success"], info["judge"]) == (1.0, True, True, "native")
    assert 0.0 < info["position_distance"] < 0.5
    assert info["state_distance"] == pytest.approx(np.hypot(info["position_distance"], info["velocity_distance"]))
    assert info["progress"] == pytest.approx(0.55 - info["position_distance"])
    rows = {row["predicate"]: row for row in info["facts"]}
    assert rows["at_target"]["truth"]
    assert rows["at_target"]["margin"] == pytest.approx(0.5 - info["position_distance"])
    assert (rows["velocity_matches"]["unit"], rows["at_target"]["unit"]) == ("m s⁻¹", "m")
    assert {row["failure"] for row in info["failures"]} == {"target_distance", "velocity_mismatch"}


def test_an_episode_is_cut_at_its_horizon():
    env = made(horizon=3, terminate=False)
    env.reset(seed=0)
    ends = [env.step(np.zeros(2, dtype=np.float32))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]


def test_a_reset_without_a_seed_draws_trials_that_no_table_has():
    env = made()
    env.reset(seed=5)
    drawn = [env.reset()[1]["trial"] for _ in range(20)]
    assert len(set(drawn)) == 20
    assert min(drawn) >= 10_000
    env.reset(seed=5)
    assert [env.reset()[1]["trial"] for _ in range(20)] == drawn
    assert env.reset(seed=2**40)[1]["trial"] == 2**40 % 1_000_000


def test_every_maze_has_trials_in_its_own_cells():
    for name, maze in MAZES.items():
        found = [trial_in(maze, number) for number in range(20)]
        places = np.array([[each.start, each.goal] for each in found])
        assert maze.free(places, 0.09).all(), name
        assert len(np.unique(places[..., 0])) == 40
    assert np.array_equal(trial_in(U_MAZE, 4).start, trial(4).start)


def test_many_at_once():
    vector = gymnasium.make_vec(f"runtime.worlds.pointmaze.gym:{POINT_MAZE}", num_envs=3, vectorization_mode="sync")
    observations, info = vector.reset(seed=0)
    assert info["trial"].tolist() == [0, 1, 2]
    assert np.array_equal(observations["goal"], [trial(number).goal for number in range(3)])
    observations, rewards, *_ = vector.step(np.zeros((3, 2), dtype=np.float32))
    assert observations["state"].shape == (3, 4)
    assert rewards.shape == (3,)
    vector.close()


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"maze": "u-maze"}, "PMZ002"),
        ({"observe": "sound"}, "PMZ007"),
        ({"render_mode": "human"}, "PMZ007"),
        ({"horizon": 0}, "PMZ007"),
        ({"observe": "pixels", "size": 2}, "PMZ003"),
    ],
)
def test_an_environment_that_makes_no_sense_is_refused(options, code):
    with pytest.raises(OntoError) as caught:
        PointMazeEnv(**options)
    assert [problem.code for problem in caught.value.problems] == [code]


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"trail": 3}, "PMZ007"),
        ({"state": np.zeros(4)}, "PMZ007"),
        ({"state": np.zeros(4), "goal": np.zeros(4), "trial": 1}, "PMZ007"),
        ({"state": np.zeros((2, 4)), "goal": np.zeros(4)}, "PMZ003"),
        ({"state": np.zeros(4), "goal": np.full(4, np.nan)}, "PMZ004"),
        ({"trial": -1}, "PMZ005"),
        ({"trial": "first"}, "PMZ005"),
    ],
)
def test_a_start_that_makes_no_sense_is_refused(options, code):
    with pytest.raises(OntoError) as caught:
        made().reset(options=options)
    assert [problem.code for problem in caught.value.problems] == [code]


@pytest.mark.parametrize(("action", "code"), [(np.zeros(3), "PMZ003"), (np.array([0.0, np.nan]), "PMZ004")])
def test_an_action_that_is_none_is_refused(action, code):
    env = made().unwrapped
    env.reset(seed=0)
    with pytest.raises(OntoError) as caught:
        env.step(action)
    assert [problem.code for problem in caught.value.problems] == [code]
