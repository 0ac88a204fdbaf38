"""An episode in sentences: the unmet fact, its diagnosis and route, and the result."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan

from grounding.observation import Observation
from onto_compiler.required import Fact
from onto_compiler.schema import Schema, local_name
from onto_compiler.tables import ABSENT, EXHAUSTED, EXPLICITLY_FALSE, MARGIN_VIOLATED, REPEAT, SATISFIED, STATUSES
from onto_compiler.wording import counted, plural
from runtime.loop.diagnosis import evidence_status
from runtime.loop.records import (
    Application,
    Attempt,
    Diagnosis,
    Episode,
    ExecutedPlan,
    RouteDecision,
    Verification,
    state_name,
)
from runtime.trace.reasons import Reasons
from runtime.wording import amount, atom, short_name, unit_of

__all__ = [
    "chain",
    "narrate",
    "outcome_sentence",
    "plan_sentences",
    "premise_sentence",
]

_SOURCES = {"sim": "the simulator", "pred": "the world model"}
_OUTCOMES = {
    "retained": "The prediction satisfies every required fact and was retained; nothing was executed.",
    "verified": "The native verifier accepted the state as it was.",
    "accepted": "The native verifier accepted the corrected state.",
    "unresolved": "The task stays unresolved: the attempts are spent, or no route had a further candidate.",
    "grounding_verifier_disagreement": "Every required fact is grounded as satisfied, and the native verifier says no.",
    "run_fault": "The run broke off; this says nothing about the task.",
}
_PLANNED = {
    "accepted": "The native verifier accepted the state that the last plan led to.",
    "unresolved": "The task stays unresolved: the plans are spent.",
}
_MODES = {
    "none": "was only retained as a plan",
    "state": "was written into the simulator's state",
    "controller": "was executed through the controller",
}
_ENDS = {
    "": "",
    "blocked": " and broken off, as something was in the way",
    "completed": " to its end",
    "gave_up": " and given up",
    "lost": " and broken off, as the fingers held nothing",
    "missed": " and broken off, as what was to be moved did not go where it should",
    "out_of_steps": " until the steps of the episode were spent",
    "unreachable": " and broken off, as the gripper did not come to where it was to act",
}


def outcome_sentence(episode: Episode) -> str:
    """What the outcome of ``episode`` means, and who judged."""
    sentence = (_PLANNED if episode.plans else {}).get(episode.outcome, _OUTCOMES[episode.outcome])
    if episode.judge == "grounding" and episode.accepted:
        sentence = sentence.replace("The native verifier", "Grounding") + " No native predicate was asked."
    return sentence


def narrate(episode: Episode, schema: Schema, reasons: Reasons | None = None) -> Iterator[str]:
    """The whole episode as lines of text; a line that is indented further belongs to the one before it.

    With ``reasons``, each decision is followed by its reasons.
    """
    yield f"{episode.task} ({', '.join(_names(episode))})"
    if episode.required.language:
        yield f"  Instruction: {episode.required.language}."
    if premise := premise_sentence(episode, schema):
        yield f"  {premise}"
    yield f"  The task requires {_listed([atom(fact, schema) for fact in episode.required.facts])}{_choice(episode)}."
    yield from _state("At the start", episode.required.facts, episode.initial, schema)
    for event in episode.turns:
        if isinstance(event, ExecutedPlan):
            yield f"Plan {event.index + 1}"
            yield from (f"  {sentence}" for sentence in plan_sentences(event, episode.required.facts, schema))
            continue
        yield f"Attempt {event.index + 1}" + ("" if event.plan is None else f", to better plan {event.plan + 1}")
        yield from (f"  {sentence}" for sentence in chain(event, schema, reasons))
    yield "Outcome"
    yield f"  {outcome_sentence(episode)}"
    if episode.verification is not None and not episode.attempts:
        yield f"  {_verified(episode.verification)}"
    yield from _state("At the end", episode.required.facts, episode.final, schema)


def _names(episode: Episode) -> Iterator[str]:
    """What distinguishes the episode from others of its task."""
    if episode.suite:
        yield episode.suite
    yield state_name(episode.state_index, "initial state") + (f" {episode.given}" if episode.given else "")
    yield f"seed {episode.seed}"
    if episode.trial:
        yield f"trial {episode.trial}"
    yield from (f"{key} {value}" for key, value in episode.tags)


def _choice(episode: Episode) -> str:
    number = len(episode.required.alternatives)
    return f", of which any of {number} alternatives will do" if number else ""


def chain(attempt: Attempt, schema: Schema, reasons: Reasons | None = None) -> Iterator[str]:
    """One attempt as sentences: fact, diagnosis, route, application, verification; reasons are indented."""
    for diagnosis in attempt.diagnoses:
        yield _found(diagnosis, schema)
        rule = schema.labels.get(diagnosis.rule, local_name(diagnosis.rule))
        failure = short_name(diagnosis.failure, schema)
        yield f'Diagnosis: {failure}, by the rule "{rule}", priority {diagnosis.priority}.'
        if reasons is not None:
            yield from (f"  {sentence}" for sentence in reasons.of_diagnosis(diagnosis))
    decision = attempt.selected
    if decision is not None:
        yield _routed(decision, schema, several=len(attempt.diagnoses) > 1)
        if reasons is not None:
            sentences = (*reasons.of_selection(attempt), *reasons.of_route(decision))
            yield from (f"  {sentence}" for sentence in sentences)
        for diagnosis in attempt.diagnoses:
            if diagnosis.precondition and diagnosis.key != decision.diagnosis.key:
                yield f"Before it, {atom(diagnosis.fact, schema)} should hold, and nothing has brought that about."
    yield from _came_of(attempt, schema)
    if attempt.verification is not None:
        yield _verified(attempt.verification)


def _came_of(attempt: Attempt, schema: Schema) -> Iterator[str]:
    """The result of the proposal, or why there was none."""
    if attempt.prediction is not None:
        yield from _imagined(attempt, schema)
    elif attempt.application is not None:
        yield _applied(attempt.application)
    elif attempt.selected is None:
        yield "Route: none was asked for; the state was only observed."
    elif not attempt.fault:
        yield f"Application: none, as `{short_name(attempt.selected.route, schema)}` had no candidate."
    if attempt.fault:
        yield f"Fault: {attempt.fault}."


def _imagined(attempt: Attempt, schema: Schema) -> Iterator[str]:
    """The result of a proposal that was only predicted."""
    prediction, application = attempt.prediction, attempt.application
    if prediction is None:
        return
    by = "" if application is None else f" of `{application.proposal.proposer}`"
    came = "takes the place of the best plan" if prediction.adopted else "is no better than the best plan"
    yield f"Proposal: a plan{by}, from {prediction.evaluations} candidates, {came}."
    chosen = None if attempt.selected is None else attempt.selected.diagnosis
    if chosen is None or chosen.precondition:
        return  # ABoxes hold the goal's facts
    fact, index = chosen.fact, chosen.index
    seen = prediction.observation
    margin, score = amount(float(seen.margin[index]), unit_of(fact, schema)), float(seen.score[index])
    word, sure = "holds" if seen.truth[index] else "does not hold", "" if isnan(score) else f", score {score:.2f}"
    yield f"Prediction: {atom(fact, schema)} {word} (margin {margin}{sure})."


def plan_sentences(plan: ExecutedPlan, facts: Sequence[Fact], schema: Schema) -> Iterator[str]:
    """How a plan was made and executed; each fact as predicted and as simulated; the verdict."""
    made = f"Plan: made by `{plan.planner}` from {plan.evaluations} candidate{'s' * (plan.evaluations != 1)}"
    executed = f", {_MODES[plan.mode]} in {plan.steps} control steps" if plan.mode == "controller" else ""
    yield f"{made}{executed}."
    for index, fact in enumerate(facts):
        yield f"Fact: {atom(fact, schema)}: {_came_true(plan, index, unit_of(fact, schema))}."
    if plan.predicted is not None:
        yield f"Diagnosis: the plan {_predicted_of(plan, schema)}."
    yield _verified(plan.verification)


def _predicted_of(plan: ExecutedPlan, schema: Schema) -> str:
    """What the predicted ABox of a plan lacks."""
    lacking = [each for each in plan.diagnoses if each.status != ABSENT]
    unseen = [atom(each.fact, schema) for each in plan.diagnoses if each.status == ABSENT]
    unknown = f"; of {_listed(unseen)} there is no evidence" if unseen else ""
    if lacking:
        facts = [f"{atom(each.fact, schema)} ({short_name(each.failure, schema)})" for each in lacking]
        return f"is predicted to lack {_listed(facts)}{unknown}"
    if unseen:
        return f"is predicted to meet the goal as far as it is observed{unknown}"
    return "is predicted to meet the goal and was retained"


def _came_true(plan: ExecutedPlan, index: int, unit: str) -> str:
    """A fact as predicted and as simulated, and whether the prediction was wrong."""
    came = "holds" if plan.simulated.truth[index] else "does not hold"
    simulated = f"{came} in the simulator ({amount(float(plan.simulated.margin[index]), unit)})"
    if plan.predicted is None:
        return simulated
    if not plan.predicted.observed[index]:
        return f"not predicted, without evidence of it; {simulated}"
    pair = bool(plan.predicted.truth[index]), bool(plan.simulated.truth[index])
    mistake = {(True, False): ", falsely satisfied", (False, True): ", falsely missing"}.get(pair, "")
    score = float(plan.predicted.score[index])
    sure = "" if isnan(score) else f", score {score:.2f}"
    margin = amount(float(plan.predicted.margin[index]), unit)
    return f"predicted {'' if pair[0] else 'not '}to hold ({margin}{sure}), {simulated}{mistake}"


def _applied(application: Application) -> str:
    proposal = application.proposal
    note = f" ({proposal.note})" if proposal.note else ""
    text = f"Application: candidate {proposal.candidate + 1} of `{proposal.proposer}`{note} {_MODES[application.mode]}"
    if application.mode != "controller":
        moved = f"{counted(len(proposal.changed), 'coordinate')} of qpos"
        return f"{text}; it changes {moved} by {application.displacement:.3g} in all."
    taken = "" if application.steps is None else f" in {application.steps} control steps"
    reason = f": {application.reason}" if application.reason else ""
    return f"{text}{taken}{_ENDS[application.end]}{reason}."


def _found(diagnosis: Diagnosis, schema: Schema) -> str:
    fact = atom(diagnosis.fact, schema)
    source = _SOURCES[diagnosis.source]
    margin = amount(diagnosis.margin, unit_of(diagnosis.fact, schema))
    limit = f", decided by {diagnosis.limit}" if diagnosis.limit else ""
    what = "Precondition" if diagnosis.precondition else "Fact"
    match diagnosis.status:
        case status if status == ABSENT:
            return f"{what}: {source} has no evidence of {fact}."
        case status if status == MARGIN_VIOLATED:
            return f"{what}: {source} finds {fact}, but by less than required (margin {margin}{limit})."
        case _:
            return f"{what}: {source} finds {fact} unmet (margin {margin}{limit})."


def _routed(decision: RouteDecision, schema: Schema, *, several: bool) -> str:
    route, rule = short_name(decision.route, schema), schema.labels.get(decision.rule, local_name(decision.rule))
    before = f"`{short_name(decision.previous, schema)}`" if decision.previous else "the previous route"
    reason = ""
    if decision.attempt_status == REPEAT:
        reason = f" after {before} was rejected"
    elif decision.attempt_status == EXHAUSTED:
        reason = f" as {before} has no further candidate"
    which = f" for {atom(decision.diagnosis.fact, schema)}" if several else ""
    verb = local_name(decision.decision).lower()
    return f'Route: {verb} to `{route}` ({decision.level} level){which}{reason}, by the rule "{rule}".'


def _verified(verification: Verification) -> str:
    verdict = "accepts" if verification.outcome else "rejects"
    judge = {"grounding": "grounding", "native": "the native verifier"}[verification.judge]
    text = f"Verification: {judge} {verdict} {verification.query}"
    if verification.settled is None:
        return f"{text}."
    settled = "still does" if verification.settled else "no longer does"
    return f"{text}, and {settled} after {verification.settle_steps} steps of settling."


def premise_sentence(episode: Episode, schema: Schema) -> str:
    """Whether the task's declared initial facts hold; an empty string where it declares none."""
    declared, seen = episode.required.premise, episode.premise
    if not declared:
        return ""
    statuses = [STATUSES[code] for code in evidence_status(declared, seen)]
    broken = [
        f"{atom(fact, schema)} ({amount(float(margin), unit_of(fact, schema))})"
        for fact, status, margin in zip(declared, statuses, seen.margin, strict=True)
        if status != SATISFIED
    ]
    if len(declared) == 1:
        return (
            f"Its declared initial fact does not hold: {broken[0]}." if broken else "Its declared initial fact holds."
        )
    if not broken:
        return f"Its {len(declared)} declared initial facts hold."
    verb = plural(len(broken), "does", "do")
    return f"Of its {len(declared)} declared initial facts, {len(broken)} {verb} not hold: {_listed(broken)}."


def _state(when: str, facts: Sequence[Fact], observation: Observation, schema: Schema) -> Iterator[str]:
    words = {
        SATISFIED: "holds",
        ABSENT: "is not observed",
        EXPLICITLY_FALSE: "is unmet",
        MARGIN_VIOLATED: "holds by too little",
    }
    for index, code in enumerate(evidence_status(facts, observation)):
        fact = facts[index]
        margin = float(observation.margin[index])
        measured = "" if isnan(margin) else f" (margin {amount(margin, unit_of(fact, schema))})"
        yield f"  {when}, {atom(fact, schema)} {words[STATUSES[code]]}{measured}."


def _listed(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"
