"""Gymnasium's vector environments over ours: the same trajectories as one by one, and starts that last."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv

pytestmark = pytest.mark.sim
LIBERO = "runtime.worlds.libero.gym:onto/Libero-v0"
TASK = "libero_goal/8"
KEYS = ("robot0_joint_pos", "robot0_eef_pos", "plate_1_pos", "akita_black_bowl_1_pos")
HORIZON = 5
ROOT = Path(__file__).parents[5]
WITH_ROOT = {**os.environ, "PYTHONPATH": str(ROOT)}


def make(**options):
    return lambda: gymnasium.make(LIBERO, **{"task": TASK, "horizon": HORIZON, "observables": KEYS, **options})


@pytest.fixture(scope="module")
def actions():
    return np.random.default_rng(3).uniform(-1, 1, (3 * HORIZON, 2, 7)).astype(np.float32)


def alone(actions, seed):
    """An episode of ``HORIZON`` steps and its observations, first included."""
    env = make()()
    seen = [env.reset(seed=seed)[0]]
    seen += [env.step(action)[0] for action in actions]
    return seen


def equal(batch, row, single):
    return all(np.array_equal(batch[key][row], single[key]) for key in KEYS)


@pytest.mark.parametrize("kind", [SyncVectorEnv, AsyncVectorEnv])
def test_a_vector_steps_as_its_parts_do_and_autoreset_keeps_each_start(kind, actions):
    vector = kind([make(), make()])
    try:
        observed, info = vector.reset(seed=[4, 9])
        assert info["state_index"].tolist() == [4, 9]
        expected = [alone(actions[:HORIZON, row], seed) for row, seed in enumerate((4, 9))]
        starts = [expected[row][0] for row in range(2)]
        assert all(equal(observed, row, starts[row]) for row in range(2))
        for step in range(HORIZON):
            observed, rewards, terminated, truncated, info = vector.step(actions[step])
            assert all(equal(observed, row, expected[row][step + 1]) for row in range(2))
        assert truncated.all()
        assert not terminated.any()
        assert not rewards.any()
        observed, *_, info = vector.step(actions[0])  # the step that resets
        assert info["state_index"].tolist() == [4, 9]
        assert all(equal(observed, row, starts[row]) for row in range(2))
        observed = vector.step(actions[0])[0]
        assert all(equal(observed, row, expected[row][1]) for row in range(2))
    finally:
        vector.close()


def test_typed_facts_come_for_each_environment():
    vector = SyncVectorEnv([make(), make(task="libero_goal/1")])
    _, info = vector.reset(seed=0)
    assert info["success"].tolist() == [False, False]
    assert [facts[0]["arguments"][0] for facts in info["facts"]] == ["akita_black_bowl_1", "akita_black_bowl_1"]
    assert [facts[0]["arguments"][1] for facts in info["facts"]] == ["plate_1", "flat_stove_1_cook_region"]
    assert [rows[0]["failure"] for rows in info["failures"]] == ["relation_missing"] * 2


def test_an_autoreset_in_the_same_step_gives_the_last_observation_and_facts(actions):
    vector = SyncVectorEnv([make()], autoreset_mode=AutoresetMode.SAME_STEP)
    first, _ = vector.reset(options={"state_index": 7})
    for step in range(HORIZON):
        observed, _, _, truncated, info = vector.step(actions[step, :1])
    assert truncated.all()
    assert equal(observed, 0, {key: first[key][0] for key in KEYS})
    assert info["final_info"]["step"].tolist() == [HORIZON]
    assert info["final_info"]["facts"][0][0]["predicate"] == "on"
    assert not equal(observed, 0, info["final_obs"][0])


def test_an_end_of_one_environment_leaves_the_other_alone(actions):
    vector = SyncVectorEnv([make(horizon=2), make(horizon=50)])
    vector.reset(seed=[1, 2])
    lone = make(horizon=50)()
    lone.reset(seed=2)
    for step in range(8):
        observed = vector.step(actions[step])[0]
        single = lone.step(actions[step, 1])[0]
        assert equal(observed, 1, single)


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_make_vec_makes_them(mode):
    vector = gymnasium.make_vec(LIBERO, num_envs=2, vectorization_mode=mode, task=TASK, observables=KEYS)
    try:
        observed, info = vector.reset(seed=0)
        assert info["state_index"].tolist() == [0, 1]
        assert observed["robot0_joint_pos"].shape == (2, 7)
        assert vector.step(np.zeros((2, 7), dtype=np.float32))[4]["step"].tolist() == [1, 1]
    finally:
        vector.close()


FORKED = """
import sys
import gymnasium
import numpy as np
from gymnasium.vector import AsyncVectorEnv
from onto_compiler.problems import OntoError

def make():
    return gymnasium.make("runtime.worlds.libero.gym:onto/Libero-v0", task="libero_goal/8", images=True, image_size=32,
                          fast_render=True, cameras=("agentview",), settle=1)

if __name__ == "__main__":
    workers = AsyncVectorEnv([make, make], context="fork")
    pictures = workers.reset(seed=0)[0]["agentview_image"]
    workers.close()
    assert not np.array_equal(*pictures)
    here = make()
    assert np.array_equal(here.reset(seed=0)[0]["agentview_image"], pictures[0])  # this process has drawn now
    forked = AsyncVectorEnv([make], context="fork")
    try:
        forked.reset(seed=0)
    except OntoError as error:
        print(error.problems[0].code)
    forked.close(terminate=True)
    spawned = AsyncVectorEnv([make], context="spawn")
    assert np.array_equal(spawned.reset(seed=0)[0]["agentview_image"][0], pictures[0])
    spawned.close()
    print("drawn")
"""


def test_workers_draw_and_a_fork_of_a_process_that_has_drawn_says_why_it_cannot(tmp_path):
    from runtime.worlds.pictures import backend

    if backend() is None:
        pytest.skip("this machine cannot draw")
    program = tmp_path / "program.py"
    program.write_text(FORKED)
    done = subprocess.run(
        [sys.executable, program], capture_output=True, text=True, check=False, cwd=ROOT, env=WITH_ROOT, timeout=300
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split() == ["SIM032", "drawn"]
