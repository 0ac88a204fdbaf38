"""The maze's task as typed facts: what it requires, how states are labelled, and where failures are sent."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.rdf import NAV
from runtime.loop.diagnosis import diagnose_goal
from runtime.loop.routing import route
from runtime.worlds.pointmaze.grounded import MazeFacts, required_facts, task_file
from runtime.worlds.pointmaze.maze import MAZES
from runtime.worlds.pointmaze.rollout import Rollout
from runtime.worlds.pointmaze.trajectories import collect
from runtime.worlds.pointmaze.trials import trials
from runtime.worlds.pointmaze.verdict import judge

pytestmark = pytest.mark.sim

U_MAZE = MAZES["u_maze"]
KNOWLEDGE = load_knowledge()
FACTS = MazeFacts(U_MAZE, required_facts(KNOWLEDGE), KNOWLEDGE)
STATE = st.tuples(st.floats(0.3, 3.3), st.floats(0.3, 3.3), st.floats(-6, 6), st.floats(-6, 6))


def test_the_task_requires_place_velocity_and_a_valid_state():
    required = FACTS.required
    assert [str(fact) for fact in required.facts] == [
        "at_target(ball, target)",
        "velocity_matches(ball, target)",
        "free_of(ball, wall)",
    ]
    assert [fact.threshold for fact in required.facts] == [0.35, 0.4, 0.0]
    assert [str(fact.native) for fact in required.premise] == ["FreeOf(ball, wall)"]
    assert [fact.threshold for fact in required.premise] == [0.0]
    assert required.source == "pointmaze/u_maze.bddl"  # wherever the package lies
    assert required_facts(KNOWLEDGE, task_file()).source == str(task_file())


@settings(deadline=None)
@given(state=STATE, goal=STATE)
def test_labels_are_what_the_grounder_observes(state, goal):
    observation = FACTS.observe(np.array(state), np.array(goal))
    labels = FACTS.label(np.array(state), np.array(goal))
    assert observation.source == "sim"
    assert labels.margin == pytest.approx(observation.margin, abs=1e-12)
    assert (labels.truth == (labels.margin > 0)).all()
    assert np.array_equal(labels.margin[:2], observation.margin[:2])
    assert np.array_equal(labels.truth[:2], observation.truth[:2])


def test_the_first_fact_is_the_published_success_on_every_state_of_the_trials():
    pairs = trials(range(60))
    starts, goals = (np.array([getattr(each, part) for each in pairs]) for part in ("start", "goal"))
    actions = np.random.default_rng(0).uniform(-1, 1, (60, 25, 2))
    states = Rollout(U_MAZE).states(starts, actions)
    verdict = judge(states, goals[:, None])
    labels = FACTS.label(states, goals[:, None])
    assert labels.truth.shape == (60, 26, 3)
    assert np.array_equal(labels.truth[..., 0], verdict.success)
    assert 0.05 < verdict.success.mean() < 0.95
    assert np.array_equal(verdict.distance >= np.maximum(verdict.position, verdict.velocity), np.ones((60, 26), bool))
    assert np.hypot(verdict.position, verdict.velocity) == pytest.approx(verdict.distance)


def test_no_motion_leads_to_an_invalid_state():
    states = collect(U_MAZE, count=300, seed=3, split="test").states
    labels = FACTS.label(states, states[:, :1])
    assert labels.truth[..., 2].all()
    assert labels.margin[..., 2].min() < 0.05, "the walls are met hard"


@pytest.mark.parametrize(
    ("state", "failures"),
    [
        ((0.8, 0.8, 1.0, 0.0), []),
        ((0.8, 1.15, 1.0, 0.0), [("TargetDistance", "resample_around_margin")]),
        ((0.8, 2.8, 1.0, 0.0), [("EntityMissing", "longer_horizon")]),
        ((0.8, 0.8, 1.0, 0.6), [("VelocityMismatch", "match_velocity")]),
        (
            (0.2, 0.8, -3.0, 0.0),
            [
                ("EntityMissing", "longer_horizon"),
                ("VelocityMismatch", "match_velocity"),
                ("InvalidState", "resample_around_margin"),
            ],
        ),
    ],
)
def test_each_failure_of_the_paper_is_diagnosed_and_sent_to_a_plan_route(state, failures):
    observation = FACTS.observe(np.array(state), np.array([0.8, 0.8, 1.0, 0.0]))
    found = diagnose_goal(FACTS.required, observation, KNOWLEDGE.tables)
    decisions = [route(each, KNOWLEDGE, level="plan") for each in found]
    assert [(each.failure, decision.route) for each, decision in zip(found, decisions, strict=True)] == [
        (NAV + failure, NAV + name) for failure, name in failures
    ]
    assert [decision.level for decision in decisions] == ["plan"] * len(failures)


def test_a_maze_grounds_in_each_of_its_layouts():
    for maze in MAZES.values():
        facts = MazeFacts(maze, required_facts(KNOWLEDGE), KNOWLEDGE)
        goal = np.array([*maze.centres[-1], 0.0, 0.0])
        assert facts.observe(goal, goal).truth.all()


@pytest.mark.parametrize(
    ("state", "goal", "code"),
    [
        (np.zeros(3), np.zeros(4), "PMZ003"),
        (np.zeros(4), np.zeros(2), "PMZ003"),
        (np.zeros(4), np.array([0, 0, np.nan, 0]), "PMZ004"),
    ],
)
def test_states_that_are_none_are_refused(state, goal, code):
    for refuse in (FACTS.observe, FACTS.label, judge):
        with pytest.raises(OntoError) as caught:
            refuse(state, goal)
        assert [problem.code for problem in caught.value.problems] == [code]


def test_libero_says_whose_task_it_cannot_build():
    from runtime.worlds.libero.simulator.native import NativeTask

    with pytest.raises(OntoError) as caught:
        NativeTask(task_file())
    [problem] = caught.value.problems
    assert (problem.code, problem.hint) == ("SIM016", "it is a task of PointMaze, which LIBERO does not play")


def test_a_fact_that_no_batch_can_label_is_refused(tmp_path):
    turtle = tmp_path / "lab.ttl"
    turtle.write_text(
        f"""@prefix core: <https://w3id.org/onto-evwm/core#> . @prefix nav: <{NAV}> .
        @prefix my: <https://example.org/my#> .
        my:lift a core:Binding ; core:native "AtTarget" ; core:nativeDomain "pointmaze" ; core:order 1 ;
            core:nativeArgument1 nav:Agent ; core:nativeArgument2 nav:Target ; core:lifts nav:at_target ;
            core:groundedBy "on_object" ."""
    )
    knowledge = load_knowledge(turtle)
    with pytest.raises(OntoError) as caught:
        MazeFacts(U_MAZE, required_facts(knowledge), knowledge)
    assert {problem.code for problem in caught.value.problems} <= {"SIM005", "SIM006"}
