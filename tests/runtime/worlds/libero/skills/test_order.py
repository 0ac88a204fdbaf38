"""Goals of several facts are ordered by declared preconditions and priorities, in every task and in any state."""

from __future__ import annotations

import os
from collections import deque
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grounding.observation import Observation
from onto_compiler.bddl import parse, parse_file, required_abox
from onto_compiler.bddl.conditions import with_preconditions
from onto_compiler.conflicts import exclude
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.rdf import MAN
from onto_compiler.tables import EXPLICITLY_FALSE, SATISFIED, STATUSES
from runtime.worlds.libero.skills.order import diagnose_step, preconditions, ready, sequence

GOLDEN = Path(__file__).with_name("orders.txt")
KNOWLEDGE = load_knowledge()
TRUE, FALSE = STATUSES.index(SATISFIED), STATUSES.index(EXPLICITLY_FALSE)
SCENE = """
(define (problem P) (:domain robosuite) (:language do it)
(:regions (top_region (:target cabinet_1)) (bottom_region (:target cabinet_1)) (heating_region (:target microwave_1))
  (cook_region (:target stove_1)) (top_side (:target microwave_1))
  (contain_region (:target tray_1)) (corner (:target table_1)))
(:fixtures table_1 - table cabinet_1 - wooden_cabinet stove_1 - flat_stove microwave_1 - microwave)
(:objects a - plate b - plate c - plate tray_1 - wooden_tray)
(:init INIT) (:goal (And GOAL)))
"""
DRAWER, OVEN = "cabinet_1_top_region", "microwave_1"


def required(*atoms, init="(On a table_1_corner)"):
    spec = parse(SCENE.replace("GOAL", " ".join(atoms)).replace("INIT", init))
    return with_preconditions(required_abox(spec, KNOWLEDGE.schema, "task"), spec, KNOWLEDGE.schema)


def shown(steps):
    return [str(step) for step in steps]


def order(*atoms, holding=(), init="(On a table_1_corner)"):
    """The steps to a goal from a state in which of all atoms only ``holding`` are true."""
    abox = required(*atoms, init=init)

    def status(fact):
        return TRUE if (str(fact.native) in holding) == fact.polarity else FALSE

    conditions = [status(each.fact) for each in abox.preconditions]
    return shown(sequence(abox, [status(fact) for fact in abox.facts], conditions, KNOWLEDGE))


def test_what_goes_into_a_drawer_or_a_microwave_needs_it_to_be_open():
    abox = required(f"(In a {DRAWER})", "(In b microwave_1_heating_region)", "(In c tray_1_contain_region)")
    opened = [[str(fact.native) for fact in each if fact.polarity] for each in preconditions(abox)]
    assert opened == [[f"Open({DRAWER})"], [f"Open({OVEN})"], []]
    typed = next(each.fact for each in abox.preconditions if each.fact.polarity)
    assert typed.predicate == MAN + "joint_state"
    assert [argument.name for argument in typed.arguments] == [DRAWER, "wooden_cabinet_open"]
    assert typed.grounded_by == "joint_threshold"


def test_an_object_that_is_moved_has_no_other_on_it():
    abox = required("(On a b)", "(On c table_1_corner)")
    clear = [[str(fact.native) for fact in each if not fact.polarity] for each in preconditions(abox)]
    assert clear == [["On(b, a)", "On(c, a)", "On(tray_1, a)"], ["On(a, c)", "On(b, c)", "On(tray_1, c)"]]


def test_a_shut_drawer_is_opened_before_and_closed_after():
    goal = (f"(Close {DRAWER})", f"(In a {DRAWER})")
    steps = [f"Open({DRAWER})", f"In(a, {DRAWER})", f"Close({DRAWER})"]
    assert order(*goal, holding=[f"Close({DRAWER})"]) == steps
    assert order(*goal, holding=[f"Open({DRAWER})"]) == steps[1:]
    assert order(*goal) == steps, "ajar"
    assert order(*goal, holding=[f"In(a, {DRAWER})"]) == steps[2:]
    assert order(*goal, holding=[f"In(a, {DRAWER})", f"Close({DRAWER})"]) == []


def test_closing_waits_for_all_that_goes_in():
    inside = [f"In({name}, {DRAWER})" for name in "abc"]
    steps = order(f"(Close {DRAWER})", *(f"(In {name} {DRAWER})" for name in "abc"))
    assert steps == [f"Open({DRAWER})", *inside, f"Close({DRAWER})"]


def test_a_goal_that_is_a_precondition_too_is_done_once():
    assert order(f"(In a {DRAWER})", f"(Open {DRAWER})") == [f"Open({DRAWER})", f"In(a, {DRAWER})"]


def test_a_stack_is_built_from_below_whatever_the_goal_lists_first():
    assert order("(On c b)", "(On b a)", "(On a table_1_corner)") == ["On(a, table_1_corner)", "On(b, a)", "On(c, b)"]


def test_what_rests_on_the_object_is_taken_off_first():
    abox = required("(On a table_1_corner)")
    conditions = [FALSE if str(each.fact.native) == "On(b, a)" else TRUE for each in abox.preconditions]
    assert shown(sequence(abox, [FALSE], conditions, KNOWLEDGE)) == ["not On(b, a)", "On(a, table_1_corner)"]


def test_what_is_taken_off_goes_to_its_own_place_where_the_goal_has_one():
    goal = ("(On a table_1_corner)", "(On b c)")
    assert order(*goal, holding=["On(b, a)"]) == ["On(b, c)", "On(a, table_1_corner)"]
    assert order("(On b c)", "(Not (On b a))", holding=["On(b, a)"]) == ["On(b, c)"]
    # Its place is on what has to move first, so that it waits elsewhere.
    waits = ["not On(b, a)", "On(a, table_1_corner)", "On(c, a)", "On(b, c)"]
    assert order("(On b c)", "(On c a)", "(On a table_1_corner)", holding=["On(b, a)"]) == waits


def test_a_container_stays_open_until_what_goes_on_the_things_inside_is_there():
    goal = (f"(In a {DRAWER})", "(On b a)", "(On c b)", f"(Close {DRAWER})")
    steps = [f"Open({DRAWER})", f"In(a, {DRAWER})", "On(b, a)", "On(c, b)", f"Close({DRAWER})"]
    assert order(*goal, holding=[f"Close({DRAWER})"]) == steps
    inside = [f"Close({DRAWER})", f"In(a, {DRAWER})"]
    assert order(*goal, holding=inside) == [steps[0], *steps[2:]]


def test_what_lies_in_a_shut_container_at_the_start_is_got_at_by_opening_it():
    init = f"(In a {DRAWER}) (On b a)"
    holding = [f"In(a, {DRAWER})", "On(b, a)", f"Close({DRAWER})"]
    out = [f"Open({DRAWER})", "On(b, c)", f"Close({DRAWER})"]
    assert order("(On b c)", f"(Close {DRAWER})", holding=holding, init=init) == out
    off = [f"Open({DRAWER})", "not On(b, a)"]
    assert order("(Not (On b a))", holding=holding, init=init) == off
    assert order("(On a c)", holding=holding, init=init) == [*off, "On(a, c)"]


def test_a_lid_that_is_stood_on_needs_not_be_open():
    abox = required("(On a microwave_1_top_side)", init="(On b microwave_1_top_side)")
    assert [each.fact for each in abox.preconditions if each.fact.polarity] == []


def test_a_stack_is_taken_down_from_above():
    stack = "(On b a) (On c b)"
    steps = order("(On a table_1_corner)", holding=["On(b, a)", "On(c, b)"], init=stack)
    assert steps == ["not On(c, b)", "not On(b, a)", "On(a, table_1_corner)"]


def test_without_preconditions_joints_come_first_and_then_what_the_goal_lists_first():
    goal = ("(On b stove_1_cook_region)", "(On a stove_1_cook_region)", "(Turnon stove_1)")
    assert order(*goal) == ["Turnon(stove_1)", "On(b, stove_1_cook_region)", "On(a, stove_1_cook_region)"]


@pytest.mark.parametrize(
    "goal",
    [
        ("(On a b)", "(On b a)"),
        ("(On a b)", "(On b c)", "(On c a)"),
        (f"(Open {DRAWER})", f"(Close {DRAWER})"),
        ("(On a b)", "(Not (On a b))"),
    ],
)
def test_facts_that_undo_each_other_are_a_problem(goal):
    with pytest.raises(OntoError) as raised:
        order(*goal)
    assert [problem.code for problem in raised.value.problems] == ["RUN012"]
    assert "`" in raised.value.problems[0].message


def observation(truth):
    n = len(truth)
    nan = np.full(n, np.nan)
    return Observation("sim", 0, np.ones(n, bool), np.array(truth, dtype=bool), nan, nan, ("",) * n)


def test_what_is_ready_is_read_from_observations_and_is_diagnosed_as_a_fact():
    abox = required(f"(In a {DRAWER})", f"(Close {DRAWER})")
    seen, before = observation([False, True]), observation([False] * len(abox.preconditions))
    steps = ready(abox, seen, before, KNOWLEDGE)
    assert shown(steps) == [f"Open({DRAWER})", f"In(a, {DRAWER})", f"Close({DRAWER})"]
    first = diagnose_step(steps[0], abox, seen, before, KNOWLEDGE)
    assert (first.fact, first.failure, first.precondition) == (steps[0].fact, MAN + "JointState", True)
    second = diagnose_step(steps[1], abox, seen, before, KNOWLEDGE)
    assert (second.fact, second.failure, second.precondition) == (abox.facts[0], MAN + "RelationMissing", False)
    assert ready(abox, observation([True, True]), before, KNOWLEDGE) == ()


# Laws

ATOMS = [
    *(f"(On {x} {y})" for x, y in product("abc", "abc") if x != y),
    *(f"({word} {x} {place})" for word, place in (("In", DRAWER), ("In", "microwave_1_heating_region")) for x in "ab"),
    "(On a table_1_corner)",
    *(f"({word} {joint})" for word in ("Open", "Close") for joint in (DRAWER, OVEN)),
    "(Turnon stove_1)",
    "(Not (On a b))",
    f"(Not (In a {DRAWER}))",
]


@cache
def goal_of(atoms):
    return required(*atoms)


def facts_of(abox):
    return [*abox.facts, *(each.fact for each in abox.preconditions)]


def same(one, other):
    return (one.predicate, one.arguments, one.polarity) == (other.predicate, other.arguments, other.polarity)


OBJECTS = ("a", "b", "c", "tray_1")
SPOTS = (*OBJECTS, "table_1_corner", "microwave_1_heating_region", DRAWER, "elsewhere")


def holds(fact, places, joints):
    """Whether a fact holds with each object at its place and each joint at its end, or between its ends."""
    name, first = fact.native.predicate, fact.native.arguments[0]
    held = places[first] == fact.native.arguments[1] if name in ("On", "In") else joints[first] == name
    return held == fact.polarity


@st.composite
def situations(draw):
    atoms = tuple(draw(st.lists(st.sampled_from(ATOMS), min_size=1, max_size=4, unique=True)))
    places = {}
    for name in OBJECTS:  # each rests on an earlier one at most, so that none rests on itself
        places[name] = draw(st.sampled_from([spot for spot in SPOTS if spot in places or spot not in OBJECTS]))
    turned = dict(zip(OBJECTS, draw(st.permutations(OBJECTS)), strict=True))
    places = {turned[name]: turned.get(spot, spot) for name, spot in places.items()}
    joints = {joint: draw(st.sampled_from(["Open", "Close", ""])) for joint in (DRAWER, OVEN)}
    joints["stove_1"] = draw(st.sampled_from(["Turnon", ""]))
    abox = goal_of(atoms)
    return abox, tuple(holds(fact, places, joints) for fact in facts_of(abox))


PLACES = {MAN + name for name in ("on", "inside", "in_region")}


def leaves(step, fact):
    """Whether a step brings an object elsewhere than where a fact forbids it to be."""
    placed = step.predicate in PLACES and fact.predicate in PLACES and step.arguments[0] == fact.arguments[0]
    elsewhere = (step.predicate, step.arguments) != (fact.predicate, fact.arguments)
    return placed and elsewhere and step.polarity and not fact.polarity


def after(abox, truth, step):
    facts = facts_of(abox)
    effects = [step, *(fact for fact in facts if leaves(step, fact))]
    return tuple(
        any(same(effect, fact) for effect in effects)
        or (held and not any(exclude(effect, fact, KNOWLEDGE.schema) for effect in effects))
        for fact, held in zip(facts, truth, strict=True)
    )


def planned(abox, truth):
    codes = [TRUE if held else FALSE for held in truth]
    number = len(abox.facts)
    return sequence(abox, codes[:number], codes[number:], KNOWLEDGE)


def attainable(abox, truth):
    """The least number of allowed steps to the goal, None where there is no way: breadth first, over all of them."""
    number = len(abox.facts)
    seen, waiting = {truth: 0}, deque([truth])
    while waiting:
        state = waiting.popleft()
        if all(state[:number]):
            return seen[state]
        for place, fact in enumerate(facts_of(abox)):
            # What takes an object from where it must not be needs what taking it from there needs.
            left = [each for n, each in enumerate(abox.facts) if not state[n] and leaves(fact, each)]
            required = {n for n, each in enumerate(abox.facts) if any(same(each, one) for one in (fact, *left))}
            needed = [n for n, each in enumerate(abox.preconditions) if required & {*each.before}]
            allowed = not state[place] and all(state[number + n] for n in needed)
            if allowed and (reached := after(abox, state, fact)) not in seen:
                seen[reached] = seen[state] + 1
                waiting.append(reached)
    return None


@settings(max_examples=150, deadline=None)
@given(situations())
def test_an_order_is_the_shortest_that_reaches_the_goal_and_exists_where_any_does(situation):
    abox, truth = situation
    number = len(abox.facts)
    fewest = attainable(abox, truth)
    if fewest is None:
        with pytest.raises(OntoError, match="RUN012"):
            planned(abox, truth)
        return
    steps = planned(abox, truth)
    assert len(steps) == fewest
    assert len({(step.precondition, step.index) for step in steps}) == len(steps), "nothing is done twice"
    state = truth
    for step in steps:
        place = step.index + (number if step.precondition else 0)
        assert not state[place], "what holds is not done again"
        for n, each in enumerate(abox.preconditions):
            if not step.precondition and step.index in each.before:
                assert state[number + n]
            if exclude(step.fact, each.fact, KNOWLEDGE.schema):
                assert all(state[other] or other == step.index for other in each.before) or step.precondition
        state = after(abox, state, step.fact)
    assert all(state[:number])


@settings(max_examples=60, deadline=None)
@given(situations())
def test_what_is_left_after_the_first_step_is_the_rest_of_the_order(situation):
    abox, truth = situation
    try:
        steps = planned(abox, truth)
    except OntoError:
        return
    if steps:
        rest = planned(abox, after(abox, truth, steps[0].fact))
        assert shown(rest) == shown(steps[1:])


# Every task of LIBERO

SUITES = {"libero_goal": 10, "libero_spatial": 10, "libero_object": 10, "libero_10": 10, "libero_90": 90}


def told(suite, number):
    """A task's goal, and its order from the declared initial state and from one with everything shut."""
    from runtime.worlds.libero.simulator.assets import find_task

    spec = parse_file(find_task(suite, number).bddl)
    abox = with_preconditions(required_abox(spec, KNOWLEDGE.schema, f"{suite}/{number}"), spec, KNOWLEDGE.schema)

    def status(fact, *, declared):
        held = any(same(fact, premise) for premise in abox.premise) if declared else fact.native.predicate == "Close"
        return TRUE if held or not fact.polarity else FALSE

    lines = [f"{suite} {number}: {', '.join(str(fact.native) for fact in abox.facts)}"]
    for name, declared in (("as declared", True), ("all shut", False)):
        facts = [status(fact, declared=declared) for fact in abox.facts]
        conditions = [status(each.fact, declared=declared) for each in abox.preconditions]
        steps = sequence(abox, facts, conditions, KNOWLEDGE)
        lines.append(f"    {name}: {', '.join(shown(steps)) or 'nothing to do'}")
    return lines


@pytest.mark.sim
def test_the_orders_of_all_tasks_are_those_that_were_read_and_found_right():
    tasks = [(suite, number) for suite, count in SUITES.items() for number in range(count)]
    text = "\n".join(line for task in tasks for line in told(*task)) + "\n"
    assert len(tasks) == 130
    if os.environ.get("ONTO_UPDATE_GOLDENS") == "1":
        GOLDEN.write_text(text, encoding="utf-8")
    assert text == GOLDEN.read_text(encoding="utf-8")
