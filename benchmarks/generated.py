"""Episodes that nothing simulated: drawn facts and evidence, diagnosed and routed by the shipped rules.

They have the form and the size of recorded episodes, and conform to the shapes. Their numbers mean nothing.
"""

from __future__ import annotations

import numpy as np

from grounding.observation import Observation
from onto_compiler.knowledge import Knowledge
from onto_compiler.rdf import CORE
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox
from onto_compiler.schema import PredicateSignature, local_name
from onto_compiler.tables import REPEAT
from runtime.loop.diagnosis import diagnose, select
from runtime.loop.records import Application, Attempt, Episode, Proposal, RouteDecision, Verification
from runtime.loop.routing import route

__all__ = ["generated_episode"]

_NAN = float("nan")


def generated_episode(rng: np.random.Generator, knowledge: Knowledge, index: int) -> Episode:
    """One episode with up to three required facts, two declared ones and three attempts; ``index`` names it."""
    facts = tuple(_fact(rng, knowledge, number) for number in range(1 + rng.integers(3)))
    premise = tuple(_fact(rng, knowledge, 10 + number) for number in range(rng.integers(3)))
    query = f"And({', '.join(str(fact.native) for fact in facts)})"
    initial = observation = _observation(rng, len(facts))
    attempts: list[Attempt] = []
    while len(attempts) < 3 and (found := diagnose(facts, observation, knowledge.tables)):
        chosen = select(found)
        rejected = attempts[-1].selected if attempts else None
        if rejected is None or rejected.diagnosis.index != chosen.index:
            decision = route(chosen, knowledge)
        else:
            decision = route(chosen, knowledge, REPEAT, rejected.route)
        verdict = Verification(query, outcome=False)
        applied = _application(rng, knowledge, decision, len(attempts))
        attempts.append(Attempt(len(attempts), observation, found, decision, applied, verdict))
        observation = _observation(rng, len(facts))
    return Episode(
        task=f"generated_task_{index}",
        suite="generated",
        state_index=int(rng.integers(50)),
        seed=int(rng.integers(1000)),
        required=RequiredABox(f"generated_task_{index}", "do it", "Generated", facts, premise, "generated.bddl"),
        initial=initial,
        premise=_observation(rng, len(premise)),
        premise_holds=bool(rng.integers(2)),
        attempts=tuple(attempts),
        final=observation,
        outcome="unresolved",
        verification=Verification(query, outcome=False),
        provenance=(("seconds", float(rng.random())),),
    )


def _fact(rng: np.random.Generator, knowledge: Knowledge, number: int) -> Fact:
    # An episode acts on the state: what only a plan corrects has no route in one.
    predicates = sorted({predicate for predicate, *_, level in knowledge.tables.routing if level == "state"})
    signature = knowledge.schema.predicates[predicates[rng.integers(len(predicates))]]
    arguments = tuple(
        _argument(rng, knowledge, parameter, 2 * number + place) for place, parameter in enumerate(signature.parameters)
    )
    return Fact(
        predicate=signature.iri,
        arguments=arguments,
        native=NativeAtom("On", tuple(argument.name for argument in arguments)),
        grounded_by=_grounding(signature),
        polarity=bool(rng.random() < 0.8),
        threshold=float(rng.choice([0.0, 0.01])),
    )


def _grounding(signature: PredicateSignature) -> str:
    return signature.grounded_by or "on_object"


def _argument(rng: np.random.Generator, knowledge: Knowledge, parameter: str, number: int) -> Entity:
    schema = knowledge.schema
    if schema.is_a(parameter, CORE + "Threshold"):
        thresholds = sorted(threshold.iri for threshold in schema.thresholds.values())
        iri = thresholds[rng.integers(len(thresholds))]
        return Entity(local_name(iri), iri)
    classes = sorted(cls for cls in schema.classes if schema.is_a(cls, parameter))
    cls = classes[rng.integers(len(classes))]
    return Entity(f"{local_name(cls).lower()}_{number}", cls)


def _observation(rng: np.random.Generator, size: int) -> Observation:
    """Of a simulator or, one time in four, of a world model, which then gives a score to what it has evidence of."""
    predicted = bool(rng.random() < 0.25)
    observed = rng.random(size) < 0.9
    margin = np.where(observed & (rng.random(size) < 0.8), rng.normal(0, 0.1, size), _NAN)
    return Observation(
        source="pred" if predicted else "sim",
        step=int(rng.integers(300)),
        observed=observed,
        truth=observed & (rng.random(size) < 0.4),
        margin=margin,
        score=np.where(observed, rng.random(size), _NAN) if predicted else np.full(size, _NAN),
        limit=tuple("contact" if each else "" for each in observed),
    )


def _application(
    rng: np.random.Generator, knowledge: Knowledge, decision: RouteDecision, candidate: int
) -> Application:
    name = knowledge.schema.routes[decision.route].name
    proposal = Proposal(name, "generated", candidate, rng.normal(size=7), (0, 1, 2))
    return Application(proposal, "state", float(rng.random()))
