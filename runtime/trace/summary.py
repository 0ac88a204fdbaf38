"""One episode as the few facts that people ask for first: as JSON and as a row of a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from onto_compiler.schema import Schema
from onto_compiler.wording import counted
from runtime.loop.records import Attempt, Diagnosis, Episode, ExecutedPlan, Verification, state_name
from runtime.wording import amount, atom, short_name, unit_of

__all__ = ["demo_table", "episode_summary", "first_diagnoses", "margin_after", "routes_of", "verdict"]

_NARROW = 36  # what a table of 80 columns leaves for a fact
_VERDICTS = {"grounding_verifier_disagreement": "disagreement", "run_fault": "run fault"}
_STYLES = {"accepted": "green", "verified": "green", "retained": "cyan", "unresolved": "yellow"}


def episode_summary(episode: Episode, schema: Schema) -> dict[str, Any]:
    """The record as plain JSON values: names are notations, an undefined margin is None, lengths are in metres."""
    return {
        "suite": episode.suite,
        "task": episode.task,
        "state": episode.state_index,
        "seed": episode.seed,
        "language": episode.required.language,
        "required": [atom(fact, schema) for fact in episode.required.facts],
        "premise_holds": episode.premise_holds,
        "diagnoses": [_diagnosis(diagnosis, episode, schema) for diagnosis in first_diagnoses(episode)],
        "attempts": len(episode.attempts),
        "history": [_attempt(attempt, schema) for attempt in episode.attempts],
        **({"plans": [_plan(plan, episode, schema) for plan in episode.plans]} if episode.plans else {}),
        "outcome": episode.outcome,
        "accepted": episode.accepted,
        "judge": episode.judge,
        "settled": None if episode.verification is None else episode.verification.settled,
        "verification": _verification(episode.verification),
        "provenance": dict(episode.provenance),
    }


def first_diagnoses(episode: Episode) -> tuple[Diagnosis, ...]:
    """For each required fact that was ever diagnosed its first diagnosis, in the order of the required ABox.

    Preconditions are left out: no observed ABox says what became of them.
    """
    found: dict[int, Diagnosis] = {}
    for attempt in episode.attempts:
        for diagnosis in attempt.diagnoses:
            if not diagnosis.precondition:
                found.setdefault(diagnosis.index, diagnosis)
    return tuple(found[index] for index in sorted(found))


def routes_of(episode: Episode, index: int) -> tuple[str, ...]:
    """The IRIs of the routes to which required fact ``index`` was sent, one for each attempt that selected it."""
    selected = [attempt.selected for attempt in episode.attempts]
    return tuple(s.route for s in selected if s.diagnosis.index == index and not s.diagnosis.precondition)


def margin_after(episode: Episode, index: int) -> float:
    """The margin of required fact ``index`` in the last observation; NaN where none is defined."""
    return float(episode.final.margin[index])


def verdict(episode: Episode) -> str:
    """The outcome in a few words; that no native predicate was asked is one of them."""
    text = _VERDICTS.get(episode.outcome, episode.outcome)
    return f"{text} by grounding" if episode.accepted and episode.judge == "grounding" else text


def _diagnosis(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> dict[str, Any]:
    routes = [short_name(route, schema) for route in routes_of(episode, diagnosis.index)]
    return {
        "predicate": short_name(diagnosis.fact.predicate, schema),
        "arguments": [argument.name for argument in diagnosis.fact.arguments],
        "polarity": diagnosis.fact.polarity,
        "truth": diagnosis.truth,
        "margin": _number(diagnosis.margin),
        "margin_after": _number(margin_after(episode, diagnosis.index)),
        "unit": unit_of(diagnosis.fact, schema),
        "failure": short_name(diagnosis.failure, schema),
        "route": routes[0] if routes else None,
        "routes": routes,
        "source": diagnosis.source,
    }


def _attempt(attempt: Attempt, schema: Schema) -> dict[str, Any]:
    application = attempt.application
    return {
        "fact": atom(attempt.selected.diagnosis.fact, schema),
        "failure": short_name(attempt.selected.diagnosis.failure, schema),
        "route": short_name(attempt.selected.route, schema),
        "decision": short_name(attempt.selected.decision, schema).lower(),
        "proposer": application.proposal.proposer if application else None,
        "candidate": application.proposal.candidate if application else None,
        "mode": application.mode if application else None,
        "steps": application.steps if application else None,
        "end": (application.end or None) if application else None,
        "reason": (application.reason or None) if application else None,
        "note": (application.proposal.note or None) if application else None,
        "verification": _verification(attempt.verification),
        "fault": attempt.fault or None,
        **_imagined(attempt),
    }


def _imagined(attempt: Attempt) -> dict[str, Any]:
    """What was predicted of a proposal that was only imagined."""
    prediction, diagnosis = attempt.prediction, attempt.selected.diagnosis
    if prediction is None:
        return {}
    # ABoxes hold the goal's facts: of a precondition nothing is predicted.
    margin = None if diagnosis.precondition else _number(float(prediction.observation.margin[diagnosis.index]))
    return {
        "plan": attempt.plan,
        "evaluations": prediction.evaluations,
        "adopted": prediction.adopted,
        "predicted_margin": margin,
    }


def _plan(plan: ExecutedPlan, episode: Episode, schema: Schema) -> dict[str, Any]:
    return {
        "planner": plan.planner,
        "evaluations": plan.evaluations,
        "mode": plan.mode,
        "steps": plan.steps,
        "retained": None if plan.predicted is None else not plan.diagnoses,
        "failures": [short_name(diagnosis.failure, schema) for diagnosis in plan.diagnoses],
        "facts": [
            {
                "predicate": short_name(fact.predicate, schema),
                "arguments": [argument.name for argument in fact.arguments],
                "polarity": fact.polarity,
                "truth": bool(plan.simulated.truth[i]),
                "margin": _number(float(plan.simulated.margin[i])),
                "unit": unit_of(fact, schema),
                "predicted": bool(plan.predicted.truth[i]) if plan.predicted and plan.predicted.observed[i] else None,
                "predicted_margin": None if plan.predicted is None else _number(float(plan.predicted.margin[i])),
                "score": None if plan.predicted is None else _number(float(plan.predicted.score[i])),
            }
            for i, fact in enumerate(episode.required.facts)
        ],
        "verification": _verification(plan.verification),
    }


def _verification(verification: Verification | None) -> dict[str, Any] | None:
    if verification is None:
        return None
    return {"query": verification.query, "outcome": verification.outcome, "settled": verification.settled}


def _number(value: float) -> float | None:
    return None if value != value else value  # noqa: PLR0124 - NaN differs from itself


def demo_table(episodes: Sequence[Episode], schema: Schema) -> Table:
    """A table that fits 80 columns: for each episode its unmet facts, what they were diagnosed as, and the verdict."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("task, unmet fact, margin before and after", ratio=1, overflow="fold")
    table.add_column("failure > route", overflow="fold")
    table.add_column("verdict", overflow="fold")
    for episode in episodes:
        name = Text(f"{episode.task.replace('_', ' ')}, {state_name(episode.state_index)}", style="bold")
        found = first_diagnoses(episode)
        facts = Text("\n").join([name, *(_before_after(d, episode, schema) for d in found)])
        ways = [line for diagnosis in found for line in _way(diagnosis, episode, schema)]
        table.add_row(facts, Text("\n".join(ways)), _cell(episode))
    return table


def _before_after(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> Text:
    unit = unit_of(diagnosis.fact, schema)
    before, after = (amount(m, unit) for m in (diagnosis.margin, margin_after(episode, diagnosis.index)))
    margins = before if before == after else f"{before} -> {after}"
    fact = atom(diagnosis.fact, schema)
    if max(map(len, fact.split())) > _NARROW:
        fact = fact.replace("(", "(\n  ", 1)
    return Text(f"{fact}\n  {margins}")


def _way(diagnosis: Diagnosis, episode: Episode, schema: Schema) -> Iterator[str]:
    yield short_name(diagnosis.failure, schema)
    for route in dict.fromkeys(short_name(route, schema) for route in routes_of(episode, diagnosis.index)):
        yield f"> {route}"


def _cell(episode: Episode) -> Text:
    text = Text(verdict(episode), style=_STYLES.get(episode.outcome, "red"))
    settled = None if episode.verification is None else episode.verification.settled
    if settled is not None:
        text.append("\nsettled" if settled else "\nlost settling", style="green" if settled else "red")
    tries = len(episode.attempts)
    text.append(f"\n{counted(tries, 'attempt')}", style="default")
    return text
