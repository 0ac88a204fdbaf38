"""Rules that conclude different things of one case are found before a task is diagnosed with them."""

from dataclasses import replace
from pathlib import Path

import pytest

import ontology
from onto_compiler.check.agreement import check_agreement
from onto_compiler.check.coverage import undiagnosed
from onto_compiler.check.model import load_model
from onto_compiler.check.rules import check_rules
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import PredicateSignature
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED, RuleTables

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


def damaged(tmp_path, old, new):
    path = tmp_path / "diagnosis.ttl"
    path.write_text((ontology.ROOT / "rules" / "diagnosis.ttl").read_text().replace(old, new))
    return load_model([path])


def test_a_status_that_a_rule_lost_is_told_at_the_rules_for_each_kind(tmp_path):
    model = damaged(tmp_path, "{ core:Absent core:ExplicitlyFalse }", "{ core:Absent }")
    findings = list(check_agreement(model))
    assert {one.code for one in findings} == {"RUL016"}
    assert {one.subject.value.rpartition("#")[2] for one in findings} == {"diagnosis", "navigation"}
    kinds = {one.values["kind"].value.rpartition("#")[2] for one in findings}
    assert kinds == {"ContactRelation", "ObjectRelation", "RegionRelation"}
    assert all("required to hold and ExplicitlyFalse" in one.message for one in findings)


def test_what_only_a_negated_goal_would_need_is_a_warning(tmp_path):
    model = damaged(tmp_path, "core:polarity false", "core:polarity 2")
    assert {(one.code, one.severity) for one in check_agreement(model)} == {("RUL016", "warning")}


def test_without_a_margin_none_can_be_violated():
    predicate = PredicateSignature("p", "p", "k", (), None, None)
    cases = {("p", polarity, status): None for polarity in (True, False) for status in (ABSENT, EXPLICITLY_FALSE)}
    assert undiagnosed(predicate, RuleTables(cases, {})) == ()
    measured = replace(predicate, margin_unit="unit:M")
    assert undiagnosed(measured, RuleTables(cases, {})) == ((True, (MARGIN_VIOLATED,)), (False, (MARGIN_VIOLATED,)))


@pytest.mark.parametrize(
    ("status", "conclusion", "codes"),
    [
        ("core:MarginViolated", "man:RelationMissing", {"RUL004"}),
        ("core:MarginViolated", "man:TargetMargin", set()),
        ("core:ExplicitlyFalse", "man:RackContact", set()),
    ],
    ids=["one case, two conclusions", "one conclusion", "another status"],
)
def test_rules_may_share_an_order_where_it_cannot_matter(tmp_path, status, conclusion, codes):
    path = tmp_path / "x.ttl"
    text = (BROKEN.parent / "rul004_same_order.ttl").read_text()
    path.write_text(text.replace("core:MarginViolated", status).replace("man:RelationMissing", conclusion))
    model = load_model([path])
    assert {one.code for one in check_rules(model) if one.code == "RUL004"} == codes


@pytest.mark.parametrize("path", [BROKEN, ontology.ROOT / "manipulation.ttl"], ids=["broken", "sound"])
def test_rules_that_run_on_one_of_all_like_predicates_conclude_as_on_all(path):
    model = load_model([path])
    assert set(map(repr, check_rules(model))) >= set(map(repr, check_agreement(model)))
    disagree = [one for one in check_rules(model) if one.code == "RUL015"]
    assert sorted(map(repr, disagree)) == sorted(map(repr, check_agreement(model)))
