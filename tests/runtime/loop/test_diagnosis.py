"""Numbers become statuses as the paper says, and a diagnosis keeps the fact whole."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grounding.observation import Evidence, Observation, stack
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.rdf import MAN
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED, SATISFIED, STATUSES, RuleTables
from runtime.loop.diagnosis import by_distance, diagnose, diagnose_goal, evidence_status, select
from runtime.loop.routing import route

NAN = float("nan")
ARGUMENTS = (Entity("bowl_1", MAN + "Object"), Entity("plate_1", MAN + "Object"))


def fact(polarity=True, threshold=0.0, predicate="on"):
    native = NativeAtom("On", ("bowl_1", "plate_1"))
    return Fact(MAN + predicate, ARGUMENTS, native, "on_object", polarity, threshold)


@pytest.mark.parametrize(
    ("polarity", "threshold", "evidence", "status"),
    [
        (True, 0.0, Evidence(True, 0.01), SATISFIED),
        (True, 0.0, Evidence(True, NAN), SATISFIED),
        (True, 0.0, Evidence(True, 0.0), SATISFIED),
        (True, 0.0, None, ABSENT),
        (False, 0.0, None, ABSENT),
        (True, 0.0, Evidence(False, -0.1), EXPLICITLY_FALSE),
        (True, 0.0, Evidence(False, NAN), EXPLICITLY_FALSE),
        (True, 0.02, Evidence(True, 0.01), MARGIN_VIOLATED),
        (True, 0.02, Evidence(True, 0.03), SATISFIED),
        (True, 0.02, Evidence(False, -0.1), EXPLICITLY_FALSE),
        (False, 0.0, Evidence(False, -0.1), SATISFIED),
        (False, 0.0, Evidence(True, 0.1), EXPLICITLY_FALSE),
        (False, 0.05, Evidence(False, -0.01), MARGIN_VIOLATED),
        (True, -0.02, Evidence(False, -0.01), SATISFIED),
        (True, -0.02, Evidence(False, -0.03), EXPLICITLY_FALSE),
        (True, -0.02, Evidence(False, NAN), EXPLICITLY_FALSE),
        (True, -0.02, None, ABSENT),
    ],
)
def test_status_of_one_fact(polarity, threshold, evidence, status):
    codes = evidence_status([fact(polarity, threshold)], stack("sim", 0, [evidence]))
    assert STATUSES[codes[0]] == status


@given(st.data())
def test_statuses_of_many_facts_are_those_of_each_alone(data):
    evidence = st.none() | st.builds(Evidence, st.booleans(), st.floats(-1, 1) | st.just(NAN))
    rows = data.draw(st.lists(st.tuples(st.booleans(), st.floats(-0.1, 0.1), evidence), max_size=8))
    facts = [fact(polarity, threshold) for polarity, threshold, _ in rows]
    together = evidence_status(facts, stack("sim", 0, [e for _, _, e in rows]))
    alone = [evidence_status([f], stack("sim", 0, [e]))[0] for f, (_, _, e) in zip(facts, rows, strict=True)]
    assert together.tolist() == alone


def test_a_diagnosis_keeps_the_fact_and_what_was_seen_of_it():
    observation = stack("sim", 0, [Evidence(True, 0.2), Evidence(False, -0.129, "xy")])
    facts = [fact(), fact(predicate="right_of")]
    (found,) = diagnose(facts, observation, load_knowledge().tables)
    assert found.fact is facts[1]
    assert (found.index, found.failure, found.status) == (1, MAN + "RelationMissing", EXPLICITLY_FALSE)
    assert (found.truth, found.margin, found.limit, found.source) == (False, -0.129, "xy", "sim")


def test_selection_follows_priority_then_the_order_of_the_task():
    observation = stack("sim", 0, [Evidence(False)] * 3)
    facts = [fact(), fact(predicate="joint_state"), fact(predicate="joint_state")]
    assert select(diagnose(facts, observation, load_knowledge().tables)).index == 1


def test_a_status_that_no_rule_speaks_of_is_reported():
    with pytest.raises(OntoError, match="RUN003"):
        diagnose([fact()], stack("sim", 0, [None]), RuleTables({}, {}))


def test_a_failure_without_a_route_is_reported():
    knowledge = load_knowledge()
    (found,) = diagnose([fact()], stack("sim", 0, [None]), knowledge.tables)
    with pytest.raises(OntoError, match="RUN004"):
        route(found, Knowledge(knowledge.schema, RuleTables(knowledge.tables.diagnosis, {})))


def test_facts_and_observation_of_different_length_are_a_programming_error():
    empty = np.empty(0)
    observation = Observation("sim", 0, empty.astype(bool), empty.astype(bool), empty, empty, ())
    with pytest.raises(ValueError, match="1 required facts"):
        evidence_status([fact()], observation)


def goal(alternatives, *facts):
    return RequiredABox("task", "", "p", facts, alternatives=alternatives)


@pytest.mark.parametrize(
    ("evidence", "order"),
    [
        # Fewer unmet facts first, however far away the one is.
        ([Evidence(False, -9), Evidence(False, -0.1), Evidence(False, -0.1)], ((0,), (1, 2))),
        ([Evidence(False, -9), Evidence(False, -0.1), Evidence(True, 0.1)], ((1, 2), (0,))),
        # Of as many, the one that lacks less; what has no margin comes last.
        ([Evidence(False, -0.2), Evidence(True, 0.1), Evidence(False, -0.1)], ((1, 2), (0,))),
        ([Evidence(False, NAN), Evidence(True, 0.1), Evidence(False, -0.1)], ((1, 2), (0,))),
        ([None, Evidence(True, 0.1), Evidence(False, -5)], ((1, 2), (0,))),
        # Of equals the first.
        ([Evidence(True, 0.1), Evidence(True, 0.1), Evidence(True, 0.3)], ((0,), (1, 2))),
    ],
)
def test_the_nearest_alternative_comes_first(evidence, order):
    required = goal(((0,), (1, 2)), fact(), fact(), fact())
    observation = stack("sim", 0, evidence)
    assert by_distance(required, observation) == order
    tables = load_knowledge().tables
    for rank, way in enumerate(order):
        found = diagnose_goal(required, observation, tables, rank)
        whole = diagnose(required.facts, observation, tables)
        assert repr(found) == repr(tuple(d for d in whole if d.index in way))


def test_distance_is_signed_by_polarity():
    required = goal(((0,), (1,)), fact(polarity=False), fact())
    assert by_distance(required, stack("sim", 0, [Evidence(True, 0.01), Evidence(False, -0.02)])) == ((0,), (1,))


def test_a_goal_without_alternatives_asks_for_every_fact():
    required = goal((), fact(), fact(threshold=0.05))
    observation = stack("sim", 0, [Evidence(False, -0.1), Evidence(True, 0.01)])
    tables = load_knowledge().tables
    assert by_distance(required, observation) == ((0, 1),)
    assert diagnose_goal(required, observation, tables) == diagnose(required.facts, observation, tables)
    assert len(diagnose_goal(required, observation, tables)) == 2
