"""Skills are played on states that development did not see, replayed natively, and counted suite by suite."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest

from benchmarks import skills
from benchmarks.protocol import untimed
from benchmarks.skills import SKILLS, before_retry, metrics
from benchmarks.skills_tables import skills_table

ON = "on(bowl, plate)"
UNMET = {"failure": "relation_missing", "fact": ON, "margin": -0.129, "unit": "m", "limit": "xy", "status": "false"}


class Tried(NamedTuple):
    fact: str
    steps: int


def row(suite="libero_goal", task=0, state=40, play="reactive", outcome="success", first=None, **more):
    success = outcome == "success"
    made = {
        "suite": suite,
        "task": task,
        "state": state,
        "play": play,
        "name": f"task_{task}",
        "horizon": 300,
        "steps": 80 + task,
        "rehearsed": 0 if play == "reactive" else 200,
        "success": success,
        "outcome": outcome,
        "accepted": outcome != "unmet",
        "settled": success,
        "grounded": outcome != "unmet",
        "success_step": 70 if success else None,
        "failures": [] if success else [UNMET],
        "premise_holds": True,
        "initially_true": False,
        "replayed_same": True,
        "tries": [{"fact": ON, "candidate": 1, "note": "", "steps": 80, "outcome": "held" if success else "missed"}],
        **more,
    }
    if play == "reactive":
        first = success if first is None else first
        made["first_try"] = {
            "steps": 40,
            "success": first,
            "outcome": "success" if first else "unmet",
            "success_step": 30 if first else None,
            "failures": [] if first else [UNMET],
        }
    return made


def crashed(state=42, play="reactive"):
    return {"suite": "libero_goal", "task": 0, "state": state, "play": play, "crashed": "Boom"}


def test_the_part_before_the_first_retry_ends_where_a_fact_is_tried_again():
    one, other = "on(a, b)", "closed(c)"
    assert before_retry([]) is None
    assert before_retry([Tried(one, 50), Tried(other, 60)]) is None
    assert before_retry([Tried(one, 50), Tried(other, 60), Tried(other, 70)]) == 110
    assert before_retry([Tried(one, 50), Tried(one, 50), Tried(other, 60)]) == 50


def test_rates_are_of_the_suites_that_were_run_and_a_crash_is_a_failure():
    rows = [
        row(state=40),
        row(state=41, first=False),
        crashed(),
        row(state=43, outcome="unmet"),
        row(play="lookahead"),
        row("libero_10", state=40, outcome="unsettled"),
    ]
    found = metrics(rows)
    assert found["reactive_libero_goal"] == 0.5
    assert found["first_try_libero_goal"] == 0.25
    assert found["lookahead_libero_goal"] == 1.0
    assert found["reactive_libero_10"] == 0.0
    assert (found["reactive_libero_goal.n"], found["trials"], found["crashed"]) == (4, 6, 1)
    assert found["reactive_libero_goal.low"] < 0.5 < found["reactive_libero_goal.high"]
    assert (found["reactive_libero_goal.steps"], found["first_try_libero_goal.steps"]) == (80, 40)
    assert (found["tasks"], found["states_per_task"], found["disagreements"]) == (2, 1, 0)
    assert not {"lookahead_libero_10", "reactive_libero_90", "reactive_libero_spatial"} & set(found)


def test_a_table_has_every_suite_task_and_failure():
    rows = [
        row(state=40, first=False),
        row(state=41, outcome="unmet", premise_holds=False),
        crashed(),
        row(play="lookahead"),
        row("libero_90", task=7, outcome="held", failures=[]),
    ]
    text = skills_table({"rows": rows, "metrics": metrics(rows)})
    assert "| `libero_goal` | reactive | 3 | 0.333 [0.061, 0.792] | 80 |" in text
    assert "| `libero_goal` | first try | 3 | 0.000 [0.000, 0.561] | — |" in text
    assert "| `libero_goal` 0 | task 0 | 0/3 | 1/3 | 1/1 | 80, 80 | 80, 80 | 200 |" in text
    assert "| `libero_90` 7 | task 7 | 0/1 | 0/1 | — | — | — | — |" in text
    assert f"| goal false at the end, premise false | `relation_missing` `{ON}` -129 mm (xy) | missed (80) |" in text
    assert "| `libero_goal` 0 | 42 | reactive | crashed | Boom | none |" in text
    assert "| `libero_90` 7 | 40 | reactive | not let go | — | missed (80) |" in text
    assert "3 of 5 episodes failed; unmet facts by kind: 1 `relation_missing` of `on`." in text
    assert "libero_10" not in text


def test_a_table_without_failures_says_so():
    assert skills_table({"rows": [row()], "metrics": metrics([row()])}).endswith("No episode failed.")


def test_times_are_apart_from_what_two_runs_agree_on():
    one, other = (row(timing={"planning_s": s}, seconds=s) for s in (1.0, 2.0))
    assert one != other
    assert untimed(SKILLS, [one]) == untimed(SKILLS, [other])


@pytest.mark.sim
def test_the_full_protocol_takes_the_states_that_development_did_not_and_the_small_one_does_not():
    pytest.importorskip("libero")
    full, small = SKILLS.trials(True), SKILLS.trials(False)
    assert len(full) == len({trial["key"] for trial in full}) == 130 * 10 * 2
    assert {trial["state"] for trial in full} == set(range(40, 50))
    assert len(small) == 5 * 2
    assert {trial["state"] for trial in small} == {0}


def test_one_task_is_kept_and_its_environment_closed_when_the_next_comes(monkeypatch):
    """LIBERO's environments hold a quarter of a gigabyte each until they are closed."""
    closed = []

    class Kept:
        def __init__(self, suite, task):
            self.native = SimpleNamespace(close=lambda: closed.append((suite, task)))

    monkeypatch.setattr(skills, "_Bench", Kept)
    monkeypatch.setattr(skills, "_KEPT", {})
    first = skills._bench("libero_goal", 0)
    assert skills._bench("libero_goal", 0) is first
    assert closed == []
    assert skills._bench("libero_goal", 1) is not first
    assert closed == [("libero_goal", 0)]


@pytest.fixture(scope="module")
def bench():
    pytest.importorskip("libero")
    from benchmarks.skills import _Bench

    return _Bench("libero_goal", 8)


@pytest.mark.sim
def test_an_episode_gives_the_same_row_whatever_came_before_and_is_replayed_to_the_last_bit(bench):
    first = bench.row(0, "reactive")
    other = bench.row(1, "lookahead")
    again = bench.row(0, "reactive")
    assert other["rehearsed"] > 0
    assert untimed(SKILLS, [first]) == untimed(SKILLS, [again])
    assert first["replayed_same"]
    assert first["success"] == (first["outcome"] == "success")
    assert len(first["tries"]) >= 1
    assert 0 < first["steps"] <= first["horizon"] == 300
    assert json.loads(json.dumps(first, allow_nan=False)) == first


@pytest.mark.sim
def test_without_an_action_the_goal_is_unmet_and_typed(bench):
    verdict = bench.native.run(bench.states[0], np.empty((0, 7)), np.zeros(0))
    assert (verdict.outcome, verdict.success_step, verdict.same) == ("unmet", None, False)
    (failure,) = verdict.failures
    assert failure["failure"] == "relation_missing"
    assert failure["fact"] == "on(akita_black_bowl_1, plate_1)"
    assert failure["margin"] < -0.05
    assert failure["unit"] == "m"


@pytest.mark.sim
def test_what_is_still_in_the_fingers_is_no_success(bench):
    """The actions up to the first step at which the native predicate holds: LIBERO does not ask for release."""
    bench.sim.reset_to(bench.states[0])
    bench.sim.settle()
    played = bench.player.reactive(bench.sim, bench.horizon)
    whole = bench.native.run(bench.states[0], played.actions, bench.sim.data.qpos)
    assert whole.outcome == "success"
    cut = bench.native.run(bench.states[0], played.actions[: whole.success_step], bench.sim.data.qpos)
    assert cut.outcome in {"held", "unsettled"}
    assert cut.success_step == whole.success_step
