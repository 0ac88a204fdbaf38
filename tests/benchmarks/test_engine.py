"""Trials are fanned out, kept, resumed, and published with what made them."""

import dataclasses
import json

import pytest

from benchmarks.engine import run_protocol
from benchmarks.intervals import wilson
from benchmarks.protocol import Protocol, alone
from benchmarks.results import read_result, write_result
from onto_compiler.problems import OntoError

TRIALS = [{"key": f"t{n}", "n": n} for n in range(6)]
CALLS = []


def square(trial):
    CALLS.append(trial["key"])
    if trial["n"] == 3:
        raise ValueError("three is broken")
    return [{"square": trial["n"] ** 2, "mode": "none", "sees": "privileged-state"}]


def timed(trial):
    return trial["n"] in {0, 4}


def total(rows):
    return {"total": sum(row.get("square", 0) for row in rows), "crashed": sum("crashed" in row for row in rows)}


def every(full):
    return TRIALS


PROTOCOL = Protocol("squares", "squares", (0,), every, square, total)


def run(path, jobs=1, trials=TRIALS, protocol=PROTOCOL):
    CALLS.clear()
    ticks = []
    rows = run_protocol(protocol, trials, path, jobs, lambda: ticks.append(1))
    assert len(ticks) == len(trials)
    return rows


def test_rows_come_in_the_order_of_the_trials_and_a_crash_is_one_of_them(tmp_path):
    rows = run(tmp_path / "rows.jsonl")
    assert [row["key"] for row in rows] == [trial["key"] for trial in TRIALS]
    assert [row.get("square") for row in rows] == [0, 1, 4, None, 16, 25]
    assert rows[3]["crashed"] == "ValueError: three is broken"
    assert all(row["seconds"] >= 0 for row in rows)


def test_processes_give_what_one_process_gives(tmp_path):
    one, two = run(tmp_path / "a.jsonl"), run(tmp_path / "b.jsonl", jobs=2)
    timeless = [[{k: v for k, v in row.items() if k != "seconds"} for row in rows] for rows in (one, two)]
    assert timeless[0] == timeless[1]


def test_trials_that_run_alone_stay_in_one_process(tmp_path):
    run(tmp_path / "rows.jsonl", jobs=2, protocol=dataclasses.replace(PROTOCOL, alone=alone))
    assert [trial["key"] for trial in TRIALS] == CALLS


def test_what_is_timed_waits_for_what_is_not(tmp_path):
    path = tmp_path / "rows.jsonl"
    rows = run(path, jobs=2, protocol=dataclasses.replace(PROTOCOL, alone=timed))
    assert CALLS == ["t0", "t4"]
    assert [json.loads(line)[0] for line in path.read_text().splitlines()][-2:] == CALLS
    assert [row["key"] for row in rows] == [trial["key"] for trial in TRIALS]


def test_a_run_resumes_where_it_stopped(tmp_path):
    path = tmp_path / "rows.jsonl"
    run(path, trials=TRIALS[:2])
    with path.open("a") as sink:
        sink.write('["t2", [{"key": "t2", "squ')  # cut off in the middle
    whole = path.read_text()
    path.write_text(whole + "\n")
    rows = run(path)
    assert CALLS == ["t2", "t3", "t4", "t5"]
    assert len(rows) == len(TRIALS)
    run(path)
    assert CALLS == []


def test_a_place_that_cannot_be_written_is_a_problem(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OntoError, match="BEN002"):
        run(tmp_path / "file" / "rows.jsonl")


@pytest.mark.parametrize("copies", [1, 50])
def test_a_result_reads_back_whole_and_its_metrics_are_those_of_its_rows(tmp_path, copies):
    rows = [dict(row) for _ in range(copies) for row in run(tmp_path / "rows.jsonl")]
    path = write_result(tmp_path, PROTOCOL, rows, "onto bench squares")
    record = read_result(path)
    assert record["rows"] == rows
    assert record["metrics"] == total(rows)
    assert {"protocol", "command", "commit", "dirty", "date", "machine", "seeds"} <= set(record)
    assert isinstance(json.loads(path.read_text())["rows"], str) == (copies > 1)
    first = {file.name: file.read_bytes() for file in tmp_path.glob("*.gz")}
    write_result(tmp_path, PROTOCOL, rows, "onto bench squares")
    assert {file.name: file.read_bytes() for file in tmp_path.glob("*.gz")} == first


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [(0, 0, 0.0, 1.0), (10, 10, 0.7225, 1.0), (0, 10, 0.0, 0.2775), (50, 100, 0.4038, 0.5962)],
)
def test_wilson_interval(successes, trials, low, high):
    assert wilson(successes, trials) == pytest.approx((low, high), abs=1e-4)
