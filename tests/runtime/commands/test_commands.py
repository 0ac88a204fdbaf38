"""The commands as a person meets them: what they print, how they exit, and what a mistake costs."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from runtime.cli import main
from runtime.trace.narrate import outcome_sentence
from runtime.trace.store import open_trace
from runtime.trace.summary import verdict
from runtime.worlds.libero.simulator.assets import find_task, initial_states

pytestmark = pytest.mark.sim
# A shell that runs the tests in the background lets its children ignore SIGINT.
HEAR = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
ROOT = Path(__file__).resolve().parents[3]
PROGRAM = HEAR + "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"
INTERRUPTED = 130


def run(capsys, *arguments):
    code = main(list(arguments))
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_ground_tells_truth_margin_and_premise(capsys):
    code, out, _ = run(capsys, "ground", "libero_goal/8", "--json")
    record = json.loads(out)
    assert code == CLEAN
    (fact,) = record["facts"]
    assert (fact["predicate"], fact["arguments"]) == ("on", ["akita_black_bowl_1", "plate_1"])
    assert (fact["truth"], fact["status"], fact["unit"]) == (False, "explicitly false", "m")
    assert fact["margin"] < -0.05
    assert record["native_success"] is False
    assert len(record["premise"]) == 7
    assert all(row["satisfied"] for row in record["premise"])


def test_ground_prints_for_people_within_eighty_columns_where_names_allow(capsys):
    code, out, _ = run(capsys, "ground", "libero_goal/7")
    assert code == CLEAN
    assert "no  joint_state(flat_stove_1, flat_stove_on): -0.5 rad (qpos), explicitly false" in out
    assert "the native check says no success" in out


SERVED = ["docs/examples/serve_the_cheese.bddl", "--ontology", "docs/examples/served.ttl"]


def test_a_repair_without_a_native_judge_names_the_option_that_lets_grounding_accept(capsys, monkeypatch):
    monkeypatch.chdir(ROOT)
    code, out, err = run(capsys, "repair", *SERVED)
    assert (code, out) == (MISUSE, "")
    assert "SIM018" in err
    assert "--judge grounding" in err


def test_grounding_accepts_where_it_is_asked_to_and_everything_says_so(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(ROOT)
    code, out, _ = run(capsys, "repair", *SERVED, "--judge", "grounding", "--out", str(tmp_path), "--json")
    record = json.loads(out)
    assert code == CLEAN
    assert (record["accepted"], record["settled"], record["judge"]) == (True, True, "grounding")
    (episode,) = [open_trace(tmp_path / "store").episode(iri) for iri in open_trace(tmp_path / "store").episodes()]
    assert episode.judge == "grounding"
    assert outcome_sentence(episode).endswith("No native predicate was asked.")
    assert verdict(episode) == "accepted by grounding"


def test_diagnose_orders_a_task_of_two_facts(capsys):
    code, out, _ = run(capsys, "diagnose", "libero_10/2", "--json")
    rows = json.loads(out)["diagnoses"]
    assert code == FINDINGS
    assert [(r["predicate"], r["failure"], r["route"], r["selected"]) for r in rows] == [
        ("joint_state", "joint_state", "source_joint_pose", True),
        ("on", "relation_missing", "object_relation_predicate", False),
    ]


@pytest.mark.parametrize(
    ("goal", "success"),
    [
        ("(Or (On akita_black_bowl_1 plate_1) (On wine_bottle_1 plate_1))", False),
        ("(And (Not (On akita_black_bowl_1 plate_1)))", True),
        ("(And (exists (?p - plate) (Or (Not (On cream_cheese_1 ?p)) (On wine_bottle_1 ?p))))", True),
        ("(And (forall (?p - plate) (On akita_black_bowl_1 ?p)) (Not (On wine_bottle_1 plate_1)))", False),
    ],
)
def test_a_goal_with_connectives_is_judged_by_libero_atom_by_atom(capsys, tmp_path, goal, success):
    head, _, _ = find_task("libero_goal", "put_the_bowl_on_the_plate").bddl.read_text("utf-8").partition("(:goal")
    task = tmp_path / "composed.bddl"
    task.write_text(f"{head}(:goal {goal}))", "utf-8")
    _, out, _ = run(capsys, "ground", str(task), "--json")
    assert json.loads(out)["native_success"] is success
    code, out, _ = run(capsys, "repair", str(task), "--json", "--out", str(tmp_path / "out"))
    assert code == CLEAN
    record = json.loads(out)
    assert record["outcome"] == ("verified" if success else "accepted")


def test_diagnose_speaks_of_the_nearest_alternative_and_of_the_others_when_asked(capsys, tmp_path):
    text = Path("docs/examples/serve_the_cheese.bddl").read_text("utf-8")
    task = tmp_path / "either.bddl"
    bowl = "(And (On akita_black_bowl_1 ?p) (Not (On cream_cheese_1 ?p)))"
    goal = f"(exists (?p - plate) (Or (On cream_cheese_1 ?p) {bowl}))"
    task.write_text(f"{text[: text.index('(:goal')]}(:goal {goal})\n)\n", "utf-8")
    code, out, _ = run(capsys, "diagnose", str(task))
    assert code == FINDINGS
    assert out.startswith(
        "either, state 0, settled for 10 steps: 1 unmet of 2 required, by the nearest of 2 alternatives\n"
    )
    assert "alternative 2" not in out
    code, out, _ = run(capsys, "diagnose", str(task), "--alternatives", "--json")
    record = json.loads(out)
    assert record["alternatives"] == [["on(akita_black_bowl_1, plate_1)"], ["on(cream_cheese_1, plate_1)"]]
    assert [row["arguments"] for row in record["diagnoses"]] == [["akita_black_bowl_1", "plate_1"]]


def test_repair_records_what_it_tells(capsys, tmp_path):
    code, out, _ = run(capsys, "repair", "libero_goal/0", "--json", "--out", str(tmp_path / "out"))
    told = json.loads(out)
    assert (code, told["accepted"], told["settled"]) == (CLEAN, True, True)
    trace = open_trace(tmp_path / "out" / "trace.trig")
    (iri,) = trace.episodes()
    episode = trace.episode(iri)
    assert (episode.task, episode.outcome, len(episode.attempts)) == (told["task"], "accepted", told["attempts"])


def test_a_budget_of_nothing_is_a_finding(capsys):
    code, out, _ = run(capsys, "repair", "libero_goal/0", "--budget", "0", "--json")
    assert (code, json.loads(out)["outcome"]) == (FINDINGS, "unresolved")


def test_the_same_run_makes_the_same_trace(capsys, tmp_path):
    for name in ("a", "b"):
        run(capsys, "repair", "libero_goal/4", "--out", str(tmp_path / name))
    assert (tmp_path / "a/trace.trig").read_bytes() == (tmp_path / "b/trace.trig").read_bytes()


def state_file(tmp_path, state):
    path = tmp_path / "state.npy"
    np.save(path, state)
    return str(path)


def official():
    return np.array(initial_states(find_task("libero_goal", 8))[0])


def test_a_state_of_ones_own(capsys, tmp_path):
    path = state_file(tmp_path, official())
    code, out, _ = run(capsys, "ground", "libero_goal/8", "--json", "--state-file", path)
    assert code == CLEAN
    record = json.loads(out)
    assert record["facts"][0]["truth"] is False
    assert record["state"] == -1
    _, out, _ = run(capsys, "diagnose", "libero_goal/8", "--state-file", path)
    assert out.startswith("put_the_bowl_on_the_plate, a given state, not settled: 1 unmet of 1 required\n")
    status, out, _ = run(capsys, "repair", "libero_goal/8", "--state-file", path)
    assert status == CLEAN
    assert re.match(r"put_the_bowl_on_the_plate \(libero_goal, a given state [0-9a-f]{12}, seed 0\)\n", out)


@pytest.mark.parametrize(
    "task", [["libero_goal/8"], ["libero_goal", "8"], ["libero_goal", "put_the_bowl_on_the_plate"]]
)
def test_suite_and_task_are_one_word_or_two(capsys, task):
    status, out, _ = run(capsys, "diagnose", *task, "--state", "2")
    assert status == FINDINGS
    assert out.startswith("put_the_bowl_on_the_plate, state 2, settled for 10 steps: 1 unmet of 1 required\n")


def test_a_state_is_an_official_one_or_a_given_one(capsys, tmp_path):
    path = state_file(tmp_path, official())
    status, _, err = run(capsys, "diagnose", "libero_goal/8", "--state", "3", "--state-file", path)
    assert (status, "error[CLI002]" in err) == (MISUSE, True)


@pytest.mark.parametrize("share", [0.0, 0.05, 0.9])
def test_a_state_file_that_was_cut_off_is_refused(capsys, tmp_path, share):
    path = Path(state_file(tmp_path, official()))
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    status, _, err = run(capsys, "diagnose", "libero_goal/8", "--state-file", str(path))
    assert (status, "error[CLI005]" in err) == (MISUSE, True)


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (
            ["ground", "libero_goal"],
            "CLI004",
            "`libero_goal` is a suite of 10 tasks: write libero_goal/0 for the first",
        ),
        (["ground", "libero_gaol"], "CLI004", "did you mean `libero_goal`?"),
        (["ground", "something"], "CLI004", "write SUITE/INDEX, such as libero_goal/8"),
        (["ground", "nothing.bddl", "3"], "CLI004", "`nothing.bddl/3` names no task"),
        (["ground", "libero_gaol/8"], "SIM011", "did you mean `libero_goal`"),
        (["ground", "libero_goal/99"], "SIM012", "10 tasks"),
        (["ground", "libero_goal/put_the_bowl_on_the_plat"], "SIM012", "did you mean `put_the_bowl_on_the_plate`"),
        (["ground", "libero_goal/8", "--state", "50"], "SIM017", "it has 50"),
        (["ground", "nothing.bddl"], "BDDL", "nothing.bddl"),
        (["ground", "libero_goal/8", "--state-file", "nothing.npy"], "CLI005", "nothing.npy"),
        (["diagnose", "libero_goal/8", "--ontology", "nothing.ttl"], "TTL002", "nothing.ttl"),
        (["demo", "--suite", "libero_gaol"], "SIM011", "did you mean `libero_goal`"),
        (["bench", "demoo"], "BEN001", "did you mean `demo`"),
    ],
)
def test_a_mistake_has_a_code_a_sentence_and_no_traceback(capsys, tmp_path, monkeypatch, arguments, code, says):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(capsys, *arguments)
    assert status == MISUSE
    assert out == ""
    assert f"error[{code}" in err
    assert says in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("state", "code"),
    [
        (np.zeros(12), "SIM004"),
        (np.full(79, np.nan), "SIM003"),
        (np.array(["a", "b"]), "CLI005"),
    ],
)
def test_a_state_that_is_none_is_refused(capsys, tmp_path, state, code):
    status, _, err = run(capsys, "repair", "libero_goal/8", "--state-file", state_file(tmp_path, state))
    assert (status, f"error[{code}]" in err) == (MISUSE, True)


def test_a_pickled_state_is_refused(capsys, tmp_path):
    path = tmp_path / "state.npy"
    np.save(path, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    status, _, err = run(capsys, "ground", "libero_goal/8", "--state-file", str(path))
    assert (status, "error[CLI005]" in err) == (MISUSE, True)


def test_an_object_that_libero_lacks_is_named(capsys, tmp_path):
    text = find_task("libero_goal", 8).bddl.read_text()
    path = tmp_path / "odd.bddl"
    path.write_text(text.replace("plate_1 - plate", "plate_1 - unobtainium_plate"))
    status, _, err = run(capsys, "ground", str(path))
    assert status == MISUSE
    assert "unobtainium_plate" in err
    assert "Traceback" not in err


def test_an_output_folder_that_cannot_be_written(capsys, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    status, _, err = run(capsys, "repair", "libero_goal/0", "--out", str(blocked / "out"))
    assert (status, "error[TRC001]" in err) == (MISUSE, True)


def program(*arguments, prelude="", **options):
    command = [sys.executable, "-c", prelude + PROGRAM, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def test_json_on_standard_output_is_json_only(tmp_path):
    done = program("repair", "libero_goal/0", "--json", cwd=tmp_path)
    out, _ = done.communicate(timeout=120)
    assert done.returncode == CLEAN
    assert json.loads(out)["accepted"] is True


INTERRUPT_AT_THE_SECOND = """
import os, signal
from runtime.trace.store import TraceStore
add, episodes = TraceStore.add, []
def interrupting(self, episode):
    episodes.append(episode)
    if len(episodes) == 2:
        os.kill(os.getpid(), signal.SIGINT)
    add(self, episode)
TraceStore.add = interrupting
"""


def test_an_interrupted_demo_keeps_what_it_recorded(tmp_path):
    running = program("demo", "--out", "out", prelude=INTERRUPT_AT_THE_SECOND, cwd=tmp_path)
    _, err = running.communicate(timeout=120)
    assert running.returncode == INTERRUPTED, err
    assert "interrupted" in err
    assert "Traceback" not in err
    assert len(open_trace(tmp_path / "out/trace.trig").episodes()) == 1
    assert (tmp_path / "out/report.html").read_text().startswith("<!doctype html>")


HIDDEN = """
import importlib.abc, sys
class Hide(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name in {hidden!r}:
            {action}
sys.meta_path.insert(0, Hide())
"""


def test_without_libero_the_command_that_installs_it_is_named(tmp_path):
    prelude = HIDDEN.format(hidden=["libero"], action="raise ModuleNotFoundError(name, name=name)")
    done = program("ground", "libero_goal/0", prelude=prelude, cwd=tmp_path)
    _, err = done.communicate(timeout=60)
    assert done.returncode == MISUSE
    assert "onto-evwm[sim]" in err
    assert "Traceback" not in err


def test_without_mujoco_the_extra_is_named(tmp_path):
    prelude = HIDDEN.format(hidden=["mujoco"], action="raise ModuleNotFoundError(name, name=name)")
    done = program("ground", "libero_goal/0", prelude=prelude, cwd=tmp_path)
    _, err = done.communicate(timeout=60)
    assert done.returncode == MISUSE
    assert "onto-evwm[sim]" in err


def test_without_a_system_library_for_windows_everything_else_works(tmp_path):
    prelude = HIDDEN.format(hidden=["cv2"], action="raise ImportError('libGL.so.1: cannot open shared object file')")
    done = program("diagnose", "libero_goal/0", "--json", prelude=prelude, cwd=tmp_path)
    out, _ = done.communicate(timeout=60)
    assert done.returncode == FINDINGS
    assert json.loads(out)["diagnoses"][0]["predicate"] == "joint_state"


def test_no_display_is_asked_for(tmp_path):
    environment = {k: v for k, v in os.environ.items() if k not in {"DISPLAY", "MUJOCO_GL", "PYOPENGL_PLATFORM"}}
    done = program("diagnose", "libero_goal/0", cwd=tmp_path, env=environment)
    done.communicate(timeout=60)
    assert done.returncode == FINDINGS


def test_compile_reports_each_file_and_goes_on(capsys, tmp_path):
    good = find_task("libero_goal", 8).bddl
    bad = tmp_path / "bad.bddl"
    bad.write_text(good.read_text().replace("(On akita_black_bowl_1 plate_1)", "(On akita_bowl_1 plate_1)"))
    code, out, _ = run(capsys, "compile", str(bad), str(good), "--json")
    record = json.loads(out)
    assert code == FINDINGS
    assert [task["task"] for task in record["tasks"]] == [Path(good).stem]
    (error,) = (p for p in record["problems"] if p["severity"] == "error")
    assert "akita_bowl_1" in error["message"]
    assert "akita_black_bowl_1" in error["hint"]
    assert error["line"] > 0
