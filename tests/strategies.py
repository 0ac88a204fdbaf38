"""Hypothesis strategies for the records of the loop: whatever a schema's predicates, rules and routes allow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from grounding.observation import Observation
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import Span
from onto_compiler.rdf import CORE
from onto_compiler.required import Entity, Fact, NativeAtom, Precondition, RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.tables import ATTEMPT_STATUSES, LEVELS, STATUSES
from runtime.loop.records import (
    Application,
    Attempt,
    Diagnosis,
    Episode,
    ExecutedPlan,
    Prediction,
    Proposal,
    RouteDecision,
    Verification,
)
from runtime.trace.names import ENDS

SCHEMA = load_schema()
NAN = float("nan")
OUTCOMES = ("retained", "verified", "accepted", "unresolved", "grounding_verifier_disagreement", "run_fault")
RULES = tuple(f"https://w3id.org/onto-evwm/rules#{name}" for name in ("relation_missing", "joint_state", "dispatch"))

names = st.from_regex(r"[a-z][a-z0-9_]{0,12}", fullmatch=True)
texts = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\x00"), max_size=20)
numbers = st.floats(allow_nan=False)
margins = st.one_of(st.just(NAN), numbers)
thresholds = {threshold.iri for threshold in SCHEMA.thresholds.values()}
classes = sorted(iri for iri in SCHEMA.classes if SCHEMA.is_a(iri, CORE + "Entity"))


@st.composite
def spans(draw):
    line, column = draw(st.integers(1, 300)), draw(st.integers(1, 120))
    return Span(draw(names) + ".bddl", line, column, line + draw(st.integers(0, 3)), column + draw(st.integers(1, 40)))


@st.composite
def facts(draw, scene):
    """A fact whose arguments come from ``scene``, a mapping from names to classes that draws extend."""
    signature = SCHEMA.predicates[draw(st.sampled_from(sorted(SCHEMA.predicates)))]
    arguments = []
    for parameter in signature.parameters:
        if SCHEMA.is_a(parameter, CORE + "Threshold"):
            iri = draw(st.sampled_from(sorted(thresholds)))
            arguments.append(Entity(local_name(iri), iri))
        else:
            name = draw(names)
            arguments.append(Entity(name, scene.setdefault(name, draw(st.sampled_from(classes)))))
    return Fact(
        predicate=signature.iri,
        arguments=tuple(arguments),
        # Any text: an atom is stated part by part, and never read from what it prints as.
        native=NativeAtom(draw(texts), tuple(draw(st.lists(texts, max_size=3)))),
        grounded_by=draw(names),
        polarity=draw(st.booleans()),
        threshold=draw(numbers),
        span=draw(st.none() | spans()),
    )


@st.composite
def observations(draw, size):
    """Arrays of ``size`` that keep the contract of :func:`grounding.observation.stack`."""
    observed = draw(st.lists(st.booleans(), min_size=size, max_size=size))
    seen = [draw(st.tuples(st.booleans(), margins, margins, texts)) if o else (False, NAN, NAN, "") for o in observed]
    return Observation(
        source=draw(st.sampled_from(("sim", "pred"))),
        step=draw(st.integers(0, 1000)),
        observed=np.array(observed, dtype=np.bool_),
        truth=np.array([truth for truth, *_ in seen], dtype=np.bool_),
        margin=np.array([margin for _, margin, *_ in seen], dtype=np.float64),
        score=np.array([score for *_, score, _ in seen], dtype=np.float64),
        limit=tuple(limit for *_, limit in seen),
    )


@st.composite
def diagnoses(draw, required, index, precondition=False):
    facts = [each.fact for each in required.preconditions] if precondition else required.facts
    return Diagnosis(
        fact=facts[index],
        index=index,
        failure=draw(st.sampled_from(sorted(SCHEMA.failures))),
        status=draw(st.sampled_from(STATUSES[1:])),
        truth=draw(st.booleans()),
        margin=draw(margins),
        limit=draw(texts),
        source=draw(st.sampled_from(("sim", "pred"))),
        rule=draw(st.sampled_from(RULES)),
        priority=draw(st.integers(0, 1000)),
        precondition=precondition,
    )


@st.composite
def verifications(draw):
    settled = draw(st.none() | st.booleans())
    return Verification(draw(texts), draw(st.booleans()), settled, draw(st.integers(0, 100)))


@st.composite
def attempts(draw, required, index):
    size = len(required.facts)
    chosen = draw(st.lists(st.integers(0, len(required.facts) - 1), min_size=1, unique=True))
    found = tuple(draw(diagnoses(required, i)) for i in chosen)
    if required.preconditions:
        needed = draw(st.lists(st.integers(0, len(required.preconditions) - 1), unique=True))
        found += tuple(draw(diagnoses(required, i, precondition=True)) for i in needed)
    route = SCHEMA.routes[draw(st.sampled_from(sorted(SCHEMA.routes)))]
    decision = RouteDecision(
        route=route.iri,
        # A decision may keep a diagnosis that the attempt does not list.
        diagnosis=draw(st.sampled_from(found) | diagnoses(required, chosen[0])),
        level=route.level,
        decision=CORE + draw(st.sampled_from(("Dispatch", "Retry", "Reroute"))),
        rule=draw(st.sampled_from(RULES)),
        attempt_status=draw(st.sampled_from(("", *ATTEMPT_STATUSES))),
        previous=draw(st.none() | st.sampled_from(sorted(SCHEMA.routes))),
        requested=draw(st.sampled_from(("", *LEVELS))),
    )
    application = None
    if draw(st.booleans()):
        qpos = np.array(draw(st.lists(numbers, max_size=9)), dtype=np.float64)
        changed = tuple(sorted(draw(st.sets(st.integers(0, 99), max_size=7))))
        served = draw(st.sampled_from((route.iri, route.name, "no_declared_route")))
        proposal = Proposal(served, draw(names), draw(st.integers(0, 50)), qpos, changed, draw(texts))
        application = Application(
            proposal,
            draw(st.sampled_from(("none", "state", "controller"))),
            draw(numbers),
            draw(st.none() | st.integers(0, 999)),
            draw(st.sampled_from(("", *ENDS))),
            draw(texts),
        )
    return Attempt(
        index=index,
        observation=draw(observations(size)),
        diagnoses=found,
        selected=draw(st.sampled_from((decision, decision, None))),
        application=application,
        verification=draw(st.none() | verifications()),
        fault=draw(texts),
        plan=draw(st.none() | st.integers(0, 3)),
        prediction=draw(st.none() | st.builds(Prediction, observations(size), st.booleans(), st.integers(0, 9999))),
    )


@st.composite
def plans(draw, required, index):
    size = len(required.facts)
    chosen = draw(st.lists(st.integers(0, size - 1), unique=True))
    return ExecutedPlan(
        index=index,
        planner=draw(texts),
        evaluations=draw(st.integers(0, 9999)),
        steps=draw(st.integers(0, 99)),
        predicted=draw(st.none() | observations(size)),
        diagnoses=tuple(draw(diagnoses(required, i)) for i in chosen),
        simulated=draw(observations(size)),
        verification=draw(verifications()),
        mode=draw(st.sampled_from(("none", "controller"))),
    )


@st.composite
def required_aboxes(draw):
    scene = {}
    goal = draw(st.lists(facts(scene), min_size=1, max_size=3))
    premise = draw(st.lists(facts(scene), max_size=2))
    ways = st.lists(st.integers(0, len(goal) - 1), min_size=1, unique=True).map(lambda way: tuple(sorted(way)))
    alternatives = tuple(draw(st.lists(ways, max_size=3)))
    before = st.lists(st.integers(0, len(goal) - 1), min_size=1, unique=True).map(lambda way: tuple(sorted(way)))
    declared = st.sampled_from([rule.iri for rule in SCHEMA.preconditions])
    preconditions = tuple(draw(st.lists(st.builds(Precondition, facts(scene), before, declared), max_size=2)))
    abox = RequiredABox(draw(names), draw(texts), draw(names), tuple(goal), tuple(premise), draw(texts), alternatives)
    return replace(abox, preconditions=preconditions)


@st.composite
def episodes(draw):
    """A whole episode: consistent in its indices and types, arbitrary in everything else."""
    required = draw(required_aboxes())
    size = len(required.facts)
    return Episode(
        task=required.task,
        suite=draw(texts),
        state_index=draw(st.integers(-1, 49)),
        seed=draw(st.integers(0, 2**31)),
        required=required,
        initial=draw(observations(size)),
        premise=draw(observations(len(required.premise))),
        premise_holds=draw(st.booleans()),
        attempts=tuple(draw(attempts(required, index)) for index in range(draw(st.integers(0, 3)))),
        final=draw(observations(size)),
        outcome=draw(st.sampled_from(OUTCOMES)),
        verification=draw(st.none() | verifications()),
        provenance=tuple(draw(st.dictionaries(names, texts | st.integers() | st.booleans() | numbers)).items()),
        plans=tuple(draw(plans(required, index)) for index in range(draw(st.integers(0, 2)))),
        trial=draw(st.integers(0, 3)),
        tags=tuple(sorted(draw(st.dictionaries(names, texts, max_size=2)).items())),
        given=draw(st.sampled_from(("", "0123456789ab"))),
    )
