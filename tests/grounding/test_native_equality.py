"""The grounder against LIBERO's own predicates, on random, settled and adversarial states of real tasks."""

from __future__ import annotations

from collections import Counter

import pytest

from benchmarks.probing import CLOSE, GOAL_TASKS, OTHER_TASKS

pytestmark = pytest.mark.sim

PREDICATES = {"Close", "In", "On", "Open", "Turnoff", "Turnon"}


@pytest.fixture(scope="module")
def goal(probe):
    return [s for suite, index in GOAL_TASKS for s in probe(suite, index, randoms=100, settles=8, edges=5)]


@pytest.fixture(scope="module")
def samples(goal, probe):
    return goal + [s for suite, index in OTHER_TASKS for s in probe(suite, index, randoms=30, settles=4, edges=4)]


def test_the_corpus_holds_a_thousand_states_of_the_goal_tasks(goal):
    states = Counter(s.task for s in goal if s.target)
    assert len(states) == 10
    assert sum(states.values()) >= 1000


def test_every_native_predicate_of_the_suites_is_probed(samples):
    assert {s.predicate for s in samples if s.target} == PREDICATES
    assert {s.grounded_by for s in samples if s.target} == {"in_site", "joint_threshold", "on_object", "on_site"}


def test_truth_equals_the_native_predicate_in_every_state(samples):
    assert [s for s in samples if s.truth != s.native] == []
    assert len(samples) > 10_000


def test_truth_without_margins_equals_it_too(samples):
    assert [s for s in samples if s.compiled != s.native] == []


def test_the_margin_has_the_sign_of_the_truth(samples):
    wrong = [s for s in samples if (s.margin > 0 and not s.native) or (s.margin < 0 and s.native)]
    assert wrong == []


def test_every_term_has_the_sign_of_its_own_truth(samples):
    terms = [t for s in samples for t in s.terms]
    assert [t for t in terms if (t.margin > 0 and not t.holds) or (t.margin < 0 and t.holds)] == []


def test_the_margin_is_that_of_the_term_that_limits_it(samples):
    assert [s for s in samples if s.terms and (s.limit, s.margin) not in {(t.name, t.margin) for t in s.terms}] == []


@pytest.mark.parametrize("grounded_by", ["in_site", "joint_threshold", "on_object", "on_site"])
def test_each_kind_of_predicate_is_true_in_a_fifth_of_the_goal_states_or_more(goal, grounded_by):
    found = [s.native for s in goal if s.target and s.grounded_by == grounded_by]
    assert 0.2 <= sum(found) / len(found) <= 0.8


EDGES = [
    *(("in_site", term) for term in ("x", "y", "height", "depth")),
    *(("on_object", term) for term in ("xy", "height", "contact")),
    *(("on_site", term) for term in ("x", "y", "height", "ceiling", "contact")),
    ("joint_threshold", "qpos"),
]


@pytest.mark.parametrize(("grounded_by", "term"), EDGES)
def test_states_within_a_millimetre_of_each_threshold_lie_on_both_sides(goal, grounded_by, term):
    near = [
        t.holds
        for s in goal
        if s.target and s.grounded_by == grounded_by and s.label.startswith(f"edge:{term}:")
        for t in s.terms
        if t.name == term and abs(t.margin) < CLOSE
    ]
    assert near.count(True) >= 5
    assert near.count(False) >= 5


# A ceiling 10 cm above a region lies far above contact, so only a region without a carrier can flip there.
@pytest.mark.parametrize(("grounded_by", "term"), EDGES)
def test_the_native_predicate_itself_flips_at_each_threshold(goal, grounded_by, term):
    verdicts = Counter(
        (s.label[-1], s.native)
        for s in goal
        if s.target and s.grounded_by == grounded_by and s.label.startswith(f"edge:{term}:")
    )
    assert verdicts["+", True] + verdicts["-", True] >= 5
    assert verdicts["+", False] + verdicts["-", False] >= 5


@pytest.mark.parametrize("predicate", sorted(PREDICATES))
def test_each_native_predicate_is_seen_true_and_false(samples, predicate):
    assert {s.native for s in samples if s.target and s.predicate == predicate} == {True, False}
