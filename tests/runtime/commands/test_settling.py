"""A repair ends with success only where the state stays right: what slides or falls away is corrected again."""

import json

import numpy as np
import pytest

from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.knowledge import load_knowledge
from runtime.cli import main
from runtime.trace.store import open_trace
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.libero.simulator.assets import initial_states
from runtime.worlds.world import named_task

pytestmark = pytest.mark.sim
PLATE = "libero_goal/8"
SPEED = 2.0  # m/s


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture(scope="module")
def runner():
    made = EpisodeRunner.open(*named_task(PLATE), load_knowledge(), seed=0)
    yield made
    made.close()


@pytest.fixture(scope="module")
def official(runner):
    return initial_states(runner.ref)[0]


@pytest.fixture(scope="module")
def sliding(runner, tmp_path_factory):
    """A file with the bowl on the plate and about to leave it: LIBERO accepts the state, and not what becomes of it."""
    task = runner.environment.task
    runner.run(0)
    assert task.success()
    task.settle(20)
    dof = task.env.sim.model.get_joint_qvel_addr("akita_black_bowl_1_joint0")[0]
    qvel = task.data.qvel.copy()
    qvel[dof + 1] = SPEED
    state = np.concatenate([[task.data.time], task.data.qpos, qvel])
    task.reset_to(state)
    assert task.success()
    task.settle(20)
    assert not task.success()
    path = tmp_path_factory.mktemp("state") / "sliding.npy"
    np.save(path, state)
    return str(path)


def test_a_start_that_does_not_survive_settling_is_corrected(capsys, sliding, tmp_path):
    code, out, _ = run(capsys, "repair", PLATE, "--state-file", sliding, "--json", "--out", str(tmp_path))
    record = json.loads(out)
    assert (code, record["outcome"], record["settled"]) == (CLEAN, "accepted", True)
    assert record["attempts"] >= 1
    assert record["provenance"]["start_lost_settling"] == 20
    episode = open_trace(tmp_path / "trace.trig")
    (iri,) = episode.episodes()
    assert episode.episode(iri).verification.settled is True


def test_within_no_budget_it_is_unresolved_with_the_reason(capsys, sliding):
    code, out, _ = run(capsys, "repair", PLATE, "--state-file", sliding, "--budget", "0", "--json")
    record = json.loads(out)
    assert (code, record["outcome"], record["accepted"]) == (FINDINGS, "unresolved", False)
    assert record["verification"]["outcome"] is True
    assert record["settled"] is False
    assert record["reason"].endswith("the last state that was accepted did not survive 20 steps of settling")
    _, out, _ = run(capsys, "repair", PLATE, "--state-file", sliding, "--budget", "0")
    assert "Reason: the last state that was accepted did not survive 20 steps" in out


def test_a_candidate_that_does_not_survive_settling_is_rejected_and_the_next_one_accepted(
    capsys, runner, official, tmp_path
):
    """The bowl is put on a plate that slides away below it; when the plate has come to rest, it stays there."""
    task = runner.environment.task
    task.reset_to(official)
    task.settle()
    dof = task.env.sim.model.get_joint_qvel_addr("plate_1_joint0")[0]
    qvel = task.data.qvel.copy()
    qvel[dof] = 3 * SPEED
    path = tmp_path / "sliding.npy"
    np.save(path, np.concatenate([[task.data.time], task.data.qpos, qvel]))
    code, out, _ = run(capsys, "repair", PLATE, "--state-file", str(path), "--json", "--out", str(tmp_path))
    record = json.loads(out)
    assert (code, record["outcome"], "reason" in record) == (CLEAN, "accepted", False)
    verdicts = [(each["verification"]["outcome"], each["verification"]["settled"]) for each in record["history"]]
    assert verdicts[0] == (True, False)
    assert verdicts[-1] == (True, True)
    assert record["history"][1]["decision"] in {"retry", "reroute"}
    trace = open_trace(tmp_path / "trace.trig")
    read = trace.episode(trace.episodes()[0])
    assert [(each.verification.outcome, each.verification.settled) for each in read.attempts] == verdicts
