"""The alternatives of a goal say what the goal says, whatever holds."""

from __future__ import annotations

import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onto_compiler.bddl import parse
from onto_compiler.bddl.ast import And, Atom, Declaration, Imply, Not, Or, Quantified, Symbol, TaskSpec, Variable
from onto_compiler.bddl.lint_goal import lint_goal
from onto_compiler.bddl.literals import goal_of
from onto_compiler.bddl.quantifiers import MAX_ALTERNATIVES

KINDS = {"a": "cup", "b": "cup", "c": "cup", "x": "plate", "y": "plate"}
TERMS = st.sampled_from([*KINDS, "?v", "?w"])


def holds(formula, state, scope):  # noqa: PLR0911 - one case for each kind of formula
    """What BEHAVIOR's evaluation says of ``formula``; ``state`` holds the true atoms."""
    match formula:
        case Atom():
            return (formula.predicate, *(scope.get(s.name, s.name) for s in formula.arguments)) in state
        case Not():
            return not holds(formula.part, state, scope)
        case And():
            return all(holds(part, state, scope) for part in formula.parts)
        case Or():
            return any(holds(part, state, scope) for part in formula.parts)
        case Imply():
            return holds(formula.consequent, state, scope) or not holds(formula.antecedent, state, scope)
    values = [[name for name, kind in KINDS.items() if kind == v.category] for v in formula.variables]
    names = [v.name for v in formula.variables]
    if len(values) == 1:
        count = sum(holds(formula.body, state, scope | {names[0]: value}) for value in values[0])
        return {"forall": count == len(values[0]), "exists": count > 0, "forn": count == formula.count}[formula.kind]
    grid = [
        [one != other and holds(formula.body, state, scope | {names[0]: one, names[1]: other}) for other in values[1]]
        for one in values[0]
    ]
    there = min(len(values[0]), len(values[1]) - (values[0] == values[1]))
    wanted = there if formula.kind == "forpairs" else formula.count
    return sum(map(any, grid)) >= wanted and sum(map(any, zip(*grid, strict=True))) >= wanted


def variables(name):
    return st.builds(Variable, st.just(name), st.sampled_from(["cup", "plate"]))


ATOMS = st.builds(
    lambda name, terms: Atom(name, tuple(map(Symbol, terms))), st.sampled_from(["on", "near"]), st.tuples(TERMS, TERMS)
)
BODIES = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.builds(Not, inner),
        st.builds(And, st.lists(inner, min_size=1, max_size=3).map(tuple)),
        st.builds(Or, st.lists(inner, min_size=1, max_size=3).map(tuple)),
        st.builds(Imply, inner, inner),
    ),
    max_leaves=3,
)


@st.composite
def goals(draw):
    """Formulas whose variables are bound at the top."""
    kind = draw(st.sampled_from(["forall", "exists", "forn", "forpairs", "fornpairs"]))
    if kind in {"forpairs", "fornpairs"}:
        count = draw(st.integers(1, 2)) if kind == "fornpairs" else None
        return Quantified(kind, (draw(variables("?v")), draw(variables("?w"))), draw(BODIES), count)
    count = draw(st.integers(0, 2)) if kind == "forn" else None
    inner = Quantified(draw(st.sampled_from(["forall", "exists"])), (draw(variables("?w")),), draw(BODIES))
    whole = Quantified(kind, (draw(variables("?v")),), inner, count)
    return Not(whole) if draw(st.booleans()) else whole


def task(goal):
    objects = tuple(Declaration(name, kind) for name, kind in KINDS.items())
    return TaskSpec("p", "omnigibson", "", (), (), objects, (), (), goal)


@settings(deadline=None)  # a busy machine is not a fault
@given(goals(), st.integers(0, 2**32))
def test_some_alternative_holds_exactly_where_the_goal_does(goal, seed):
    found, problems = goal_of(task(goal))
    assert {problem.code for problem in problems} <= {"BDDL014", "BDDL021", "BDDL024"}
    if problems and problems[0].code != "BDDL024":
        return
    ways = () if problems else found.ways
    rng = random.Random(seed)  # noqa: S311 - states need no secrecy
    everything = [(name, one, other) for name in ("on", "near") for one in KINDS for other in KINDS]
    for share in (0, 0.2, 0.5, 0.8, 1):
        state = {atom for atom in everything if rng.random() < share}
        reached = [
            all(((a.predicate, *(s.name for s in a.arguments)) in state) == polarity for a, polarity in way)
            for way in ways
        ]
        assert any(reached) == holds(goal, state, {})


@pytest.mark.parametrize(("cups", "plates", "ways"), [(2, 2, 2), (3, 3, 15), (2, 3, 6), (4, 4, 184)])
def test_pairs_are_the_least_covers_of_both_kinds(cups, plates, ways):
    objects = " ".join(f"cup_{i}" for i in range(cups)) + " - cup " + " ".join(f"p_{i}" for i in range(plates))
    goal = "(forpairs (?c - cup) (?p - plate) (on ?c ?p))"
    spec = parse(f"(define (problem P) (:domain omnigibson) (:objects {objects} - plate) (:init) (:goal {goal}))")
    found, problems = goal_of(spec)
    assert not problems
    assert len(found.alternatives) == ways
    pairs = [frozenset(way) for way in found.alternatives]
    assert not any(one < other for one, other in itertools.permutations(pairs, 2))


@pytest.mark.parametrize(
    "goal",
    [
        "(forpairs (?a - cup) (?b - cup) (on ?a ?b))",
        "(forall (?a - cup) (forall (?b - cup) (forall (?c - cup) (forall (?d - cup) (on ?a ?b ?c ?d)))))",
        "(not (forn (9) (?a - cup) (on ?a p)))",
        "(and " + " ".join(f"(or (on a p_{i}) (on b p_{i}))" for i in range(11)) + ")",
        "(or " + " ".join(f"(and (on a_{i} p) (on b_{i} p))" for i in range(MAX_ALTERNATIVES + 1)) + ")",
    ],
)
def test_what_would_not_end_is_refused(goal):
    objects = " ".join(f"cup_{i}" for i in range(20))
    spec = parse(f"(define (problem P) (:domain omnigibson) (:objects {objects} - cup) (:init) (:goal {goal}))")
    assert [problem.code for problem in goal_of(spec)[1]] == ["BDDL014"]


def test_a_goal_of_many_facts_is_linted_without_comparing_each_with_each():
    objects = " ".join(f"cup_{i}" for i in range(200))
    goal = "(forall (?a - cup) (forall (?b - cup) (On ?a ?b)))"
    parts = f"(:domain robosuite) (:language stack) (:objects {objects} - cup) (:init) (:goal {goal})"
    spec = parse(f"(define (problem P) {parts})")
    found, problems = goal_of(spec)
    assert not problems
    assert len(found.literals) == 40_000
    told = [problem for problem in lint_goal(spec, found) if problem.code == "BDDL026"]
    assert [problem.message for problem in told] == [
        "the goal can never hold: `(On cup_199 cup_199)` puts `cup_199` on or in itself"
    ]


@pytest.mark.parametrize(
    ("goal", "circle"),
    [
        ("(and (On a b) (On b c) (On c a) (On d a))", "`(On c a)` puts `c`"),
        ("(and (On a b) (On b c) (On d b))", ""),
        ("(or (On a a) (On a b))", ""),
        ("(or (On a a) (On b b))", "`(On a a)` puts `a`"),
        ("(and (On a b) (not (On b a)))", ""),
    ],
)
def test_a_circle_of_supports_is_found_where_every_alternative_has_one(goal, circle):
    text = f"(define (problem P) (:domain robosuite) (:language stack) (:objects a b c d - cup) (:init) (:goal {goal}))"
    spec = parse(text)
    told = [problem.message for problem in lint_goal(spec, goal_of(spec)[0]) if problem.code == "BDDL026"]
    assert len(told) == bool(circle)
    assert all(circle in message for message in told)
