"""A protocol runs part by part, and its result says of each part which run made it."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess

import pytest

from benchmarks import results
from benchmarks.parts import chosen_trials, joined
from benchmarks.protocol import Protocol
from benchmarks.results import made_by, read_result, write_result
from onto_compiler.problems import OntoError

GIT = shutil.which("git") or "git"
TRIALS = [{"key": f"{suite}/{n}", "suite": suite, "n": n} for suite in ("a", "b", "c") for n in range(2)]


def total(rows):
    return {"sum": sum(row["n"] for row in rows)}


PROTOCOL = Protocol("parted", "parted", (0,), lambda _: TRIALS, lambda trial: [dict(trial)], total, parts="suite")


def run(folder, *parts, value=0):
    """One run, whose rows carry ``value``."""
    rows = [{**trial, "value": value} for trial in chosen_trials(PROTOCOL, TRIALS, parts)]
    command = f"onto bench parted {value}"
    every, origins = joined(folder / "parted.json", PROTOCOL, TRIALS, rows, made_by(command))
    return read_result(write_result(folder, PROTOCOL, every, command, parts=origins))


def test_without_a_name_everything_runs():
    assert list(chosen_trials(PROTOCOL, TRIALS, [])) == TRIALS


def test_only_the_trials_of_the_named_parts_run():
    assert [trial["key"] for trial in chosen_trials(PROTOCOL, TRIALS, ["c", "a"])] == ["a/0", "a/1", "c/0", "c/1"]


@pytest.mark.parametrize(
    ("protocol", "name", "hint"),
    [
        (PROTOCOL, "d", "one of: a, b, c"),
        (dataclasses.replace(PROTOCOL, parts=""), "a", "leave out --part"),
    ],
)
def test_a_part_that_is_not_there_is_a_problem(protocol, name, hint):
    with pytest.raises(OntoError) as caught:
        chosen_trials(protocol, TRIALS, [name])
    (problem,) = caught.value.problems
    assert problem.code == "BEN005"
    assert hint in problem.hint


def test_parts_come_together_in_the_order_of_the_trials_each_with_its_own_run(tmp_path):
    run(tmp_path, "b", value=1)
    record = run(tmp_path, "a", value=2)
    assert [(row["key"], row["value"]) for row in record["rows"]] == [("a/0", 2), ("a/1", 2), ("b/0", 1), ("b/1", 1)]
    assert {name: part["command"][-1] for name, part in record["parts"].items()} == {"a": "2", "b": "1"}
    assert record["metrics"] == {"sum": 2}


def test_a_part_that_runs_again_is_replaced_whole(tmp_path):
    run(tmp_path, "a", "b", value=1)
    record = run(tmp_path, "b", value=2)
    assert [row["value"] for row in record["rows"]] == [1, 1, 2, 2]
    assert record["parts"]["a"]["command"].endswith("1")
    assert record["parts"]["b"]["command"].endswith("2")


def test_a_published_part_does_not_make_the_next_one_dirty(tmp_path, monkeypatch):
    """Results are no code; anything else that differs from the commit counts."""
    result, code = tmp_path / "benchmarks" / "results" / "parted.json", tmp_path / "code.py"
    result.parent.mkdir(parents=True)
    for file in (result, code):
        file.write_text("1")
    author = ["-c", "user.name=t", "-c", "user.email=t@example.org"]
    for command in (["init", "-q"], ["add", "."], [*author, "commit", "-q", "-m", "Begin"]):
        subprocess.run([GIT, "-C", str(tmp_path), *command], check=True)
    monkeypatch.setattr(results, "__file__", str(result.parent.parent / "results.py"))
    assert results.changed() is False
    result.write_text("2")
    assert results.changed() is False
    code.write_text("2")
    assert results.changed() is True


def test_a_whole_run_keeps_nothing(tmp_path):
    run(tmp_path, "a", value=1)
    record = run(tmp_path, value=2)
    assert [row["value"] for row in record["rows"]] == [2] * 6
