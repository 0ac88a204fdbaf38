"""The arms of state repair differ in the order of routes alone, and are compared on the states that both were given."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.route_arms import ARMS, Asked, permuted_types, state_routes
from benchmarks.runtime_tables import state_repair_table
from benchmarks.state_repair import CONTROLS, METHODS, STATE_REPAIR
from grounding.observation import Evidence, stack
from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import CORE, MAN
from onto_compiler.required import Entity, Fact, NativeAtom
from runtime.loop.diagnosis import diagnose
from runtime.loop.routing import by_rule, route

pytestmark = pytest.mark.sim

KNOWLEDGE = load_knowledge()
ROUTES = state_routes(KNOWLEDGE)
ON = Fact(
    MAN + "on",
    (Entity("bowl_1", MAN + "Object"), Entity("plate_1", MAN + "Object")),
    NativeAtom("On", ("bowl_1", "plate_1")),
    "on_object",
)
(FAILURE,) = diagnose([ON], stack("sim", 0, [Evidence(False, -0.2, "xy")]), KNOWLEDGE.tables)


def orders(arm, attempts=8, seed=0):
    routing = ARMS[arm](np.random.default_rng(seed))
    return [[each.route for each in routing(FAILURE, KNOWLEDGE, None)] for _ in range(attempts)]


def test_every_control_but_the_permuted_one_offers_every_route_at_each_attempt():
    for arm in ("fresh_random", "fixed_order", "round_robin"):
        assert all(sorted(order) == sorted(ROUTES) for order in orders(arm))


def test_a_fixed_order_is_always_the_same_and_turns_are_taken_one_after_the_other():
    assert orders("fixed_order") == [list(ROUTES)] * 8
    assert [order[0] for order in orders("round_robin")] == [*ROUTES, *ROUTES]


def test_random_orders_are_drawn_anew_for_each_attempt_and_again_alike_from_the_same_seed():
    drawn = orders("fresh_random", attempts=40)
    assert {order[0] for order in drawn} == set(ROUTES)
    assert drawn == orders("fresh_random", attempts=40)
    assert drawn != orders("fresh_random", attempts=40, seed=1)


def test_a_control_says_of_itself_what_it_did_and_names_no_rule():
    decisions = list(ARMS["fixed_order"](np.random.default_rng(0))(FAILURE, KNOWLEDGE, ROUTES[1]))
    assert [d.decision.removeprefix(CORE) for d in decisions] == ["Reroute", "Retry", "Reroute", "Reroute"]
    assert {(d.rule, d.previous, d.diagnosis) for d in decisions} == {("", ROUTES[1], FAILURE)}


def test_permuted_types_are_sent_elsewhere_first_and_keep_their_record():
    kinds = permuted_types(KNOWLEDGE)
    assert len(set(kinds.values())) == len(kinds) == 4
    schema, tables = KNOWLEDGE.schema, KNOWLEDGE.tables.routing
    first = {
        (schema.predicates[predicate].kind, failure): entry.route
        for (predicate, failure, _, previous, level), entry in tables.items()
        if level == "state" and previous is None
    }
    for own, (predicate, failure) in kinds.items():
        assert first[own] != first[schema.predicates[predicate].kind, failure]
    chosen = list(ARMS["permuted"](np.random.default_rng(0))(FAILURE, KNOWLEDGE, None))
    assert chosen[0].route != route(FAILURE, KNOWLEDGE).route
    assert {each.diagnosis for each in chosen} == {FAILURE}


def test_the_typed_arm_is_the_shipped_routing():
    assert ARMS["typed"](np.random.default_rng(0)) is by_rule


def test_routes_are_counted_as_they_are_asked():
    asked = Asked(ARMS["fixed_order"](np.random.default_rng(0)))
    next(asked(FAILURE, KNOWLEDGE, None))
    next(asked(FAILURE, KNOWLEDGE, None))
    assert asked.count == 2


def row(method, state, *, accepted=True, attempts=1, task=0):
    return {
        "method": method, "suite": "libero_goal", "task": task, "state": state, "accepted": accepted,
        "settled": accepted, "initially_true": False, "attempts": attempts, "asked": attempts + 1,
        "unmet": ["on(a, b)"], "premise_holds": True,
    }  # fmt: skip


def test_controls_are_compared_on_the_states_that_both_were_given():
    rows = [row("typed", state) for state in range(20)]
    rows += [row("permuted", state, accepted=state > 5, attempts=2 * (state > 2)) for state in range(10)]
    found = STATE_REPAIR.metrics(rows)
    assert (found["typed"], found["permuted"]) == (1.0, 0.4)
    assert found["typed_vs_permuted.pairs"] == 10
    assert (found["typed_vs_permuted.accepted.only_typed"], found["typed_vs_permuted.accepted.only_control"]) == (6, 0)
    assert found["typed_vs_permuted.accepted.p"] == pytest.approx(2 / 64)
    assert found["typed_vs_permuted.one_attempt_per_fact.only_typed"] == 10
    assert found["typed_vs_permuted.attempts"] == pytest.approx(0.4)
    assert (found["permuted.all.failed"], found["permuted.all.failed_without_attempt"]) == (6, 3)


def test_a_crashed_episode_is_a_failure_and_spends_nothing():
    crashed = {"method": "permuted", "suite": "libero_goal", "task": 0, "state": 0, "crashed": "Boom", "detail": ""}
    found = STATE_REPAIR.metrics([row("typed", 0), row("typed", 1), crashed, row("permuted", 1)])
    assert (found["crashed"], found["permuted"]) == (1, 0.5)
    assert found["typed_vs_permuted.accepted.only_typed"] == 1
    assert found["typed_vs_permuted.attempts"] == 0.0


def test_the_page_has_a_line_for_each_arm_and_each_control():
    rows = [row(method, state) for method in METHODS for state in range(2)]
    lines = state_repair_table({"metrics": STATE_REPAIR.metrics(rows), "rows": rows}).splitlines()
    assert sum(line.startswith("| all | ") for line in lines) == len(METHODS)
    assert [line.split(" | ")[:3] for line in lines if line.startswith("| `permuted` |")] == [
        ["| `permuted`", "2", "0 / 0"]
    ]
    assert all(any(line.startswith(f"| `{control}` | 2 |") for line in lines) for control in CONTROLS)


def test_the_rows_of_an_arm_can_be_made_again():
    trial = {
        "key": "libero_goal/5/0/fresh_random",
        "suite": "libero_goal",
        "task": 5,
        "state": 0,
        "method": "fresh_random",
    }
    pytest.importorskip("libero")
    one, other = STATE_REPAIR.run(trial), STATE_REPAIR.run(trial)
    assert one == other
    assert one[0]["accepted"] is True
