"""What a trace tells of plans: predicted beside simulated, and what was tried to better a prediction."""

from __future__ import annotations

from dataclasses import replace

from onto_compiler.rdf import CORE, TRACE
from runtime.trace.narrate import narrate
from runtime.trace.store import TraceStore
from runtime.trace.summary import episode_summary
from tests.runtime.trace.plain import plain
from tests.runtime.trace.samples import KNOWLEDGE, SCHEMA, partly_sensed, planned

STORY = "\n".join(narrate(planned(), SCHEMA))


def test_attempts_stand_before_the_plan_that_they_were_to_better():
    headings = [line for line in STORY.splitlines() if not line.startswith(" ")][1:]
    assert headings == ["Plan 1", "Attempt 1, to better plan 2", "Attempt 2, to better plan 2", "Plan 2", "Outcome"]


def test_a_prediction_that_the_simulator_contradicts_is_called_so():
    assert (
        "predicted to hold (+400 mm, score 0.96), does not hold in the simulator (-100 mm), falsely satisfied" in STORY
    )
    assert STORY.count("falsely satisfied") == 2


def test_a_retained_plan_is_not_called_a_success():
    assert "Diagnosis: the plan is predicted to meet the goal and was retained." in STORY
    assert "The native verifier accepted the state that the last plan led to." in STORY
    rejected = replace(planned(), outcome="unresolved")
    assert not rejected.accepted
    assert "The task stays unresolved: the plans are spent." in "\n".join(narrate(rejected, SCHEMA))


def test_the_route_of_an_imagined_proposal_is_of_the_level_of_plans():
    levels = {SCHEMA.routes[attempt.selected.route].level for attempt in planned().attempts}
    assert levels == {"plan"}
    assert "Route: dispatch to `match_velocity` (plan level)" in STORY
    assert "Proposal: a plan of `match_velocity`, from 2976 candidates, takes the place of the best plan." in STORY


def test_the_summary_has_both_sides_of_every_fact():
    first, second = episode_summary(planned(), SCHEMA)["plans"]
    assert [(fact["predicted"], fact["truth"]) for fact in first["facts"]] == [
        (True, False), (False, False), (True, True)
    ]  # fmt: skip
    assert (first["retained"], second["retained"]) == (False, True)
    assert first["failures"] == ["velocity_mismatch"]


def test_what_was_not_observed_was_predicted_neither_way(tmp_path):
    episode = partly_sensed()
    story = "\n".join(narrate(episode, SCHEMA))
    assert "velocity_matches(ball, target): not predicted, without evidence of it; does not hold in" in story
    assert "to meet the goal as far as it is observed; of velocity_matches(ball, target) there is no evidence." in story
    assert "falsely" not in story
    (plan,) = episode_summary(episode, SCHEMA)["plans"]
    assert [fact["predicted"] for fact in plan["facts"]] == [True, None, True]
    assert not plan["retained"]
    with TraceStore(tmp_path, KNOWLEDGE.schema, "run") as store:
        assert plain(store.episode(store.add(episode))) == plain(episode)


def test_a_planned_episode_that_came_out_differently_is_the_next_trial(tmp_path):
    shorter = replace(planned(), attempts=(), plans=planned().plans[:1])
    with TraceStore(tmp_path, KNOWLEDGE.schema, "run") as store:
        first, second = store.add(planned()), store.add(shorter)
        assert plain(store.episode(first)) == plain(planned())
        assert plain(store.episode(second)) == plain(replace(shorter, trial=1))


def test_the_sources_of_the_two_aboxes_of_a_plan_differ(tmp_path):
    question = f"""SELECT DISTINCT ?kind ?source {{
        ?plan a <{TRACE}ExecutedPlan> ; ?kind ?abox . ?abox a <{TRACE}ObservedABox> ; <{CORE}source> ?source
        }} ORDER BY ?kind"""
    with TraceStore(tmp_path, KNOWLEDGE.schema, "run") as store:
        store.add(planned())
        rows = [tuple(cell.value for cell in row) for row in store.query(question).rows]
    assert rows == [(TRACE + "predicted", CORE + "WorldModel"), (TRACE + "simulated", CORE + "Simulator")]
