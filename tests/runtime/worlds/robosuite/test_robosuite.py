"""robosuite's own tasks: truth is its success check, repair by state, commands, and Gymnasium."""

import json
from functools import cache

import gymnasium
import numpy as np
import pytest

from benchmarks.robosuite import COUNTS, Agreement, _Prober, run, trials
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.cli import main
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.robosuite.world import SUITE, WORLD
from runtime.worlds.world import find_task, named_task

pytestmark = pytest.mark.sim
TASKS = [ref.name for ref in WORLD.tasks(SUITE)]
UNSERVED = {"Lift"}  # a cube that is written into the air falls: no proposer of states serves it


@cache
def runner(name):
    return EpisodeRunner.open(WORLD, find_task(SUITE, WORLD.tasks(SUITE), name), load_knowledge())


def told(capsys, *arguments):
    code = main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, err


def test_there_are_four_tasks_of_robosuites_own_names():
    assert TASKS == ["Lift", "Stack", "PickPlaceCan", "Door"]
    assert named_task("robosuite/3")[1] == named_task("robosuite/Door")[1]


@pytest.mark.parametrize("name", TASKS)
def test_truth_and_sign_are_robosuites_success(name):
    """On random, settled and threshold states; ``onto bench robosuite`` publishes as much on hundreds."""
    opened = runner(name)
    environment = opened.environment
    environment.start(0)
    base = environment.task.snapshot()
    prober = _Prober(environment, opened.required, np.random.default_rng(7))
    opened.correct(0)
    prober.starts.append(environment.qpos)
    ends = [environment.qpos, *prober.thrown(base, 300)]
    prober.thresholds(base, ends, 12)
    assert (prober.row["differences"], prober.row["wrong_signs"]) == (0, 0)
    assert (prober.row["random"], prober.row["threshold"]) == (300, 24)
    assert 0 < prober.row["true_states"] < prober.row["states"]
    assert set(prober.decided) == {str(fact) for fact in opened.required.facts}  # each of them decides somewhere


@pytest.mark.parametrize("name", TASKS)
def test_repair_is_judged_by_robosuite(name):
    episode = runner(name).run(0)
    assert episode.premise_holds
    assert episode.accepted is (name not in UNSERVED)
    assert episode.outcome == ("unresolved" if name in UNSERVED else "accepted")
    if episode.accepted:
        assert (episode.verification.query, len(episode.attempts)) == ("_check_success()", 1)
    assert dict(episode.provenance)["robosuite"] == "1.4.0"


def test_an_initial_state_is_drawn_from_seed_and_number():
    environment = runner("Stack").environment
    found = []
    for index in (0, 1, 0):
        environment.start(index)
        found.append(environment.qpos)
    assert np.array_equal(found[0], found[2])
    assert not np.array_equal(found[0], found[1])


@pytest.mark.parametrize("name", TASKS)
def test_an_initial_state_has_the_same_future_whatever_was_done_before(name):
    """Its gripper's current action included, which robosuite's reset leaves as the last episode had it."""
    random = np.random.default_rng(0)
    actions, closing = random.uniform(-1, 1, (2, 8, 7))
    closing[:, 6] = 1.0
    task, ends = runner(name).environment.task, []
    fresh = EpisodeRunner.open(WORLD, find_task(SUITE, WORLD.tasks(SUITE), name), load_knowledge()).environment.task
    for each in (fresh, task, task):
        each.reset(2)
        for action in actions:
            each.step(action)
        ends.append(each.snapshot())
        for action in closing:
            each.step(action)
    fresh.close()
    for end in ends[1:]:
        assert np.array_equal(end.integration, ends[0].integration)
        assert np.array_equal(end.gripper_action, ends[0].gripper_action)


def test_a_flat_state_of_ones_own_is_written():
    environment = runner("Door").environment
    environment.start(0)
    state = np.concatenate([[0.0], environment.qpos, environment.qvel])
    environment.start(0, state)
    assert np.allclose(environment.qpos, state[1 : 1 + len(environment.qpos)], atol=0.05)
    for broken, code in ((state[:-1], "SIM004"), (np.full_like(state, np.nan), "SIM003")):
        with pytest.raises(OntoError) as raised:
            environment.start(0, broken)
        assert raised.value.problems[0].code == code


def test_a_snapshot_brings_the_same_future():
    task = runner("Stack").environment.task
    task.reset(2)
    saved, ends = task.snapshot(), []
    for _ in range(2):
        task.restore(saved)
        for action in np.random.default_rng(0).uniform(-1, 1, (5, 7)):
            task.step(action)
        ends.append(task.data.qpos.copy())
    assert np.array_equal(*ends)


def test_the_commands_open_its_tasks(capsys):
    code, out, _ = told(capsys, "ground", "robosuite/Lift", "--json")
    record = json.loads(out)
    (fact,) = record["facts"]
    assert (code, record["suite"], record["native_success"]) == (CLEAN, "robosuite", False)
    assert (fact["predicate"], fact["arguments"], fact["polarity"], fact["unit"]) == (
        "at_level",
        ["cube", "table_top"],
        False,
        "m",
    )
    code, out, _ = told(capsys, "diagnose", "robosuite/0", "--json")
    (found,) = json.loads(out)["diagnoses"]
    assert (code, found["failure"], found["truth"]) == (FINDINGS, "predicate_mismatch", True)
    code, out, _ = told(capsys, "repair", "robosuite/Door", "--json")
    assert (code, json.loads(out)["outcome"]) == (CLEAN, "accepted")


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["ground", "robosuit/Lift"], "SIM011", "did you mean `robosuite`?"),
        (["ground", "robosuite/Lif"], "SIM012", "did you mean `Lift`?"),
        (["ground", "robosuite/9"], "SIM012", "it has 4 tasks, from 0"),
        (["ground", "robosuite"], "CLI004", "`robosuite` is a suite of 4 tasks"),
        (["ground", "robosuite/Door", "--state", "50"], "SIM017", "it has 50, from 0"),
        (["play", "robosuite/Door"], "SIM011", "LIBERO has no suite `robosuite`"),
    ],
)
def test_a_mistake_is_told(capsys, arguments, code, says):
    status, _, err = told(capsys, *arguments)
    assert (status, f"error[{code}]" in err, says in err) == (MISUSE, True, True)


def test_a_task_file_of_ones_own_names_an_environment(capsys, tmp_path):
    text = WORLD.tasks(SUITE)[3].bddl.read_text()
    path = tmp_path / "mine.bddl"
    path.write_text(text.replace("(Open Door_hinge)\n  )\n)", "(Not (Open Door_hinge))\n  )\n)"))
    code, out, _ = told(capsys, "ground", str(path), "--json")
    assert (code, json.loads(out)["facts"][0]["satisfied"]) == (CLEAN, True)
    path.write_text(text.replace("(problem Door)", "(problem Doer)"))
    status, _, err = told(capsys, "ground", str(path))
    assert (status, "error[SIM016]" in err, "did you mean `door`?" in err) == (MISUSE, True, True)


def test_gymnasium_makes_its_tasks():
    env = gymnasium.make("runtime.worlds.robosuite.gym:onto/Robosuite-v0", task="robosuite/PickPlaceCan", horizon=2)
    seen, info = env.reset(seed=3)
    assert env.observation_space.contains(seen)
    assert (info["state_index"], info["success"], info["judge"]) == (3, False, "native")
    (failure,) = info["failures"]
    assert (failure["predicate"], failure["failure"]) == ("inside", "relation_missing")
    ends = [env.step(np.zeros(7, np.float32))[2:4] for _ in range(2)]
    assert ends == [(False, False), (False, True)]
    with pytest.raises(OntoError):
        env.reset(options={"state_indx": 3})
    with pytest.raises(OntoError):
        env.unwrapped.step(np.full(7, np.nan))
    env.close()


def test_the_protocol_lists_every_task():
    full = trials(full=True)
    assert {trial["task"] for trial in full if trial["kind"] == "states"} == set(TASKS)
    assert len(full) == 1 + 4 * (1 + COUNTS[True].repairs)
    assert isinstance(COUNTS[False], Agreement)
    (row,) = run(full[0])
    assert row["files"] == []
