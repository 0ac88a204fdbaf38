"""Goals that can never hold are refused with the reason; what a scene may show is not."""

import dataclasses

import pytest
from hypothesis import given
from hypothesis import strategies as st

from onto_compiler.bddl import lift, parse
from onto_compiler.bddl.impossible import impossible, refuse_impossible
from onto_compiler.compile_schema import load_schema
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from tests.faults import fault

MAN = "https://w3id.org/onto-evwm/manipulation#"
SCHEMA = load_schema()
SCENE = """(define (problem LIBERO_Tabletop_Manipulation) (:domain robosuite) (:language stack)
  (:regions (top_region (:target wooden_cabinet_1)) (left (:target main_table)) (right (:target main_table)))
  (:fixtures main_table - table wooden_cabinet_1 - wooden_cabinet)
  (:objects akita_black_bowl_1 akita_black_bowl_2 - akita_black_bowl plate_1 - plate)
  (:init (On akita_black_bowl_1 plate_1) (On akita_black_bowl_2 main_table_left) (On plate_1 main_table_right))
  (:goal GOAL))"""


def required(goal):
    for short, name in (
        ("B1", "akita_black_bowl_1"),
        ("B2", "akita_black_bowl_2"),
        ("TOP", "wooden_cabinet_1_top_region"),
    ):
        goal = goal.replace(short, name)
    return lift(parse(SCENE.replace("GOAL", goal)), SCHEMA, "task")[0]


@pytest.mark.parametrize(
    ("goal", "code"),
    [
        ("(And (On B1 B2) (On B2 B1))", "BDDL026"),
        ("(And (On B1 B2) (On B2 plate_1) (On plate_1 B1))", "BDDL026"),
        ("(On B1 B1)", "BDDL026"),
        ("(And (On B1 plate_1) (Not (On B1 plate_1)))", "BDDL024"),
        ("(And (Open TOP) (Close TOP))", "BDDL027"),
        ("(Or (And (On B1 B2) (On B2 B1)) (And (Open TOP) (Close TOP)))", "BDDL026"),
    ],
)
def test_a_goal_that_can_never_hold_is_refused_at_its_place(goal, code):
    abox = required(goal)
    assert code in {each.code for each in impossible(abox, SCHEMA)}
    with pytest.raises(Exception, match=code) as caught:
        refuse_impossible(abox, SCHEMA)
    assert {(each.severity, each.line) for each in caught.value.problems} == {("error", 6)}


@pytest.mark.parametrize(
    "goal",
    [
        "(And (On B1 B2) (On B2 plate_1))",
        "(And (On B1 plate_1) (On B1 B2))",  # on two things at a time, side by side
        "(And (On B1 main_table_left) (On B1 main_table_right))",  # regions may overlap
        "(And (On B1 B2) (Not (On B2 B1)))",
        "(Or (And (On B1 B2) (On B2 B1)) (On B1 plate_1))",
        "(And (Open TOP) (Not (Close TOP)))",
    ],
)
def test_what_may_hold_is_not_refused(goal):
    assert impossible(required(goal), SCHEMA) == ()
    refuse_impossible(required(goal), SCHEMA)


def test_what_is_acyclic_is_declared_in_turtle():
    assert {p.iri for p in SCHEMA.predicates.values() if p.acyclic} == {MAN + "on", MAN + "inside"}
    declared = {iri: dataclasses.replace(p, acyclic=False) for iri, p in SCHEMA.predicates.items()}
    silent = dataclasses.replace(SCHEMA, predicates=declared)
    assert impossible(required("(And (On B1 B2) (On B2 B1))"), silent) == ()


def test_a_contradiction_names_both_facts():
    problem = fault(refuse_impossible, required("(And (On B1 plate_1) (Not (On B1 plate_1)))"), SCHEMA)
    assert "`on(akita_black_bowl_1, plate_1)` and `not on(akita_black_bowl_1, plate_1)`" in problem.message


PAIRS = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=12)


def facts(pairs):
    entities = [Entity(f"o{number}", MAN + "Object") for number in range(7)]
    return tuple(Fact(MAN + "on", (entities[a], entities[b]), NativeAtom("On", ()), "on_object") for a, b in pairs)


@given(PAIRS)
def test_a_goal_of_supports_is_refused_where_it_cannot_be_stacked(pairs):
    """The oracle: again and again take away what nothing rests on."""
    left = set(pairs)
    while True:
        free = {pair for pair in left if pair[0] not in {below for _, below in left}}
        if not free:
            break
        left -= free
    abox = RequiredABox("task", "", "", facts(pairs))
    assert bool(impossible(abox, SCHEMA)) == bool(left)
