"""Guided search on a world whose facts are known: what is diagnosed decides what is tried, and success comes first."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import torch

from grounding.observation import Observation
from grounding.world_model.dynamics import Dynamics, History
from grounding.world_model.facts import FactHead
from grounding.world_model.pred import ObservedGoal, PredGrounder, Predicted
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import diagnose
from runtime.loop.routed import load_routed
from runtime.planning.cem import Budget, Candidate, Sampling, SamplingDistribution
from runtime.planning.guided import improve
from runtime.planning.mechanisms import (
    _urging,
    again,
    longer_horizon,
    match_velocity,
    resample_around_margin,
    waypoint,
)
from runtime.planning.problem import COPIES, PlanningProblem
from runtime.planning.scorers import Weighted, Weights
from runtime.worlds.pointmaze.grounded import required_facts

KNOWLEDGE = load_knowledge()
REQUIRED = required_facts(KNOWLEDGE)
NAMES = [local_name(fact.predicate) for fact in REQUIRED.facts]
ROUTES = [local_name(iri) for iri, route in KNOWLEDGE.schema.routes.items() if route.level == "plan"]
CENTRE, SCALE = [1.8, 1.8, 0.0, 0.0], [2.5, 2.5, 5.0, 5.0]


@dataclass
class Stub:
    """A question whose plans are numbers: the first action decides every margin."""

    budget: Budget
    sampling: Sampling
    observed: tuple[bool, ...] = (True, True, True)

    def judged(self, found: Candidate) -> tuple[Observation, float]:
        margin = torch.full((len(NAMES),), float(found.actions[0, 0]))
        predicted = Predicted(margin, (margin > 0).float(), np.array(self.observed))
        return predicted.observation(step=len(found.actions)), found.cost


def plan(value: float, cost: float = 1.0) -> Candidate:
    actions = torch.full((25, 2), value)
    return Candidate(actions, cost, 100, SamplingDistribution(actions, actions))


def stub() -> Stub:
    return Stub(Budget(), Sampling())


def guided(first: Candidate, answers: dict[str, object], allowance: int = 1000, instead=None, question=None):
    return improve(question or stub(), first, REQUIRED, KNOWLEDGE, answers, allowance, torch.Generator(), instead)


def test_a_plan_whose_facts_hold_is_retained_without_search():
    found = guided(plan(0.5), {})
    assert (found.retained, found.evaluations, found.tried) == (True, COPIES, ())


def test_the_rules_choose_the_mechanism():
    asked: list[tuple[str, str]] = []

    def named(name: str):
        def mechanism(_question, _best, diagnosis, _random):
            asked.append((name, local_name(diagnosis.fact.predicate)))
            return plan(0.5)

        return mechanism

    found = guided(plan(-0.5), {name: named(name) for name in ROUTES})
    assert found.retained
    assert asked == [("resample_around_margin", "free_of")]  # an invalid state comes before all else
    assert found.tried[0].decision is not None
    assert found.tried[0].better


def test_a_plan_with_fewer_unmet_facts_wins_over_a_cheaper_one():
    answers = iter([plan(-0.4, cost=0.1), plan(0.5, cost=9.0)])
    found = guided(plan(-0.5, cost=1.0), {}, instead={"any": lambda *_: next(answers)})
    assert [tried.better for tried in found.tried] == [True, True]
    assert found.found.cost == 9.0
    assert found.retained


def test_a_worse_plan_does_not_take_the_place_of_the_best():
    answers = iter([plan(-0.5, cost=2.0), plan(-0.5, cost=0.5)])
    found = guided(plan(-0.5, cost=1.0), {}, allowance=200, instead={"any": lambda *_: next(answers)})
    assert [tried.better for tried in found.tried] == [False, True]
    assert not found.retained
    assert found.evaluations == 200 + 3 * COPIES


def test_a_control_draws_among_all_that_exist_and_passes_over_what_has_no_answer():
    asked = []

    def named(name: str, answer: Candidate | None):
        def mechanism(*_):
            asked.append(name)
            return answer

        return mechanism

    mechanisms = {"one": named("one", plan(-0.5)), "none": named("none", None), "other": named("other", plan(-0.5))}
    found = guided(plan(-0.5), {}, allowance=20 * (100 + COPIES), instead=mechanisms)
    assert [tried.mechanism for tried in found.tried] == [name for name in asked if name != "none"]
    assert set(asked) == set(mechanisms)
    assert {tried.decision for tried in found.tried} == {None}
    again = guided(plan(-0.5), {}, allowance=20 * (100 + COPIES), instead=mechanisms)
    assert [t.mechanism for t in again.tried] == [t.mechanism for t in found.tried]


def test_a_control_without_any_answer_ends():
    found = guided(plan(-0.5), {}, instead={"none": lambda *_: None})
    assert (found.retained, found.evaluations) == (False, COPIES)
    assert {tried.observation for tried in found.tried} == {None}


def test_a_plan_is_judged_with_its_copies():
    asked = question()
    found = worst(asked)
    seen, cost = asked.judged(found)
    alone = asked.grounder.ground(asked.imagine(found.actions[None]), asked.goal).observation(0, step=25)
    assert seen.source == "pred"
    assert not np.array_equal(seen.margin, alone.margin)
    assert np.allclose(seen.margin, alone.margin, atol=0.1)
    assert cost == pytest.approx(found.cost, abs=0.1)
    again, same = asked.judged(found)
    assert np.array_equal(again.margin, seen.margin)
    assert same == cost


def test_a_second_look_at_candidates_is_that_at_each_alone():
    asked = question()
    plans = torch.rand((3, 25, 2), generator=torch.Generator().manual_seed(1))
    found = asked.judge().cost(plans)
    alone = [asked.judged(Candidate(each, 0.0, 0, SamplingDistribution(each, each)))[1] for each in plans]
    assert found.tolist() == pytest.approx(alone, abs=1e-5)
    assert asked.judge(lambda imagined: imagined.proprio[0, :, -1, 0]).cost(plans).shape == (3,)


def test_members_begin_elsewhere_each_time_a_question_is_asked():
    asked, actions = question(), torch.zeros(1, 25, 2)
    first, second = asked.imagine(actions).path[:, 0, 0], asked.imagine(actions).path[:, 0, 0]
    assert torch.equal(first[0], asked.begin)
    assert torch.equal(second[0], asked.begin)
    assert not torch.equal(first[1], second[1])
    assert torch.equal(question().imagine(actions).path[:, 0, 0], first)


def test_a_plan_that_lacks_less_wins_over_a_cheaper_one():
    answers = iter([plan(-0.6, cost=0.1), plan(-0.4, cost=9.0)])
    found = guided(plan(-0.5, cost=1.0), {}, allowance=200, instead={"any": lambda *_: next(answers)})
    assert [tried.better for tried in found.tried] == [False, True]


def test_a_longer_plan_must_make_more_facts_true():
    longer = [
        Candidate(torch.full((50, 2), value), 0.1, 100, SamplingDistribution(torch.zeros(50, 2), torch.ones(50, 2)))
        for value in (-0.1, 0.5)
    ]
    answers = iter(longer)
    found = guided(plan(-0.5, cost=1.0), {}, allowance=200, instead={"any": lambda *_: next(answers)})
    assert [tried.better for tried in found.tried] == [False, True]
    assert found.retained


def test_where_one_fact_cannot_be_bettered_another_has_its_turn():
    asked = []

    def mechanism(_question, _best, diagnosis, _random):
        asked.append(local_name(diagnosis.fact.predicate))
        return plan(-0.5)

    guided(plan(-0.5), dict.fromkeys(ROUTES, mechanism), allowance=6 * (100 + COPIES))
    assert asked == ["free_of", "free_of", "at_target", "at_target", "velocity_matches", "velocity_matches"]


@pytest.mark.parametrize("control", [False, True], ids=["guided", "control"])
def test_a_fact_without_evidence_is_not_searched_for_and_is_not_held_to_be_true(control):
    unseen = replace(stub(), observed=tuple(name != "velocity_matches" for name in NAMES))
    asked = []

    def mechanism(_question, _best, diagnosis, _random):
        asked.append(local_name(diagnosis.fact.predicate))
        return plan(0.5)

    answers = dict.fromkeys(ROUTES, mechanism)
    found = guided(plan(-0.5), answers, instead=answers if control else None, question=unseen)
    assert asked == ["free_of"]  # after which all that is observed holds
    assert not found.retained
    assert [tried.better for tried in found.tried] == [True]
    assert np.isnan(found.observation.margin).tolist() == [name == "velocity_matches" for name in NAMES]


def test_search_ends_where_no_route_is_left():
    found = guided(plan(-0.5), {})
    assert not found.retained
    assert found.evaluations == COPIES
    assert all(tried.evaluations == 0 for tried in found.tried)


def test_every_registered_mechanism_serves_a_plan_route():
    found = load_routed(KNOWLEDGE.schema, "onto_evwm.mechanisms", "mechanism", "RUN010")
    assert set(found) == set(ROUTES)


def question(longest: int = 10, features: float = 0.0, between: torch.Tensor | None = None) -> PlanningProblem:
    torch.manual_seed(0)
    motion = {"centre": CENTRE, "scale": SCALE, "bound": [9.0] * 4, "actions": 2, "members": 2, "width": 16}
    dynamics = Dynamics(motion, 4, 1.0, width=16)
    head = FactHead(NAMES, CENTRE, SCALE, 4, 1.0)
    for weight in (*dynamics.parameters(), *head.parameters()):
        torch.nn.init.normal_(weight, std=0.1)
    dynamics.requires_grad_(requires_grad=False)
    head.requires_grad_(requires_grad=False)
    grounder = PredGrounder(head, REQUIRED.facts)
    sensed = torch.tensor([True] * 4)
    scorer = Weighted(Weights(proprio=1.0, margins={"at_target": 0.3}), dynamics, None, grounder)
    history = History(torch.full((4,), features), torch.rand(3, 4), torch.rand(2, 5, 2), sensed)
    goal = ObservedGoal(torch.rand(4), torch.tensor([2.0, 1.0, 0.5, -0.5]), sensed)
    return PlanningProblem(dynamics, grounder, scorer, history, goal, Budget(40, 8, 4), Sampling(), longest, between)


def worst(asked: PlanningProblem) -> Candidate:
    actions = torch.full((25, 2), 0.9)
    return Candidate(actions, float(asked.cost(actions[None])[0]), 0, SamplingDistribution(actions, actions))


@pytest.mark.parametrize("mechanism", [resample_around_margin, match_velocity, again])
def test_a_mechanism_returns_a_plan_that_is_no_worse_in_its_judges_eyes(mechanism):
    asked = question()
    best = worst(asked)
    seen, _ = asked.judged(best)
    violated = Observation(
        "pred", 25, seen.observed, np.zeros(3, bool), np.full(3, -0.3), np.zeros(3), ("",) * len(NAMES)
    )
    diagnosis = diagnose(REQUIRED.facts, violated, KNOWLEDGE.tables)[0]
    found = mechanism(asked, best, diagnosis, torch.Generator().manual_seed(0))
    assert found is not None
    assert found.actions.shape == (25, 2)
    assert bool((found.actions.abs() <= 1).all())
    assert found.evaluations > 0
    assert asked.judged(found)[1] <= asked.judged(best)[1]
    assert not found.actions.requires_grad


def test_what_is_not_observed_makes_no_candidate_urgent():
    asked = question()
    best = worst(asked)
    grounder = PredGrounder(asked.grounder.head, REQUIRED.facts, observed=[name == "free_of" for name in NAMES])
    partly = replace(asked, grounder=grounder)
    imagined = asked.imagine(best.actions[None])
    violated = replace(asked.judged(best)[0], truth=np.zeros(3, bool), margin=np.full(3, -0.3))
    diagnosis = next(each for each in diagnose(REQUIRED.facts, violated, KNOWLEDGE.tables) if each.index == 2)
    margin = asked.grounder.ground(imagined, asked.goal).margin[0]
    lack = [max(fact.threshold - float(margin[index]), 0.0) for index, fact in enumerate(REQUIRED.facts)]
    plain = float(asked.price(imagined))
    assert sum(lack[:2]) > 0
    assert float(_urging(asked, diagnosis)(imagined)) == pytest.approx(plain + lack[0] + lack[1] + 2 * lack[2])
    assert float(_urging(partly, diagnosis)(imagined)) == pytest.approx(plain + 2 * lack[2])


def test_a_longer_horizon_is_offered_only_where_there_is_time():
    asked = question(longest=10)
    best = worst(asked)
    found = longer_horizon(asked, best, None, torch.Generator().manual_seed(0))
    assert found is not None
    assert found.actions.shape == (50, 2)
    assert found.evaluations == 2 * (3 * 40 + 2 * COPIES)
    assert longer_horizon(question(longest=9), best, None, torch.Generator().manual_seed(0)) is None


def test_a_waypoint_is_offered_only_where_something_lies_between():
    random = torch.Generator().manual_seed(0)
    asked = question()
    assert waypoint(asked, worst(asked), None, random) is None
    asked = question(between=torch.tensor([2.4, 1.4]))
    found = waypoint(asked, worst(asked), None, random)
    assert found is not None
    assert found.actions.shape == (25, 2)
    assert found.evaluations == 2 * 40 * 2


def test_features_that_are_no_numbers_are_refused_before_planning():
    with pytest.raises(OntoError) as caught:
        question(features=math.nan)
    assert caught.value.problems[0].code == "WM010"
