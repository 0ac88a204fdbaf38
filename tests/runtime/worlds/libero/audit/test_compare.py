"""A record is read back as it was written, and two records are compared state by state."""

from __future__ import annotations

import json

import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.libero.audit.compare import compare
from runtime.worlds.libero.audit.records import Audit, Failure, Fault, StateAudit, TaskAudit, read_audit, write_audit
from runtime.worlds.libero.audit.render import audit_text, changes_text, ranges

KINDS = {
    "fell": {"iri": "i", "measure": "fall", "most": 0.25, "unit": "m"},
    "initial_fact_false": {"iri": "j", "measure": "initial_fact", "most": None, "unit": ""},
}
ON = "on(bowl, ramekin)"


def state(number, *, margin, fall=0.1):
    failures = []
    if margin < 0:
        failures.append(Failure("initial_fact_false", ON, margin, "m", "relation_missing", "xy"))
    if fall > 0.25:
        failures.append(Failure("fell", "bowl", 0.25 - fall, "m"))
    return StateAudit(number, tuple(failures), {"fall": {"bowl": fall}, "initial_fact": {ON: margin}})


def audit(*states, mujoco="3.3.7", faults=()):
    task = TaskAudit("suite", 5, "the_bowl", True, 50, states, faults)
    return Audit({"mujoco": mujoco}, 0, KINDS, (task,))


def test_a_record_is_read_back_as_it_was_written(tmp_path):
    whole = audit(
        state(0, margin=-0.01), StateAudit(1, faults=(Fault("SIM019", "gone"),)), faults=(Fault("SIM001", "x"),)
    )
    write_audit(tmp_path / "new" / "audit.json", whole)
    assert read_audit(tmp_path / "new" / "audit.json") == whole
    assert not whole.clean
    assert audit(state(0, margin=0.01)).clean


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "other"}', "\x00", '{"format": "onto-audit-1", "tasks": 3}']
)
def test_what_is_no_record_is_refused(tmp_path, text):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(OntoError) as caught:
        read_audit(path)
    assert [p.code for p in caught.value.problems] == ["RUN022"]
    with pytest.raises(OntoError):
        read_audit(tmp_path / "missing.json")


def test_a_folder_is_no_place_for_a_record(tmp_path):
    with pytest.raises(OntoError) as caught:
        write_audit(tmp_path, audit())
    assert [p.code for p in caught.value.problems] == ["RUN023"]


def test_new_and_gone_failures_are_told_with_both_margins():
    first = audit(state(0, margin=0.001), state(1, margin=0.003), state(2, margin=-0.5), state(3, margin=0.1))
    second = audit(
        state(0, margin=-0.03),
        state(1, margin=-0.01),
        state(2, margin=0.5, fall=0.4),
        state(4, margin=-1),
        mujoco="3.4.0",
    )
    fell, fact = compare(first, second)
    assert (fact.kind, fact.subject, fact.unit, fact.states) == ("initial_fact_false", ON, "m", 3)
    assert (fact.new, fact.gone) == ((0, 1), (2,))
    assert (fact.before, fact.after) == (0.001, -0.01)
    assert (fell.kind, fell.new, fell.gone) == ("fell", (2,), ())
    assert (fell.before, fell.after) == (pytest.approx(0.15), pytest.approx(-0.15))
    assert compare(first, first) == ()
    text = changes_text((fell, fact), first, second)
    assert "mujoco: 3.3.7 -> 3.4.0" in text
    assert f"new: initial_fact_false: {ON}, in 2 of 3 states (0-1)" in text
    assert f"gone: initial_fact_false: {ON}, in 1 of 3 states (2)" in text
    assert "+1 mm -> -10 mm" in text
    assert text.endswith("1 task in both: 1 differ\n")


def test_a_task_that_only_one_side_could_build_differs():
    (change,) = compare(audit(), audit(faults=(Fault("SIM016", "cannot be built"),)))
    assert (change.kind, change.subject, change.new, change.gone) == ("SIM016", "cannot be built", (0,), ())
    assert "  new: SIM016: cannot be built" in changes_text((change,), audit(), audit())


def test_the_text_sums_up_by_kind_and_subject():
    text = audit_text(
        audit(*(state(n, margin=-0.001 * (n + 1)) for n in (0, 1, 2)), state(3, margin=1), state(4, margin=1))
    )
    assert "suite/5 the_bowl" in text
    assert f"  initial_fact_false: {ON}, in 3 of 5 states (0-2); worst margin -3 mm (relation_missing, by xy)" in text
    assert text.endswith("1 task, 5 initial states: 3 with a premise failure (MuJoCo 3.3.7, seed 0)\n")


def test_numbers_in_a_row_are_one_range():
    assert ranges([3, 1, 2, 7, 9, 10]) == "1-3, 7, 9-10"
    assert json.loads(json.dumps(audit().as_dict()))["format"] == "onto-audit-1"
