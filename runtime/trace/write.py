"""Records in, quads out: one named graph per ABox and per attempt (:mod:`runtime.trace.read` is the way back).

What is not defined (a NaN margin or score, an empty note) is left out, as RDF has no need of a word for nothing.
PROV relates the parts, so that `what led to this?` needs no other vocabulary.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isnan

from pyoxigraph import Quad

from grounding.observation import Observation
from onto_compiler.rdf import CORE, PROV, TRACE, node
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.required_rdf import (
    fact_statements,
    refuse_two_types,
    required_statements,
    stated_facts,
    thresholds_of,
)
from onto_compiler.schema import Schema
from onto_compiler.statements import Statement, describe, link, quads_of
from onto_compiler.tables import STATUSES
from runtime.loop.diagnosis import evidence_status
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
from runtime.trace.names import ENDS, LEVELS, MODES, OUTCOMES, SOURCES, episode_iri, run_iri

__all__ = ["episode_quads"]

_DERIVED, _GENERATED, _USED, _INFORMED = (
    PROV + name for name in ("wasDerivedFrom", "wasGeneratedBy", "used", "wasInformedBy")
)


def episode_quads(episode: Episode, schema: Schema, run: str) -> Iterator[Quad]:
    """Every statement about ``episode`` as a part of ``run``, graph by graph.

    Raises:
        ValueError: where one name stands for entities of two types, or an atom does not read back as it was written.
    """
    top = episode_iri(run, episode.suite, episode.task, episode.state_index)
    thresholds = thresholds_of(schema)
    # A proposer gives its route by name or by IRI.
    routes = {key: route.iri for route in schema.routes.values() for key in (route.name, route.iri)}
    refuse_two_types(stated_facts(episode.required), thresholds)
    required, premise = f"{top}/required", f"{top}/premise"
    facts, declared = episode.required.facts, episode.required.premise
    graphs: list[tuple[str, Iterable[Statement]]] = [
        (top, _episode(top, episode, run)),
        (required, required_statements(required, top, episode.required, thresholds)),
        (premise, fact_statements(premise, top, declared, thresholds)),
        (premise, _observation(premise, premise, declared, episode.premise)),
        (premise, _origin(premise, top, required)),
        (f"{top}/initial", _observation(f"{top}/initial", required, facts, episode.initial)),
        (f"{top}/initial", _origin(f"{top}/initial", top, required)),
    ]
    earlier, maker = f"{top}/initial", top
    known = _Required(episode.required, thresholds)
    for event in episode.turns:
        if isinstance(event, ExecutedPlan):
            iri = f"{top}/plan/{event.index}"
            graphs += _plan_graphs(iri, top, event, maker, earlier, known)
            earlier, maker = f"{iri}/simulated", iri
            continue
        observed, iri = f"{top}/observed/{event.index}", f"{top}/attempt/{event.index}"
        graphs += [
            (observed, _observation(observed, required, facts, event.observation)),
            (observed, _origin(observed, maker, required, earlier)),
            (iri, _attempt(iri, top, event, maker, routes, known)),
        ]
        earlier, maker = observed, iri
        if event.prediction is not None:
            predicted = f"{iri}/predicted"
            graphs += [
                (predicted, _observation(predicted, required, facts, event.prediction.observation)),
                (predicted, _origin(predicted, iri, required, observed)),
            ]
            earlier = predicted if event.prediction.adopted else observed
    final = f"{top}/final"
    graphs += [
        (final, _observation(final, required, facts, episode.final)),
        (final, _origin(final, maker, required, earlier)),
    ]
    yield from quads_of(graphs)


def _number(value: float) -> float | None:
    return None if isnan(value) else float(value)


def _episode(top: str, episode: Episode, run: str) -> Iterator[Statement]:
    yield from describe(run_iri(run), [TRACE + "Run"])
    yield from describe(
        top,
        [TRACE + "Episode"],
        trace_inRun=node(run_iri(run)),
        trace_task=episode.task,
        trace_suite=episode.suite,
        trace_stateIndex=episode.state_index,
        trace_seed=episode.seed,
        trace_requires=node(f"{top}/required"),
        trace_initial=node(f"{top}/initial"),
        trace_premise=node(f"{top}/premise"),
        trace_premiseHolds=episode.premise_holds,
        trace_final=node(f"{top}/final"),
        trace_outcome=node(OUTCOMES[episode.outcome]),
        trace_provenance=json.dumps(dict(episode.provenance), ensure_ascii=False),
    )
    yield from link(top, _INFORMED, run_iri(run))
    yield from link(top, _USED, f"{top}/required")
    if episode.verification is not None:
        verification = f"{top}/verification"
        yield from link(top, TRACE + "verification", verification)
        yield from _verification(verification, episode.verification)
        yield from link(verification, _GENERATED, top)
        yield from link(verification, _DERIVED, f"{top}/final", f"{top}/required")


def _origin(iri: str, maker: str, *sources: str) -> Iterator[Statement]:
    yield from link(iri, _DERIVED, *sources)
    yield from link(iri, _GENERATED, maker)


def _observation(iri: str, required: str, facts: Sequence[Fact], observation: Observation) -> Iterator[Statement]:
    yield from describe(
        iri,
        [TRACE + "ObservedABox"],
        core_source=node(SOURCES[observation.source]),
        trace_step=int(observation.step),
    )
    for index, code in enumerate(evidence_status(facts, observation)):
        member = f"{iri}/observation/{index}"
        truth = bool(observation.truth[index])
        yield from link(iri, TRACE + "memberFact", member)
        yield from describe(
            member,
            [CORE + "ObservedFact"],
            core_fact=node(f"{required}/fact/{index}"),
            core_source=node(SOURCES[observation.source]),
            core_status=node(STATUSES[code]),
            # A source without evidence states no truth value.
            core_truth=truth if observation.observed[index] or truth else None,
            core_margin=_number(observation.margin[index]),
            core_score=_number(observation.score[index]),
            core_limit=observation.limit[index] or None,
            trace_index=index,
        )
        yield from link(member, _DERIVED, f"{required}/fact/{index}")


def _attempt(
    iri: str, top: str, attempt: Attempt, earlier: str, routes: Mapping[str, str], required: _Required
) -> Iterator[Statement]:
    observed = f"{top}/observed/{attempt.index}"
    failed = attempt.application is not None and attempt.verification is not None and not attempt.verification.outcome
    diagnoses = [f"{iri}/diagnosis/{i}" for i in range(len(attempt.diagnoses))]
    yield from describe(
        iri,
        [TRACE + "Attempt"],
        trace_inEpisode=node(top),
        trace_index=attempt.index,
        trace_observed=node(observed),
        trace_selected=node(f"{iri}/decision"),
        trace_applied=node(f"{iri}/application") if attempt.application else None,
        trace_verification=node(f"{iri}/verification") if attempt.verification else None,
        trace_fault=attempt.fault or None,
        trace_forPlan=None if attempt.plan is None else node(f"{top}/plan/{attempt.plan}"),
    )
    if attempt.prediction is not None:
        yield from _prediction(iri, attempt.prediction)
    yield from link(iri, TRACE + "failure", *[CORE + "ExecutionFailure"] * failed)
    yield from link(iri, TRACE + "failure", *[CORE + "RunFault"] * bool(attempt.fault))
    yield from link(iri, TRACE + "diagnosis", *diagnoses)
    yield from link(iri, _USED, observed)
    yield from link(iri, _INFORMED, earlier)
    chosen = f"{iri}/diagnosis/selected"
    for index, (name, diagnosis) in enumerate(zip(diagnoses, attempt.diagnoses, strict=True)):
        if _same(diagnosis, attempt.selected.diagnosis):
            chosen = name
        yield from _diagnosis(name, top, observed, index, diagnosis, required)
        yield from link(name, _GENERATED, iri)
    if chosen not in diagnoses:
        yield from _diagnosis(chosen, top, observed, len(diagnoses), attempt.selected.diagnosis, required)
        yield from link(chosen, _GENERATED, iri)
    yield from _decision(f"{iri}/decision", chosen, attempt.selected)
    yield from link(f"{iri}/decision", _GENERATED, iri)
    if attempt.application is not None:
        yield from _application(iri, attempt.application, routes)
    if attempt.verification is not None:
        verification = f"{iri}/verification"
        yield from _verification(verification, attempt.verification)
        yield from link(verification, _GENERATED, f"{iri}/application" if attempt.application else iri)
        yield from link(verification, _DERIVED, f"{iri}/proposal" if attempt.application else f"{iri}/decision")


def _prediction(iri: str, prediction: Prediction) -> Iterator[Statement]:
    yield from describe(
        iri,
        [],
        trace_predicted=node(f"{iri}/predicted"),
        trace_adopted=prediction.adopted,
        trace_evaluations=int(prediction.evaluations),
    )


def _plan_graphs(
    iri: str, top: str, plan: ExecutedPlan, maker: str, earlier: str, required: _Required
) -> Iterator[tuple[str, Iterable[Statement]]]:
    """A plan's own graph, and those of the ABoxes that were predicted and simulated of its end."""
    abox, facts = f"{top}/required", required.abox.facts
    simulated, predicted = f"{iri}/simulated", f"{iri}/predicted"
    yield iri, _plan(iri, top, plan, maker, required)
    if plan.predicted is not None:
        yield predicted, _observation(predicted, abox, facts, plan.predicted)
        yield predicted, _origin(predicted, maker, abox, earlier)
    yield simulated, _observation(simulated, abox, facts, plan.simulated)
    yield simulated, _origin(simulated, iri, abox, earlier)


def _plan(iri: str, top: str, plan: ExecutedPlan, maker: str, required: _Required) -> Iterator[Statement]:
    predicted, verification = f"{iri}/predicted", f"{iri}/verification"
    yield from describe(
        iri,
        [TRACE + "ExecutedPlan"],
        trace_inEpisode=node(top),
        trace_index=plan.index,
        trace_proposer=plan.planner,
        trace_evaluations=int(plan.evaluations),
        trace_controlSteps=int(plan.steps),
        trace_mode=node(MODES[plan.mode]),
        trace_predicted=node(predicted) if plan.predicted is not None else None,
        trace_simulated=node(f"{iri}/simulated"),
        trace_verification=node(verification),
    )
    yield from link(iri, _INFORMED, maker)
    diagnoses = [f"{iri}/diagnosis/{i}" for i in range(len(plan.diagnoses))]
    yield from link(iri, TRACE + "diagnosis", *diagnoses)
    for index, (name, diagnosis) in enumerate(zip(diagnoses, plan.diagnoses, strict=True)):
        yield from _diagnosis(name, top, predicted, index, diagnosis, required)
        yield from link(name, _GENERATED, iri)
    yield from _verification(verification, plan.verification)
    yield from link(verification, _GENERATED, iri)
    yield from link(verification, _DERIVED, f"{iri}/simulated")


@dataclass(frozen=True, slots=True)
class _Required:
    """What an episode requires, and the IRIs of thresholds, which are no entities of a scene."""

    abox: RequiredABox
    thresholds: frozenset[str]

    def holds(self, diagnosis: Diagnosis) -> bool:
        """Whether the diagnosis keeps, whole, the fact that its index names."""
        index, fact = diagnosis.index, diagnosis.fact
        facts = self.abox.facts
        if diagnosis.precondition:
            facts = tuple(each.fact for each in self.abox.preconditions)
        return 0 <= index < len(facts) and (facts[index] is fact or facts[index] == fact)


def _same(left: Diagnosis, right: Diagnosis) -> bool:
    """Equality under which two undefined margins are equal."""
    return left is right or repr(left) == repr(right)


def _diagnosis(
    iri: str, top: str, observed: str, index: int, diagnosis: Diagnosis, required: _Required
) -> Iterator[Statement]:
    member = f"{top}/required/precondition" if diagnosis.precondition else f"{top}/required"
    fact = f"{member}/fact/{diagnosis.index}"
    if not required.holds(diagnosis):
        # A diagnosis of another fact says so, and the shapes refuse it (ABX002).
        fact = f"{iri}/fact/0"
        yield from fact_statements(iri, top, (diagnosis.fact,), required.thresholds)
    yield from describe(
        iri,
        [TRACE + "Diagnosis", diagnosis.failure],
        core_fact=node(fact),
        core_failureClass=node(diagnosis.failure),
        core_status=node(diagnosis.status),
        core_truth=diagnosis.truth,
        core_margin=_number(diagnosis.margin),
        core_limit=diagnosis.limit or None,
        core_source=node(SOURCES[diagnosis.source]),
        core_diagnosedBy=node(diagnosis.rule),
        core_priority=diagnosis.priority,
        trace_index=index,
    )
    # Observed ABoxes hold the goal's facts; of a precondition, the diagnosis alone says how it was observed.
    seen = "" if diagnosis.precondition else f"/observation/{diagnosis.index}"
    yield from link(iri, _DERIVED, f"{observed}{seen}")


def _decision(iri: str, diagnosis: str, decision: RouteDecision) -> Iterator[Statement]:
    # Status, previous route and requested level are said of the diagnosis, where the routing rules look for them.
    yield from describe(
        diagnosis,
        [],
        core_attemptStatus=node(decision.attempt_status) if decision.attempt_status else None,
        core_previousRoute=node(decision.previous) if decision.previous is not None else None,
        core_requestedLevel=node(LEVELS[decision.requested]) if decision.requested else None,
    )
    yield from describe(
        iri,
        [TRACE + "RouteDecision"],
        core_route=node(decision.route),
        core_decision=node(decision.decision),
        core_routedBy=node(decision.rule),
        trace_atLevel=node(LEVELS[decision.level]),
        trace_of=node(diagnosis),
    )
    yield from link(iri, _DERIVED, diagnosis)


def _application(attempt: str, application: Application, routes: Mapping[str, str]) -> Iterator[Statement]:
    iri, proposal = f"{attempt}/application", f"{attempt}/proposal"
    yield from describe(
        iri,
        [TRACE + "Application"],
        trace_proposal=node(proposal),
        trace_mode=node(MODES[application.mode]),
        trace_displacement=float(application.displacement),
        trace_controlSteps=application.steps,
        trace_end=node(ENDS[application.end]) if application.end else None,
        trace_reason=application.reason or None,
    )
    yield from link(iri, _USED, proposal)
    yield from link(iri, _INFORMED, attempt)
    yield from _proposal(proposal, application.proposal, routes)
    yield from link(proposal, _DERIVED, f"{attempt}/decision")
    yield from link(proposal, _GENERATED, attempt)


def _proposal(iri: str, proposal: Proposal, routes: Mapping[str, str]) -> Iterator[Statement]:
    route = routes.get(proposal.route)
    yield from describe(
        iri,
        [TRACE + "Proposal"],
        core_route=node(route) if route else None,
        trace_routeName=proposal.route,
        trace_proposer=proposal.proposer,
        trace_candidate=int(proposal.candidate),
        trace_qpos=json.dumps(proposal.qpos.tolist()),
        trace_changed=json.dumps([int(address) for address in proposal.changed]),
        trace_note=proposal.note or None,
    )


def _verification(iri: str, verification: Verification) -> Iterator[Statement]:
    yield from describe(
        iri,
        [TRACE + "Verification"],
        trace_query=verification.query,
        trace_outcomeTruth=verification.outcome,
        trace_settled=verification.settled,
        trace_settleSteps=int(verification.settle_steps),
    )
