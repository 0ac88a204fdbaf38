"""The W3C's SHACL suite and the DASH rule cases, run whole: pySHACL's source archive brings both."""

import pytest

from benchmarks.conformance import EXCEPTIONS, RULES, SHACL
from benchmarks.shacl_cases import corpus, rule_cases, run_rule_case, run_shacl_case, shacl_cases

ROOT = corpus()
SHACL_CASES = list(shacl_cases(ROOT))
RULE_CASES = list(rule_cases(ROOT))


def test_the_suites_are_found_whole():
    assert len(SHACL_CASES) == SHACL == 121
    assert len({case.iri for case in SHACL_CASES}) == SHACL
    assert sum(case.iri.startswith("core/") for case in SHACL_CASES) == 98
    assert sum(case.iri.startswith("sparql/") for case in SHACL_CASES) == 23
    assert len(RULE_CASES) == RULES == 7


def test_exceptions_are_few_and_name_cases():
    assert len(EXCEPTIONS) <= 3
    assert set(EXCEPTIONS) <= {case.iri for case in SHACL_CASES}


@pytest.mark.parametrize("case", SHACL_CASES, ids=lambda case: case.iri)
def test_a_report_is_the_one_that_the_suite_expects(case):
    said = run_shacl_case(case)
    assert bool(said) == (case.iri in EXCEPTIONS), said


@pytest.mark.parametrize("case", RULE_CASES, ids=lambda case: case.file.stem)
def test_rules_conclude_exactly_what_the_suite_expects(case):
    assert run_rule_case(case) == ""
