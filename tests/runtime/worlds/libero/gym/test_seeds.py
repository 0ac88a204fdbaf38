"""A task file of one's own starts elsewhere for each seed, as LIBERO's own seeded reset does."""

from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.sim
ORIGINALS = ("libero_goal/8", "libero_spatial/4")  # the second has a drawer that its init opens, and a bowl in it


@pytest.fixture(scope="module", params=ORIGINALS)
def task(request, tmp_path_factory):
    """A copy of an official task file: it is nobody's official task any more."""
    from runtime.worlds.libero.simulator.assets import named_task

    path = tmp_path_factory.mktemp("own") / "mine.bddl"
    path.write_text(named_task(request.param).bddl.read_text("utf-8"))
    return path


@pytest.fixture(scope="module")
def env(task):
    from runtime.worlds.libero.gym.environment import LiberoEnv

    made = LiberoEnv(str(task), settle=0)
    yield made
    made.close()


def start(env, **options):
    _, info = env.reset(**options)
    model = env.simulation.model
    return np.concatenate([env.simulation.flat_state, model.body_pos.ravel(), model.body_quat.ravel()]), info


def test_each_seed_gives_its_own_start_and_the_same_seed_the_same(env):
    from runtime.worlds.libero.gym.environment import LiberoEnv

    first, again = ([start(env, seed=seed)[0] for seed in (0, 1, 2)] for _ in range(2))
    assert all(map(np.array_equal, first, again))
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert np.abs(first[one] - first[other])[1:].max() > 1e-3
    kept, info = start(env)
    assert np.array_equal(kept, first[2])
    assert info["scene_seed"] == 2
    fresh = LiberoEnv(str(env._ref.bddl), settle=0)
    assert np.array_equal(start(fresh, seed=1)[0], first[1])
    fresh.close()


@pytest.mark.parametrize("seed", [0, 3])
def test_a_seeded_start_is_the_one_of_libero_s_own_reset(env, seed):
    from runtime.worlds.libero.simulator.native import NativeTask

    ours, _ = start(env, seed=seed)
    with NativeTask(env._ref.bddl, seed) as native:
        flat = np.concatenate([[native.data.time], native.data.qpos, native.data.qvel])
        theirs = np.concatenate([flat, native.model.body_pos.ravel(), native.model.body_quat.ravel()])
    assert np.array_equal(ours, theirs)


def test_what_advances_goes_through_seeds(task):
    from runtime.worlds.libero.gym.environment import LiberoEnv

    made = LiberoEnv(str(task), advance=2, settle=0)
    assert [start(made, seed=5)[1]["scene_seed"], start(made)[1]["scene_seed"]] == [5, 7]
    made.close()
    made = LiberoEnv(str(task), advance="random", settle=0)
    drawn = [start(made, seed=5)[1]["scene_seed"], *(start(made)[1]["scene_seed"] for _ in range(3))]
    assert len(set(drawn)) == 4
    assert drawn[0] == 5
    assert [start(made, seed=5)[1]["scene_seed"], *(start(made)[1]["scene_seed"] for _ in range(3))] == drawn
    made.close()
