"""Whether a fact holds has one answer, whoever is asked: negation, thresholds, tolerances and missing evidence."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.house_satisfied import PARTS, expected, random_case
from grounding.observation import Evidence, stack
from onto_compiler.knowledge import load_knowledge
from runtime.loop.diagnosis import lack, satisfied, surplus

pytestmark = pytest.mark.sim

CASES = st.integers(0, 2**32 - 1).map(lambda seed: random_case(np.random.default_rng(seed)))


@given(CASES)
def test_satisfied_is_what_the_paper_says(case):
    facts, seen = case
    assert tuple(satisfied(facts, seen)) == expected(facts, seen)


@pytest.mark.parametrize("name", PARTS)
@given(case=CASES)
def test_every_part_gives_that_answer(name, case):
    facts, seen = case
    assert PARTS[name](facts, seen, load_knowledge()) == expected(facts, seen)


@given(CASES)
def test_a_satisfied_fact_lacks_nothing_and_another_lacks_its_margin(case):
    facts, seen = case
    missing, above, holds = lack(facts, seen), surplus(facts, seen), satisfied(facts, seen)
    assert (missing[holds] == 0.0).all()
    assert np.array_equal(np.isnan(missing), ~holds & np.isnan(above))
    measured = ~np.isnan(missing)
    assert (missing[measured] >= 0.0).all()
    assert np.array_equal(missing[measured & (above < 0) & ~holds], -above[measured & (above < 0) & ~holds])


def test_a_negative_fact_within_its_threshold_is_satisfied():
    facts, _ = random_case(np.random.default_rng(0))
    fact = type(facts[0])(facts[0].predicate, facts[0].arguments, facts[0].native, "on_object", False, 0.01)
    seen = stack("sim", 0, [Evidence(False, -0.02)])
    assert satisfied([fact], seen).tolist() == [True]
    assert all(part([fact], seen, load_knowledge()) == (True,) for part in PARTS.values())
