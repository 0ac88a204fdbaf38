"""Made-up episodes of well-known tasks, small enough to check by eye; nothing was simulated."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import runtime
from grounding.observation import Evidence, Observation, stack
from onto_compiler.bddl import lift
from onto_compiler.bddl.parse import parse
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import Span
from onto_compiler.rdf import BASE, MAN
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.tables import FIRST, REPEAT
from runtime.loop.diagnosis import diagnose, select
from runtime.loop.records import Application, Attempt, Episode, ExecutedPlan, Prediction, Proposal, Verification
from runtime.loop.routing import route

KNOWLEDGE = load_knowledge()
SCHEMA = KNOWLEDGE.schema
BOWL, PLATE = Entity("akita_black_bowl_1", MAN + "Object"), Entity("plate_1", MAN + "Object")
STOVE, STOVE_ON = (
    Entity("flat_stove_1", MAN + "ArticulatedFixture"),
    Entity("flat_stove_on", BASE + "libero#flat_stove_on"),
)
FRONT = Entity("main_table_stove_front_region", MAN + "Region")
ON = Fact(
    MAN + "on",
    (BOWL, PLATE),
    NativeAtom("On", ("akita_black_bowl_1", "plate_1")),
    "on_object",
    span=Span("put_the_bowl_on_the_plate.bddl", 87, 10, 87, 42),
)
TURNED_ON = Fact(MAN + "joint_state", (STOVE, STOVE_ON), NativeAtom("Turnon", ("flat_stove_1",)), "joint_threshold")
IN_FRONT = Fact(
    MAN + "in_region",
    (PLATE, FRONT),
    NativeAtom("On", ("plate_1", "main_table_stove_front_region")),
    "placed_in_region",
)
QUERY = "On(akita_black_bowl_1, plate_1)"
PROVENANCE = (("onto-evwm", "0.1.0"), ("mujoco", "3.3.7"), ("seconds", 0.25))


def observed(*evidence, step=10):
    """A simulator's observation of ``(truth, margin, limit)`` triples."""
    return stack("sim", step, [None if e is None else Evidence(*e) for e in evidence])


def attempt(index, facts, observation, *, accepted, settled=None, previous=None, fault="", query=QUERY):
    """One turn as the loop records it: diagnosed, selected and routed by the shipped rules, applied to the state."""
    found = diagnose(facts, observation, KNOWLEDGE.tables)
    chosen = select(found)
    decision = route(chosen, KNOWLEDGE, REPEAT, previous) if previous else route(chosen, KNOWLEDGE)
    if fault:
        return Attempt(index, observation, found, decision, fault=fault)
    qpos = np.array([0.1, -0.2, 0.9, 1.0, 0.0, 0.0, 0.0])
    proposal = Proposal(local_name(decision.route), "heuristic", index, qpos, (0, 1, 2), "above the plate")
    verification = Verification(query, accepted, settled, 20 if settled is not None else 0)
    return Attempt(index, observation, found, decision, Application(proposal, "state", 0.31), verification)


def episode(task, facts, initial, attempts, final, *, outcome, state=0, premise=(), verification=None):
    """An episode of ``libero_goal``; ``premise`` is a pair of declared facts and their observation, or empty."""
    declared, seen = premise or ((), observed())
    holds = bool(np.all(seen.observed & (seen.truth == np.array([f.polarity for f in declared], dtype=np.bool_))))
    last = attempts[-1].verification if attempts else None
    return Episode(
        task=task,
        suite="libero_goal",
        state_index=state,
        seed=7,
        required=RequiredABox(
            task, task.replace("_", " "), "LIBERO_Tabletop_Manipulation", facts, declared, f"{task}.bddl"
        ),
        initial=initial,
        premise=seen,
        premise_holds=holds,
        attempts=tuple(attempts),
        final=final,
        outcome=outcome,
        verification=verification or last,
        provenance=PROVENANCE,
    )


def accepted(task="put_the_bowl_on_the_plate", state=0):
    """The first attempt is rejected, the second accepted, and it still holds after settling."""
    start, nearer = observed((False, -0.142, "x")), observed((False, -0.021, "contact"))
    first = attempt(0, (ON,), start, accepted=False)
    second = attempt(1, (ON,), nearer, accepted=True, settled=True, previous=first.selected.route)
    premise = ((IN_FRONT,), observed((True, 0.04, "y")))
    return episode(
        task,
        (ON,),
        start,
        (first, second),
        observed((True, 0.018, "height")),
        outcome="accepted",
        state=state,
        premise=premise,
    )


def lost_after_settling():
    """Two unmet facts; the one attempt is accepted and does not survive settling."""
    facts = (ON, TURNED_ON)
    start = observed((False, -0.2, "x"), (True, 0.3, "qpos"))
    query = f"And({QUERY}, Turnon(flat_stove_1))"
    turn = attempt(0, facts, start, accepted=True, settled=False, query=query)
    final = observed((False, -0.004, "height"), (True, 0.3, "qpos"))
    return episode("turn_on_the_stove", facts, start, (turn,), final, outcome="accepted")


def disagreement():
    """Grounding finds nothing to correct and the verifier says no."""
    seen = observed((True, 0.02, "x"))
    said = Verification(QUERY, outcome=False)
    return episode(
        "push_the_plate", (ON,), seen, (), seen, outcome="grounding_verifier_disagreement", verification=said
    )


def unresolved():
    """A joint that no attempt corrects, from a start whose premise does not hold."""
    start = observed((False, -0.5, "qpos"))
    turn = attempt(0, (TURNED_ON,), start, accepted=False, query="Turnon(flat_stove_1)")
    premise = ((IN_FRONT,), observed((False, -0.013, "x")))
    return episode(
        "turn_on_the_stove", (TURNED_ON,), start, (turn,), start, outcome="unresolved", state=1, premise=premise
    )


def faulted():
    """The application broke off."""
    start = observed((False, float("nan"), "contact"))
    turn = attempt(0, (ON,), start, accepted=False, fault="qpos[3] is not finite")
    return episode("put_the_bowl_on_the_plate", (ON,), start, (turn,), start, outcome="run_fault", state=2)


def negated():
    """A fact that is required not to hold, and one without evidence."""
    facts = (replace(ON, polarity=False, span=None), IN_FRONT)
    start = observed((True, 0.02, "x"), None)
    turn = attempt(0, facts, start, accepted=False)
    return episode("take_the_bowl_off", facts, start, (turn,), start, outcome="unresolved", state=3)


def played():
    """A controller lost the bowl, tried again in the same route, and was accepted."""
    start, moved = observed((False, -0.4, "xy"), step=0), observed((False, -0.3, "xy"), step=90)
    turns = []
    for index, (seen, steps, end) in enumerate(((start, 90, "lost"), (moved, 110, "completed"))):
        found = diagnose((ON,), seen, KNOWLEDGE.tables)
        chosen = select(found)
        before = (REPEAT, turns[-1].selected.route) if turns else (FIRST, None)
        decision = route(chosen, KNOWLEDGE, *before, level="action")
        proposal = Proposal(local_name(decision.route), "geometry", index, np.empty(0), (), "grasp 10 mm wide")
        reason = "the fingers closed beside the bowl" if end == "lost" else ""
        application = Application(proposal, "controller", 1.2, steps, end, reason)
        verdict = Verification(QUERY, end == "completed", True if end == "completed" else None, 20 * index)
        turns.append(Attempt(index, seen, found, decision, application, verdict))
    final = observed((True, 0.01, "xy"), step=200)
    return episode("put_the_bowl_on_the_plate", (ON,), start, turns, final, outcome="accepted", state=4)


def planned():
    """Two executed plans: the first was predicted to reach the target and did not, the second was bettered first."""
    text = (Path(runtime.__file__).parent / "worlds/pointmaze/tasks/u_maze.bddl").read_text()
    required = lift(parse(text, "pointmaze/u_maze.bddl"), SCHEMA, "u_maze")[0]

    def predicted(*margins, step):
        margin = np.array(margins)
        score = 1 / (1 + np.exp(-8 * margin))
        return Observation("pred", step, np.ones(3, np.bool_), score > 0.5, margin, score, ("",) * 3)

    def shown(*margins, step):
        return observed(*((m > 0, m, "") for m in margins), step=step)

    seen = (predicted(0.4, -0.3, 0.4, step=50), predicted(0.4, -0.1, 0.4, step=50), predicted(0.4, 0.45, 0.4, step=50))
    turns = []
    for index, before in enumerate(seen[:2]):
        found = diagnose(required.facts, before, KNOWLEDGE.tables)
        decision = route(select(found), KNOWLEDGE, *((REPEAT, turns[-1].selected.route) if turns else ()), level="plan")
        name = local_name(decision.route)
        application = Application(Proposal(name, name, index, np.empty(0), ()), "none", 0.0)
        told = Prediction(seen[index + 1], adopted=True, evaluations=2976)
        turns.append(Attempt(index, before, found, decision, application, plan=1, prediction=told))
    ends = (
        (predicted(0.4, -0.2, 0.3, step=25), shown(-0.1, -0.4, 0.2, step=25), 3000),
        (seen[2], shown(0.2, -0.1, 0.4, step=50), 8952),
    )
    query = str(required.facts[0].native)
    plans = tuple(
        ExecutedPlan(
            index, "search", cost, 25, before, diagnose(required.facts, before, KNOWLEDGE.tables), after,
            Verification(query, bool(after.truth[0])),
        )
        for index, (before, after, cost) in enumerate(ends)
    )  # fmt: skip
    start = shown(-1.2, -0.8, 0.4, step=0)
    return Episode(
        task="u_maze", suite="pointmaze", state_index=3, seed=0, required=required, initial=start,
        premise=shown(0.4, step=0), premise_holds=True, attempts=tuple(turns), final=plans[-1].simulated,
        outcome="accepted", verification=plans[-1].verification, plans=plans,
    )  # fmt: skip


def partly_sensed():
    """One executed plan of a robot that senses no velocity: what it is predicted to come to leaves that open."""
    episode = planned()
    plan = episode.plans[1]
    seen = np.array([True, False, True])
    predicted = replace(
        plan.predicted,
        observed=seen,
        truth=plan.predicted.truth & seen,
        margin=np.where(seen, plan.predicted.margin, np.nan),
        score=np.where(seen, plan.predicted.score, np.nan),
    )
    diagnoses = diagnose(episode.required.facts, predicted, KNOWLEDGE.tables)
    return replace(episode, attempts=(), plans=(replace(plan, index=0, predicted=predicted, diagnoses=diagnoses),))


def all_samples():
    """Every sample, none of the same name."""
    return (accepted(), lost_after_settling(), disagreement(), unresolved(), faulted(), negated())
