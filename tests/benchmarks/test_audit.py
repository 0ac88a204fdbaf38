"""The audit's figures follow from its rows, and its tables say where a premise is false."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from benchmarks.audit import FALSE, metrics, rows_of
from benchmarks.audit_suites import AUDIT_SUITES
from benchmarks.audit_tables import audit_table, suites_table, versions_table
from benchmarks.audit_versions import AUDIT_VERSIONS
from benchmarks.overlay import overlay
from onto_compiler.problems import OntoError
from runtime.worlds.libero.audit.records import Failure, Fault, StateAudit, TaskAudit

ON = "on(bowl, ramekin)"


def false(margin):
    return Failure(FALSE, ON, margin, "m", "relation_missing", "xy")


def task(index, *states, faults=()):
    return TaskAudit("libero_spatial", index, f"task_{index}", True, 50, states, faults)


def rows(*tasks, **more):
    return [{"suite": "libero_spatial", "task": t.index, **more, **row} for t in tasks for row in rows_of(t)]


def audited():
    return rows(
        task(0, StateAudit(0), StateAudit(1, (false(-0.01), Failure("tipped", "bowl", -0.2, "rad")))),
        task(1, StateAudit(0, faults=(Fault("SIM019", "diverged"),)), StateAudit(1, (false(-0.03),))),
        task(2, faults=(Fault("SIM016", "cannot be built"),)),
    )


def test_tasks_and_states_are_counted_by_kind():
    found = metrics([*audited(), {"suite": "libero_spatial", "task": 3, "crashed": "Boom"}])
    assert (found["tasks"], found["states"]) == (2, 4)
    assert (found["premise_false_states"], found["premise_false_tasks"]) == (2, 2)
    assert (found["sound_states"], found["faults"], found["crashed"]) == (1, 2, 1)
    assert (found["tipped.states"], found["tipped.tasks"]) == (1, 1)
    assert found["libero_spatial.premise_false_states"] == 2


def test_a_row_is_json():
    assert json.loads(json.dumps(audited(), allow_nan=False)) == audited()


def test_the_table_has_every_task_and_every_false_fact():
    text = audit_table({"metrics": metrics(audited()), "rows": audited()})
    assert f"| `libero_spatial` 0 | `{ON}` | 1 of 2 | -10 mm | xy |" in text
    assert "| task |  | fact false | tipped |" in text
    assert "| `libero_spatial` 0 | task 0 | 1 | 1 |" in text
    assert "| `libero_spatial` 1 | task 1 | 1 |  |" in text
    assert "| all |  | 2 in 2 tasks | 1 in 1 tasks |" in text


def test_versions_are_held_against_the_installed_one():
    tested = rows(task(5, StateAudit(0), StateAudit(1)), mujoco="3.3.7", other="")
    other = rows(
        task(5, StateAudit(0, (false(-0.007),)), StateAudit(1, (false(-0.009),))), mujoco="3.4.0", other="3.4.0"
    )
    found = AUDIT_VERSIONS.metrics([*tested, *other])
    assert (found["3.3.7.states"], found["3.3.7.premise_false_states"], found["3.3.7.changed_states"]) == (2, 0, 0)
    assert (found["3.4.0.states"], found["3.4.0.premise_false_states"], found["3.4.0.changed_states"]) == (2, 2, 2)
    text = versions_table({"metrics": found, "rows": [*tested, *other]})
    assert f"| `libero_spatial` 5 | `{ON}` | 0 | 2 (-8 mm) |" in text
    assert "2 of 2 under 3.4.0" in text


def test_an_environment_that_was_made_is_used_again(tmp_path, monkeypatch):
    commands = []

    def run(command, **_):
        commands.append(command)
        return subprocess.CompletedProcess(command, 0, stdout=str(tmp_path))

    monkeypatch.setattr(subprocess, "run", run)
    made = overlay("thing", "1.0", tmp_path)
    assert "thing==1.0" in commands[1]
    assert (tmp_path / "onto_evwm_overlay.pth").read_text().splitlines()[1].startswith("import site")
    del commands[:]
    assert overlay("thing", "1.0", tmp_path) == made
    assert commands == []


def test_an_environment_that_cannot_be_made_is_a_problem(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "executable", "false")
    with pytest.raises(OntoError) as caught:
        overlay("thing", "1.0", tmp_path)
    assert [p.code for p in caught.value.problems] == ["BEN004"]


def test_suites_that_could_not_be_audited_are_listed_with_the_reason():
    some = [
        {"suite": "a", "task": 0, **next(rows_of(task(0, StateAudit(0, (false(-0.01),)))))},
        {"suite": "b", "task": 0, **next(rows_of(task(0, faults=(Fault("SIM016", "cannot be built"),))))},
        {"suite": "c", "task": 0, "crashed": "Boom"},
    ]
    found = AUDIT_SUITES.metrics(some)
    assert (found["suites"], found["audited_suites"], found["crashed"]) == (3, 1, 1)
    text = suites_table({"metrics": found, "rows": some})
    assert "| `b` | SIM016: cannot be built |" in text
    assert f"| `a` | fact false `{ON}` |" in text


def test_every_suite_but_libero_s_own_is_tried():
    pytest.importorskip("libero")
    tried = [trial["suite"] for trial in AUDIT_SUITES.trials(True)]
    assert len(tried) == len(set(tried)) == 53
    assert not {"libero_goal", "libero_90"} & set(tried)
