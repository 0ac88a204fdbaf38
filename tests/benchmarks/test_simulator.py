from __future__ import annotations

import pytest

from benchmarks.protocol import untimed
from benchmarks.simulator import SIMULATOR, TASKS

pytestmark = pytest.mark.sim

METRICS = {
    "exact_max_qpos_error",
    "first_step_s",
    "grounding_share",
    "grounding_vs_native",
    "parity_max_qpos_error",
    "physics_share",
    "scaling_2",
    "setup_ms",
    "setup_ratio",
    "steps_ratio",
}


def small(key, **sizes):
    """The rows of the trial called `key`, with other sizes."""
    (trial,) = (trial for trial in SIMULATOR.trials(False) if trial["key"] == key)
    shorter = {**trial, **sizes}
    return [{**shorter, **row} for row in SIMULATOR.run(shorter)]


@pytest.fixture(scope="module")
def rows():
    return [
        *small("libero_goal/0", actions=20),
        *small("first_step", starts=1),
        *small("scaling", steps=20),
        *small("memory", resets=4, steps=40),
        *small("again/libero_goal/0", actions=20),
    ]


def test_two_tasks_of_each_suite_are_measured():
    kinds = [trial["kind"] for trial in SIMULATOR.trials(True)]
    assert (kinds.count("task"), kinds.count("again")) == (10, 10)
    suites = [suite for suite, _ in TASKS]
    assert {suites.count(suite) for suite in suites} == {2}
    assert len(set(suites)) == 5


def test_every_figure_is_there(rows):
    found = SIMULATOR.metrics(rows)
    assert set(found) >= METRICS
    assert all(value >= 0 for value in found.values())


def test_the_loops_agree_with_the_native_environment(rows):
    found = SIMULATOR.metrics(rows)
    assert found["exact_max_qpos_error"] == 0
    assert found["exact_held_steps"] > 0
    assert 0 < found["parity_max_qpos_error"] < 1e-9
    assert found["success_compared"] > 10
    assert found["success_mismatches"] == 0


def test_processes_agree_and_nothing_breaks_off(rows):
    found = SIMULATOR.metrics(rows)
    assert found["repeated_unequal"] == 0
    assert found["faults"] == 0
    assert (found["memory_resets"], found["memory_steps"]) == (4, 40)


def test_the_same_command_gives_the_same_rows_timings_aside(rows):
    (first,) = untimed(SIMULATOR, rows[:1])
    (second,) = untimed(SIMULATOR, small("libero_goal/0", actions=20))
    assert first == second
    assert "timing" not in first
    assert "timing" in rows[0]


def test_another_digest_in_the_other_process_is_counted():
    row = {"kind": "again", "key": "again/x", "digest": "1", "same": False}
    assert SIMULATOR.metrics([row])["repeated_unequal"] == 1
