"""``onto play`` as a person meets it: mistakes, exit codes, and what it leaves behind."""

import json
import subprocess
import sys

import numpy as np
import pytest

from onto_compiler.command import FINDINGS, MISUSE
from runtime.cli import main
from runtime.trace.store import open_trace

pytestmark = pytest.mark.sim


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_an_episode_that_is_cut_short_is_told_kept_and_no_success(capsys, tmp_path):
    out = tmp_path / "out"
    code, printed, _ = run(capsys, "play", "libero_goal/8", "--horizon", "30", "--json", "--out", str(out))
    record = json.loads(printed)
    assert code == FINDINGS
    assert (record["outcome"], record["accepted"]) == ("unresolved", False)
    (turn,) = record["history"]
    assert (turn["mode"], turn["steps"], turn["end"]) == ("controller", 30, "out_of_steps")
    assert (turn["route"], turn["proposer"]) == ("pick_and_place", "geometry")
    assert record["provenance"]["control_steps"] == record["provenance"]["horizon"] == 30
    (kept,) = (out / "actions").glob("*.npz")
    assert kept.stem.startswith("play-libero_goal-put_the_bowl_on_the_plate-")
    with np.load(kept, allow_pickle=False) as arrays:
        assert arrays["actions"].shape == (30, 7)
        assert len(arrays["qpos"]) == 31
        assert arrays["bounds"].tolist() == [0, 30]
    assert len(open_trace(out / "trace.trig").episodes()) == 1
    code, told, _ = run(capsys, "trace", "show", "1", str(out / "store"))
    assert "in 30 control steps until the steps of the episode were spent" in " ".join(told.split())


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (("libero_goal/8", "--horizon", "0"), "CLI002", "0 control steps; give 1 or more"),
        (("libero_goal/8", "--horizon", "soon"), "CLI002", "`soon` is not a number of control steps"),
        (("libero_goal/8", "--film", "strip.gif"), "CLI002", "ends in none of .html, .jpg, .png"),
        (("libero_goal/8", "--candidates", "random"), "CLI002", "geometry"),
        (("libero_goal/99",), "SIM012", "10 tasks"),
        (("libero_goal",), "CLI004", "libero_goal"),
        (("libero_goal/8", "--out", "file"), "TRC001", "file"),
    ],
)
def test_a_mistake_is_said_before_anything_is_built(capsys, tmp_path, monkeypatch, arguments, code, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    status, out, err = run(capsys, "play", *arguments)
    assert status == MISUSE
    assert out == ""
    assert f"error[{code}]" in err
    assert says in err


def test_a_film_that_cannot_be_written_leaves_the_episode_told(tmp_path):
    (tmp_path / "file").write_text("")
    # MuJoCo settles how it draws when it is first imported, so that this needs a process of its own.
    program = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"
    words = ["play", "libero_goal/8", "--horizon", "3", "--film", str(tmp_path / "file" / "strip.png")]
    done = subprocess.run([sys.executable, "-c", program, *words], capture_output=True, text=True, check=False)
    if "error[SIM031]" in done.stderr:
        pytest.skip("no picture can be drawn on this machine")
    assert done.returncode == MISUSE
    assert "\n  3 of 3 control steps in 1 attempt, reactive play; 0 rehearsed\n" in done.stdout
    assert "error[TRC001]" in done.stderr
