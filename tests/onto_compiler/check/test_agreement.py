"""Rules that conclude different things of one case are found before a task is diagnosed with them."""

from pathlib import Path

import pytest

from onto_compiler.check.agreement import check_agreement
from onto_compiler.check.model import load_model
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError

BROKEN = Path(__file__).parent / "broken" / "rul015_two_conclusions.ttl"


def test_each_pair_of_rules_is_named_once():
    findings = list(check_agreement(load_model([BROKEN])))
    assert sorted(finding.subject.value.rpartition("#")[2] for finding in findings) == ["relation_missing", "spill"]


def test_what_is_reported_is_what_refuses_to_compile():
    with pytest.raises(OntoError, match="RUN002"):
        load_knowledge(BROKEN)


def test_shipped_rules_agree():
    assert list(check_agreement(load_model())) == []


def test_a_file_that_no_rule_can_read_runs_no_rules(tmp_path, monkeypatch):
    path = tmp_path / "x.ttl"
    path.write_text("<https://e.org/a> <https://e.org/b> <https://e.org/c> .\n")
    monkeypatch.setattr("onto_compiler.check.agreement.compile_tables", None)
    assert list(check_agreement(load_model([path]))) == []
