"""Every branch of Algorithm 1, on an environment whose answers are written down beforehand."""

import numpy as np
import pytest

from grounding.observation import Evidence, stack
from onto_compiler.knowledge import load_knowledge
from onto_compiler.rdf import CORE, MAN
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from runtime.loop.correction import CorrectionLoop, RunFault
from runtime.loop.records import Application, Proposal, RouteDecision, Verification
from runtime.loop.routing import by_rule

TRUE, FALSE = Evidence(True, 0.01, "xy"), Evidence(False, -0.2, "xy")
BOWL, PLATE = Entity("bowl_1", MAN + "Object"), Entity("plate_1", MAN + "Object")
ON = Fact(MAN + "on", (BOWL, PLATE), NativeAtom("On", ("bowl_1", "plate_1")), "on_object")
OPEN = Fact(
    MAN + "joint_state",
    (Entity("drawer", MAN + "Drawer"), Entity("wooden_cabinet_open", "urn:threshold")),
    NativeAtom("Open", ("drawer",)),
    "joint_threshold",
)


class Scripted:
    """An environment that plays back one evidence per fact and one verdict per applied proposal."""

    scene = None
    qpos = np.zeros(3)
    qvel = np.zeros(2)

    def __init__(self, states, verdicts, settles=True):
        self.states, self.verdicts, self.settles, self.now = states, verdicts, settles, 0
        self.applied = []

    def observe(self):
        return stack("sim", self.now, self.states[self.now])

    def observe_at(self, qpos):
        return self.observe()

    def apply(self, proposal):
        self.applied.append(proposal)
        if isinstance(self.verdicts[self.now + 1], Exception):
            raise self.verdicts[self.now + 1]
        self.now += 1
        return Application(proposal, "state", 0.1)

    def verify(self):
        return Verification("check_success()", self.verdicts[self.now])

    def settle(self, verification):
        return Verification(verification.query, verification.outcome, self.settles, 20)


class Offers:
    """A proposer that has ``count`` candidates."""

    def __init__(self, name, count=99):
        self.name, self.count, self.asked = name, count, []

    def propose(self, request):
        self.asked.append((request.diagnosis.index, request.candidate))
        if request.candidate >= self.count:
            return None
        return Proposal(self.name, self.name, request.candidate, np.zeros(3), ())


class Unstable(Scripted):
    """Falls back to the first state where what the native predicate accepts does not settle, ``falls`` times."""

    def __init__(self, states, verdicts, falls):
        super().__init__(states, verdicts)
        self.falls = falls

    def observe(self):
        return stack("sim", self.now, self.states[0 if self.fallen else self.now])

    def apply(self, proposal):
        self.fallen = False
        return super().apply(proposal)

    fallen = False

    def verify(self):
        return Verification("check_success()", not self.fallen and self.verdicts[self.now])

    def settle(self, verification):
        self.falls -= 1
        self.fallen = self.falls >= 0
        return Verification(verification.query, verification.outcome, not self.fallen, 20)


def run(facts, environment, budget=4, predicted=None, alternatives=(), routing=by_rule, **counts):
    names = ("source_joint_pose", "object_relation_predicate", "rack_contact_site", "source_joint_residual")
    proposers = {name: Offers(name, counts.get(name, 99)) for name in names}
    loop = CorrectionLoop(load_knowledge(), proposers, budget, routing)
    required = RequiredABox("task", "do it", "problem", tuple(facts), alternatives=alternatives)
    seen = []
    rng = np.random.default_rng(0)
    result = loop.run(required, environment, rng, predicted=predicted, report=seen.append)
    assert tuple(seen) == result.attempts
    return result


def routes(result):
    return [(a.selected.route.removeprefix(MAN), a.selected.decision.removeprefix(CORE)) for a in result.attempts]


def test_a_satisfied_prediction_is_retained_and_nothing_is_executed():
    environment = Scripted([[FALSE]], [False])
    result = run([ON], environment, predicted=stack("pred", 25, [TRUE]))
    assert (result.outcome, result.attempts, result.verification) == ("retained", (), None)
    assert environment.applied == []


def test_a_prediction_needs_no_environment():
    assert run([ON], None, predicted=stack("pred", 25, [TRUE])).outcome == "retained"
    assert run([ON], None, predicted=stack("pred", 25, [FALSE])).outcome == "unresolved"


def test_an_unsatisfied_prediction_is_corrected_and_regrounded_in_the_simulator():
    environment = Scripted([[FALSE], [FALSE], [TRUE]], [False, False, True])
    result = run([ON], environment, predicted=stack("pred", 25, [FALSE]))
    assert result.outcome == "accepted"
    assert [a.observation.source for a in result.attempts] == ["pred", "sim"]
    assert [a.diagnoses[0].source for a in result.attempts] == ["pred", "sim"]


def test_one_alternative_is_enough():
    environment = Scripted([[FALSE, FALSE], [FALSE, TRUE]], [False, True])
    prediction = stack("pred", 0, [FALSE, TRUE])
    assert run([ON, OPEN], None, predicted=prediction).outcome == "unresolved"
    assert run([ON, OPEN], None, predicted=prediction, alternatives=((0,), (1,))).outcome == "retained"
    result = run([ON, OPEN], environment, alternatives=((0, 1), (1,)))
    assert result.outcome == "accepted"
    assert [d.index for d in result.attempts[0].diagnoses] == [1]


def test_a_simulated_state_that_holds_is_verified():
    result = run([ON], Scripted([[TRUE]], [True]))
    assert (result.outcome, result.attempts) == ("verified", ())
    assert result.verification == Verification("check_success()", True, True, 20)


def test_the_verifier_is_asked_before_a_simulated_state_is_corrected():
    """Step 3 queries V for every simulated state, even where grounding finds something unmet."""
    result = run([ON], Scripted([[FALSE]], [True]))
    assert (result.outcome, result.attempts) == ("verified", ())


def test_a_grounding_verifier_disagreement_is_unresolved_and_named():
    result = run([ON], Scripted([[TRUE]], [False]))
    assert (result.outcome, result.attempts) == ("grounding_verifier_disagreement", ())
    assert result.verification.outcome is False


def test_a_disagreement_after_an_attempt_is_named_too():
    result = run([ON], Scripted([[FALSE], [TRUE]], [False, False]))
    assert result.outcome == "grounding_verifier_disagreement"
    assert len(result.attempts) == 1


def test_an_accepted_state_ends_the_loop_and_is_asked_again_after_settling():
    result = run([ON], Scripted([[FALSE], [TRUE]], [False, True]))
    assert result.outcome == "accepted"
    assert result.verification == Verification("check_success()", True, True, 20)
    assert result.final.truth.tolist() == [True]


def test_a_rejected_attempt_is_rerouted_then_retried():
    result = run([ON], Scripted([[FALSE]] * 4, [False] * 4), budget=3)
    assert result.outcome == "unresolved"
    assert routes(result) == [
        ("object_relation_predicate", "Dispatch"),
        ("source_joint_residual", "Reroute"),
        ("source_joint_residual", "Retry"),
    ]
    assert [a.application.proposal.candidate for a in result.attempts] == [0, 0, 1]


def test_a_spent_budget_is_unresolved_and_keeps_the_last_verdict():
    result = run([ON], Scripted([[FALSE]] * 3, [False] * 3), budget=2)
    assert (result.outcome, len(result.attempts)) == ("unresolved", 2)
    assert result.verification.outcome is False


def test_a_budget_of_nothing_diagnoses_and_stops():
    result = run([ON], Scripted([[FALSE]], [False]), budget=0)
    assert (result.outcome, result.attempts) == ("unresolved", ())


def test_an_exhausted_residual_returns_to_the_first_route():
    result = run([ON], Scripted([[FALSE]] * 5, [False] * 5), budget=4, source_joint_residual=1)
    assert routes(result) == [
        ("object_relation_predicate", "Dispatch"),
        ("source_joint_residual", "Reroute"),
        ("object_relation_predicate", "Reroute"),
        ("object_relation_predicate", "Reroute"),
    ]
    assert [a.application.proposal.candidate for a in result.attempts] == [0, 0, 1, 2]


def test_no_candidate_on_any_route_is_unresolved():
    result = run([ON], Scripted([[FALSE]], [False]), object_relation_predicate=0, source_joint_residual=0)
    assert (result.outcome, result.attempts) == ("unresolved", ())


def test_a_fault_is_no_execution_failure():
    result = run([ON], Scripted([[FALSE]], [False, RunFault("qpos is not finite at 3")]))
    assert result.outcome == "run_fault"
    assert result.attempts[0].fault == "qpos is not finite at 3"
    assert result.attempts[0].verification is None
    assert result.verification is None


def test_joints_are_corrected_before_relations():
    states = [[FALSE, FALSE], [FALSE, TRUE], [TRUE, TRUE]]
    result = run([ON, OPEN], Scripted(states, [False, False, True]))
    assert result.outcome == "accepted"
    assert routes(result) == [("source_joint_pose", "Dispatch"), ("object_relation_predicate", "Dispatch")]
    assert [len(a.diagnoses) for a in result.attempts] == [2, 1]


def test_a_fact_that_is_selected_again_is_rerouted_although_another_was_attempted_in_between():
    states = [[FALSE, FALSE], [FALSE, TRUE], [FALSE, FALSE], [TRUE, TRUE]]
    result = run([ON, OPEN], Scripted(states, [False, False, False, True]))
    assert routes(result) == [
        ("source_joint_pose", "Dispatch"),
        ("object_relation_predicate", "Dispatch"),
        ("source_joint_residual", "Reroute"),
    ]
    last = result.attempts[-1].selected
    assert (last.attempt_status, last.previous) == (CORE + "RepeatAttempt", MAN + "source_joint_pose")


def test_a_fact_that_stays_unmet_while_another_is_attempted_keeps_its_place():
    """After its residual route was followed: the next attempt on it is a retry, whatever was attempted in between."""
    states = [[FALSE, TRUE], [FALSE, TRUE], [FALSE, FALSE], [FALSE, TRUE], [TRUE, TRUE]]
    result = run([ON, OPEN], Scripted(states, [False, False, False, False, True]), budget=8)
    assert routes(result) == [
        ("object_relation_predicate", "Dispatch"),
        ("source_joint_residual", "Reroute"),
        ("source_joint_pose", "Dispatch"),
        ("source_joint_residual", "Retry"),
    ]
    assert [a.application.proposal.candidate for a in result.attempts] == [0, 0, 0, 1]


def test_a_routing_of_ones_own_is_asked_for_each_attempt_and_falls_through_to_its_next_route():
    asked = []

    def backwards(diagnosis, knowledge, rejected):
        asked.append(rejected)
        for iri in sorted(
            (iri for iri, each in knowledge.schema.routes.items() if each.level == "state"), reverse=True
        ):
            yield RouteDecision(iri, diagnosis, "state", CORE + "Dispatch", "")

    result = run([ON], Scripted([[FALSE]] * 3, [False] * 3), budget=2, routing=backwards, source_joint_residual=1)
    assert [route for route, _ in routes(result)] == ["source_joint_residual", "source_joint_pose"]
    assert asked == [None, MAN + "source_joint_residual"]


def test_a_route_without_a_proposer_is_passed_over():
    loop = CorrectionLoop(load_knowledge(), {"source_joint_residual": Offers("source_joint_residual")}, 2)
    required = RequiredABox("task", "do it", "problem", (ON,))
    result = loop.run(required, Scripted([[FALSE], [TRUE]], [False, True]), np.random.default_rng(0))
    assert routes(result) == [("source_joint_residual", "Reroute")]
    assert result.outcome == "accepted"


def test_a_simulator_source_without_an_environment_is_a_programming_error():
    with pytest.raises(ValueError, match="environment"):
        run([ON], None)


def test_an_accepted_state_that_does_not_settle_counts_as_rejected():
    result = run([ON], Unstable([[FALSE], [TRUE], [TRUE]], [False, True, True], falls=1))
    assert result.outcome == "accepted"
    lost, kept = result.attempts
    assert (lost.verification.outcome, lost.verification.settled) == (True, False)
    assert (kept.verification.outcome, kept.verification.settled) == (True, True)
    assert routes(result)[0][1] == "Dispatch"
    assert routes(result)[1][1] in {"Retry", "Reroute"}
    assert kept.diagnoses[0].fact == ON  # of the state that it settled to


def test_a_budget_that_is_spent_on_states_that_do_not_settle_is_unresolved_and_says_why():
    states, verdicts = [[FALSE], [TRUE], [TRUE]], [False, True, True]
    result = run([ON], Unstable(states, verdicts, falls=9), budget=2)
    assert (result.outcome, len(result.attempts)) == ("unresolved", 2)
    assert result.reason == "the last state that was accepted did not survive 20 steps of settling"
    assert (result.verification.outcome, result.verification.settled) == (True, False)


def test_a_start_that_is_accepted_and_does_not_settle_is_corrected_from_where_it_settled():
    environment = Unstable([[FALSE], [TRUE]], [True, True], falls=1)
    result = run([ON], environment)
    assert (result.outcome, len(result.attempts)) == ("accepted", 1)
    assert (result.lost.outcome, result.lost.settled) == (True, False)
    result = run([ON], Unstable([[FALSE], [TRUE]], [True, True], falls=1), budget=0)
    assert (result.outcome, result.attempts, result.verification) == ("unresolved", (), result.lost)
    assert result.reason.endswith("did not survive 20 steps of settling")


def test_a_route_that_nothing_serves_ends_unresolved_and_says_so():
    """Of the two routes of a relation, one after the other: the failure is kept, and what is missing is named."""
    loop = CorrectionLoop(load_knowledge(), {}, 4)
    required = RequiredABox("task", "do it", "problem", (ON,))
    result = loop.run(required, Scripted([[FALSE]], [False]), np.random.default_rng(0))
    assert (result.outcome, result.attempts) == ("unresolved", ())
    assert result.reason == "no proposer is registered as `object_relation_predicate` or `source_joint_residual`"


def test_an_exhausted_budget_needs_no_further_reason():
    assert run([ON], Scripted([[FALSE]] * 5, [False] * 5)).reason == ""


def test_a_missing_route_says_what_it_lacks():
    """The level, the failure, the kind, or the rule: never what is there."""
    from dataclasses import replace

    from onto_compiler.knowledge import Knowledge
    from onto_compiler.problems import OntoError
    from onto_compiler.tables import RuleTables
    from runtime.loop.diagnosis import diagnose
    from runtime.loop.routing import route

    known = load_knowledge()
    (found,) = diagnose([ON], stack("sim", 0, [FALSE]), known.tables)
    silent = RuleTables(known.tables.diagnosis, {})
    routes = known.schema.routes.items()

    def said(**changes):
        schema = replace(known.schema, routes={iri: replace(each, **changes) for iri, each in routes})
        with pytest.raises(OntoError, match="RUN004") as caught:
            route(found, Knowledge(schema, silent))
        return caught.value.problems[0]

    assert "no route of the state level admits `RelationMissing`" in said(level="plan").message
    assert "no route of the state level admits `RelationMissing`" in said(admits=frozenset()).message
    assert "does not support its kind, `ObjectRelation`" in said(supports=frozenset()).message
    assert "no routing rule sends" in said().message
    assert "core:supports" in said(supports=frozenset()).hint
