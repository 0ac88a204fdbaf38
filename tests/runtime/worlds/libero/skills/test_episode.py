"""An episode that skills play, as LIBERO's own environment saw and judged it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, TRACE
from onto_compiler.schema import local_name
from onto_compiler.shapes import compile_shapes, validate
from onto_compiler.sources import load_store
from onto_compiler.tables import FIRST, REPEAT

pytestmark = pytest.mark.sim

MUG = "STUDY_SCENE1_pick_up_the_yellow_and_white_mug_and_place_it_to_the_right_of_the_caddy"


class Script:
    """A player that has its actions and tries, or breaks off as the simulation does."""

    def __init__(self, tries, actions, *, bad=False):
        self.tries, self.actions, self.bad = tries, actions, bad

    def reactive(self, sim, horizon):
        from runtime.loop.faults import RunFault
        from runtime.worlds.libero.skills.play import PlayedEpisode

        for action in self.actions:
            sim.step(action)
        if self.bad:
            sim.data.qvel[:] = 1e9
            with pytest.raises(RunFault):
                sim.step(np.zeros(7))
        return PlayedEpisode(np.array(self.actions).reshape(-1, 7), self.tries, None, False, 0)

    lookahead = reactive


@pytest.fixture(scope="module")
def knowledge():
    from onto_compiler.knowledge import load_knowledge

    return load_knowledge()


@pytest.fixture(scope="module")
def stage(knowledge):
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.native import NativeTask
    from runtime.worlds.libero.skills.episode import EpisodePlayer
    from runtime.worlds.libero.skills.offset_grid import OffsetGrid
    from runtime.worlds.libero.skills.play import Player
    from runtime.worlds.libero.skills.replay import NativeReplay
    from runtime.worlds.required import required_of

    ref = find_task("libero_90", MUG)
    required = required_of(ref, knowledge, ordered=True)
    scene = compile_scene(ref.bddl)
    player = Player(scene, required, knowledge)
    player.skills["pick_and_place"] = OffsetGrid(knowledge.schema)
    with NativeReplay(NativeTask.open(ref), required, knowledge.schema) as replay:
        yield EpisodePlayer(ref, required, knowledge, scene, player, replay, "offset_grid")


@pytest.fixture(scope="module")
def performance(stage):
    return stage.perform(0, 400)


def test_the_first_candidate_is_rejected_and_the_second_accepted_as_the_paper_tells_it(performance, knowledge):
    episode = performance.episode
    first, second = episode.attempts
    assert episode.outcome == "accepted"
    for attempt, verdict, status in ((first, False, FIRST), (second, True, REPEAT)):
        (diagnosis,) = attempt.diagnoses
        names = [argument.name for argument in diagnosis.fact.arguments]
        failure = knowledge.schema.notations[diagnosis.failure]
        assert (failure, local_name(diagnosis.fact.predicate), names) == (
            "relation_missing",
            "right_of",
            ["white_yellow_mug_1", "desk_caddy_1"],
        )
        assert attempt.verification.query == "check_success()"
        assert attempt.verification.outcome is verdict
        assert attempt.selected.attempt_status == status
        assert attempt.selected.level == attempt.selected.requested == "action"
        assert (attempt.application.mode, attempt.application.end) == ("controller", "completed")
    assert second.selected.route == second.selected.previous == first.selected.route
    assert second.selected.decision == CORE + "Retry"
    assert (first.application.proposal.candidate, second.application.proposal.candidate) == (0, 1)
    assert second.verification.settled is True
    # The rejected candidate left the mug beyond the region; the record says by how much, and along which axis.
    assert -0.2 < second.diagnoses[0].margin < -0.03
    assert second.diagnoses[0].limit == "y"
    assert episode.final.margin[0] > 0.0


def test_each_attempt_has_its_steps_and_starts_where_the_last_one_ended(performance):
    episode = performance.episode
    steps = [attempt.application.steps for attempt in episode.attempts]
    assert performance.bounds == (0, steps[0], sum(steps))
    assert len(performance.actions) == sum(steps) == len(performance.qpos) - 1
    assert [attempt.observation.step for attempt in episode.attempts] == [0, steps[0]]
    assert episode.final.step == sum(steps) <= 400
    assert all(attempt.application.displacement > 0.1 for attempt in episode.attempts)


def recorded_and_read_back(episode, knowledge):
    """A store with the record, which conforms to the shapes and reads back as it was."""
    from runtime.trace.names import iri_of
    from runtime.trace.read import read_episode
    from runtime.trace.write import episode_quads
    from tests.runtime.trace.plain import plain

    store = load_store()
    store.extend(episode_quads(episode, knowledge.schema, "run"))
    assert validate(store, compile_shapes(store)) == ()
    iri = iri_of("run", episode)
    assert plain(read_episode(store, iri)) == plain(episode)
    return store


def test_the_record_conforms_and_reads_back(performance, knowledge):
    store = recorded_and_read_back(performance.episode, knowledge)
    ends = list(store.quads_for_pattern(None, _node(TRACE + "end"), _node(TRACE + "Completed"), None))
    assert len(ends) == 2


def test_the_story_and_the_summary_tell_what_the_controller_did(performance, knowledge):
    from runtime.trace.narrate import narrate
    from runtime.trace.summary import episode_summary

    episode = performance.episode
    told = "\n".join(narrate(episode, knowledge.schema))
    assert "through the controller in" in told
    assert "qpos" not in told
    history = json.loads(json.dumps(episode_summary(episode, knowledge.schema)))["history"]
    assert [(turn["mode"], turn["end"], turn["decision"]) for turn in history] == [
        ("controller", "completed", "dispatch"),
        ("controller", "completed", "retry"),
    ]
    assert all(turn["steps"] > 50 and "desk_caddy_1" in turn["note"] for turn in history)


@pytest.fixture(scope="module")
def bowl(knowledge):
    """The bowl that has to go on the plate, with the house's own skills."""
    from runtime.worlds.libero.simulator.assets import find_task
    from runtime.worlds.libero.simulator.compiled import compile_scene
    from runtime.worlds.libero.simulator.native import NativeTask
    from runtime.worlds.libero.skills.episode import EpisodePlayer
    from runtime.worlds.libero.skills.play import Player
    from runtime.worlds.libero.skills.replay import NativeReplay
    from runtime.worlds.required import required_of

    ref = find_task("libero_goal", 8)
    required, scene = required_of(ref, knowledge, ordered=True), compile_scene(ref.bddl)
    player = Player(scene, required, knowledge)
    with NativeReplay(NativeTask.open(ref), required, knowledge.schema) as replay:
        yield EpisodePlayer(ref, required, knowledge, scene, player, replay)


def moved(stage, name, position):
    """A settled state in which an object was put at a position (3,), which may be a function of its scene's poses."""
    from runtime.worlds.libero.simulator.assets import initial_states
    from runtime.worlds.libero.simulator.simulation import Simulation

    sim, index = Simulation(stage.scene, exact=True), stage.scene.index
    sim.reset_to(initial_states(stage.ref)[0])
    sim.settle()
    flat = sim.flat_state
    qpos = flat[1 : 1 + stage.scene.model.nq]
    qpos[index.qpos_slice(index.free_joint(name))][:3] = position(lambda other: sim.data.xpos[index.root_body(other)])
    sim.reset_to(flat)
    sim.settle(40)
    return sim.flat_state


def test_what_lies_on_the_object_to_be_moved_is_recorded_with_each_attempt(bowl, knowledge):
    from runtime.trace.narrate import narrate

    cheese = moved(bowl, "cream_cheese_1", lambda at: at("akita_black_bowl_1") + np.array([0.0, 0.0, 0.05]))
    episode = bowl.perform(-1, 12, state=cheese).episode
    (attempt,) = episode.attempts
    assert episode.outcome == "unresolved"
    told = [(knowledge.schema.notations[d.failure], str(d.fact), d.precondition) for d in attempt.diagnoses]
    assert told == [
        ("relation_missing", "on(akita_black_bowl_1, plate_1)", False),
        ("predicate_mismatch", "not on(cream_cheese_1, akita_black_bowl_1)", True),
    ]
    assert attempt.diagnoses[1].truth is True
    assert attempt.selected.diagnosis == attempt.diagnoses[0]
    line = "  Before it, not on(cream_cheese_1, akita_black_bowl_1) should hold, and nothing has brought that about."
    assert line in list(narrate(episode, knowledge.schema))
    recorded_and_read_back(episode, knowledge)


def test_a_retry_is_recorded_as_one_although_another_fact_was_tried_in_between(bowl):
    cheese = moved(bowl, "cream_cheese_1", lambda at: at("akita_black_bowl_1") + np.array([0.0, 0.0, 0.05]))
    again = _try(bowl.required, 2)
    between = replace(again, fact="not on(cream_cheese_1, akita_black_bowl_1)")
    player = Script((again, between, again), np.zeros((6, 7)))
    episode = replace(bowl, player=player).perform(-1, 100, state=cheese).episode
    told = [(local_name(a.selected.decision), a.selected.attempt_status) for a in episode.attempts[:3]]
    assert told == [("Dispatch", FIRST), ("Dispatch", FIRST), ("Retry", REPEAT)]


def test_an_object_that_no_grasp_reaches_is_an_attempt_without_an_application(bowl, knowledge):
    from runtime.report.filmstrip import shots
    from runtime.trace.narrate import narrate
    from runtime.trace.summary import episode_summary

    seen = []
    far = moved(bowl, "akita_black_bowl_1", lambda _: np.array([2.0, 2.0, 0.1]))
    performance = bowl.perform(-1, 100, state=far, report=seen.append)
    (attempt,) = performance.episode.attempts
    assert seen == [attempt]
    assert performance.episode.outcome == "unresolved"
    assert (attempt.application, attempt.fault) == (None, "")
    assert attempt.verification.outcome is False
    (diagnosis,) = attempt.diagnoses
    assert (knowledge.schema.notations[diagnosis.failure], diagnosis.margin < -1.0) == ("relation_missing", True)
    assert local_name(attempt.selected.route) == "pick_and_place"
    assert performance.bounds == (0, 0)
    assert [(each.name, each.step) for each in shots(performance.actions, performance.bounds)] == [("as it stood", 0)]
    assert "  Application: none, as `pick_and_place` had no candidate." in narrate(
        performance.episode, knowledge.schema
    )
    (turn,) = episode_summary(performance.episode, knowledge.schema)["history"]
    assert (turn["route"], turn["mode"], turn["steps"]) == ("pick_and_place", None, None)
    recorded_and_read_back(performance.episode, knowledge)


def test_a_horizon_that_is_too_short_ends_unresolved_and_says_so(stage):
    (attempt,) = stage.perform(0, 60).episode.attempts
    assert (attempt.application.steps, attempt.application.end) == (60, "out_of_steps")
    assert attempt.verification.outcome is False


def _try(required, steps, outcome="lost", route="pick_and_place", reason=""):
    from runtime.worlds.libero.skills.play import SkillAttempt

    return SkillAttempt(str(required.facts[0]), route, 1, "scripted", steps, outcome, reason)


def test_a_mechanism_that_gives_up_leaves_the_task_unresolved_and_says_why(stage, knowledge):
    from runtime.trace.narrate import narrate
    from runtime.trace.summary import episode_summary

    still = np.zeros((8, 7))
    tries = (_try(stage.required, 3, reason="the fingers closed beside the mug"), _try(stage.required, 5, "odd"))
    episode = replace(stage, player=Script(tries, still)).perform(2, 100).episode
    assert episode.outcome == "unresolved"
    assert [a.application.end for a in episode.attempts] == ["lost", "gave_up"]
    assert [a.selected.attempt_status for a in episode.attempts] == [FIRST, REPEAT]
    assert [a.application.reason for a in episode.attempts] == ["the fingers closed beside the mug", ""]
    told = [line for line in narrate(episode, knowledge.schema) if "Application" in line]
    assert told[0].endswith("as the fingers held nothing: the fingers closed beside the mug.")
    assert told[1].endswith("and given up.")
    history = episode_summary(episode, knowledge.schema)["history"]
    assert [turn["reason"] for turn in history] == ["the fingers closed beside the mug", None]


def test_a_play_that_diverges_is_a_run_fault_and_no_verdict(stage):
    player = Script((_try(stage.required, 4, "horizon"),), np.zeros((4, 7)), bad=True)
    episode = replace(stage, player=player).perform(1, 100).episode
    (attempt,) = episode.attempts
    assert episode.outcome == "run_fault"
    assert "diverged" in attempt.fault
    assert attempt.verification is None
    assert attempt.application.end == ""


@pytest.mark.parametrize(
    "tries",
    [
        lambda required: (_try(required, 4, route="move_joint"),),
        lambda required: (replace(_try(required, 4), fact="on(nothing, nowhere)"),),
    ],
)
def test_a_play_that_the_native_run_does_not_bear_out_is_refused(stage, tries):
    player = Script(tries(stage.required), np.zeros((4, 7)))
    with pytest.raises(OntoError) as caught:
        replace(stage, player=player).perform(1, 100)
    assert caught.value.problems[0].code == "RUN013"


def test_actions_that_the_tries_do_not_account_for_are_refused(stage):
    player = Script((_try(stage.required, 3),), np.full((5, 7), 0.5))
    with pytest.raises(OntoError) as caught:
        replace(stage, player=player).perform(1, 100)
    assert caught.value.problems[0].code == "RUN013"


def test_a_state_that_the_task_does_not_have_is_named(stage):
    with pytest.raises(OntoError) as caught:
        stage.perform(99, 100)
    assert caught.value.problems[0].code == "SIM017"


def _node(iri):
    from pyoxigraph import NamedNode

    return NamedNode(iri)
