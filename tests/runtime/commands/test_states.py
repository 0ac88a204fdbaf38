"""A state that is given is judged as it is; what was settled before a verdict is said with it."""

import json

import numpy as np
import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from runtime.cli import main
from runtime.worlds.libero.simulator.assets import find_task, initial_states

pytestmark = pytest.mark.sim
ABOVE = 0.20
PLATE = "libero_goal/8"


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


@pytest.fixture(scope="module")
def falling(tmp_path_factory):
    """A file with the bowl in the air, 20 cm above the plate: ten steps later it has fallen there."""
    from runtime.worlds.libero.simulator.native import NativeTask

    ref = find_task("libero_goal", 8)
    with NativeTask.open(ref) as native:
        native.reset_to(initial_states(ref)[0])
        native.settle()
        index = native.env.sim.model
        bowl = index.get_joint_qpos_addr("akita_black_bowl_1_joint0")[0]
        plate = index.get_joint_qpos_addr("plate_1_joint0")[0]
        qpos = native.data.qpos.copy()
        qpos[bowl : bowl + 3] = np.add(qpos[plate : plate + 3], [0.0, 0.0, ABOVE])
        native.write_qpos(qpos)
        state = np.concatenate([[native.data.time], native.data.qpos, native.data.qvel])
        assert not native.success()
        native.settle()
        assert native.success()
    path = tmp_path_factory.mktemp("state") / "falling.npy"
    np.save(path, state)
    return str(path)


def test_a_given_state_is_judged_as_it_is(capsys, falling):
    code, out, _ = run(capsys, "diagnose", PLATE, "--state-file", falling, "--json")
    record = json.loads(out)
    assert (code, record["settle_steps"]) == (FINDINGS, 0)
    (row,) = record["diagnoses"]
    assert row["margin"] == pytest.approx(-ABOVE, abs=0.05)
    _, out, _ = run(capsys, "diagnose", PLATE, "--state-file", falling)
    assert out.startswith("put_the_bowl_on_the_plate, a given state, not settled: 1 unmet of 1 required\n")
    _, out, _ = run(capsys, "ground", PLATE, "--state-file", falling, "--json")
    record = json.loads(out)
    assert (record["settle_steps"], record["native_success"], record["facts"][0]["truth"]) == (0, False, False)


def test_settling_a_given_state_is_an_option_and_is_said(capsys, falling):
    code, out, _ = run(capsys, "diagnose", PLATE, "--state-file", falling, "--settle", "10")
    assert code == CLEAN
    assert out.startswith("put_the_bowl_on_the_plate, a given state, settled for 10 steps: no unmet")
    _, out, _ = run(capsys, "diagnose", PLATE, "--state-file", falling, "--settle", "1", "--json")
    record = json.loads(out)
    assert record["settle_steps"] == 1
    assert len(record["diagnoses"]) == 1


def test_an_official_state_settles_for_ten_steps_unless_another_number_is_asked_for(capsys):
    _, out, _ = run(capsys, "ground", PLATE)
    assert out.startswith("put_the_bowl_on_the_plate, state 0, settled for 10 steps\n")
    _, out, _ = run(capsys, "ground", PLATE, "--settle", "0", "--json")
    assert json.loads(out)["settle_steps"] == 0


def test_the_record_of_a_repair_says_how_its_start_was_settled(capsys, falling, tmp_path):
    from runtime.trace.store import open_trace

    code, out, _ = run(capsys, "repair", PLATE, "--state-file", falling, "--json", "--out", str(tmp_path))
    told = json.loads(out)
    assert (code, told["outcome"], told["attempts"]) == (CLEAN, "accepted", 1)
    assert told["provenance"]["start_settle_steps"] == 0
    trace = open_trace(tmp_path / "trace.trig")
    assert dict(trace.episode(trace.episodes()[0]).provenance)["start_settle_steps"] == 0
    _, out, _ = run(capsys, "repair", PLATE, "--state-file", falling, "--settle", "10")
    assert "The start was settled for 10 steps." in out


@pytest.mark.parametrize("number", ["-1", "ten", "1.5"])
def test_a_number_of_steps_that_is_none_is_refused(capsys, number):
    status, _, err = run(capsys, "ground", PLATE, "--settle", number)
    assert (status, "error[CLI002]" in err) == (MISUSE, True)


def test_the_gymnasium_environment_judges_a_given_state_as_it_is(falling):
    from onto_compiler.problems import OntoError
    from runtime.worlds.libero.gym.environment import LiberoEnv

    made = LiberoEnv(PLATE)
    state = np.load(falling)
    _, info = made.reset(options={"state": state})
    assert (info["settle_steps"], info["success"]) == (0, False)
    assert np.array_equal(made.simulation.flat_state, state)
    assert info["failures"][0]["margin"] == pytest.approx(-ABOVE, abs=0.05)
    _, info = made.reset()  # the state asked for last, as it was asked for
    assert (info["settle_steps"], info["success"]) == (0, False)
    _, info = made.reset(options={"state": state, "settle": 10})
    assert (info["settle_steps"], info["success"]) == (10, True)
    _, info = made.reset(options={"state_index": 0})
    assert info["settle_steps"] == 10
    with pytest.raises(OntoError, match="settle is `-1`"):
        made.reset(options={"state": state, "settle": -1})
    made.close()
