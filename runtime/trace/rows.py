"""The JSON that the commands print for episodes and states: columns of the table of records, and derived ones."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, is_dataclass, replace
from typing import Any

from onto_compiler.rdf import CORE, PROV, TRACE
from onto_compiler.record.described import Described
from onto_compiler.record.rows import GRAPH, OMITTED, Column, Row, printed
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.loop.records import Attempt, Diagnosis, Episode, ExecutedPlan
from runtime.trace.fact_rows import OBSERVED, UNMET, diagnosis_of, fact_columns, fact_of, unit_column
from runtime.trace.table import (
    APPLICATION,
    ATTEMPT,
    DIAGNOSIS,
    EPISODE,
    EXECUTED_PLAN,
    PREDICTION,
    PROPOSAL,
    RECORDS,
    ROUTE_DECISION,
    VERIFICATION,
)
from runtime.wording import atom, short_name

__all__ = [
    "ATTEMPT_ROW",
    "DEMONSTRATION",
    "DIAGNOSES",
    "EPISODE_ROW",
    "GROUNDING",
    "RECORDED",
    "first_diagnoses",
    "margin_after",
    "routes_of",
]


# Episodes


@dataclass(frozen=True, slots=True)
class _InEpisode:
    """A diagnosis within its episode."""

    diagnosis: Diagnosis
    episode: Episode

    def routes(self, schema: Schema) -> list[str]:
        return [short_name(route, schema) for route in routes_of(self.episode, self.diagnosis.index)]


def first_diagnoses(episode: Episode) -> tuple[Diagnosis, ...]:
    """For each required fact that was ever diagnosed its first diagnosis, in the order of the required ABox.

    Preconditions are left out, since no later observed ABox contains them.
    """
    found: dict[int, Diagnosis] = {}
    for attempt in episode.attempts:
        for diagnosis in attempt.diagnoses:
            if not diagnosis.precondition:
                found.setdefault(diagnosis.index, diagnosis)
    return tuple(found[index] for index in sorted(found))


def routes_of(episode: Episode, index: int) -> tuple[str, ...]:
    """The IRIs of the routes to which required fact ``index`` was sent, one for each attempt that selected it."""
    selected = [attempt.selected for attempt in episode.attempts if attempt.selected is not None]
    return tuple(s.route for s in selected if s.diagnosis.index == index and not s.diagnosis.precondition)


def margin_after(episode: Episode, index: int) -> float:
    """The margin of required fact ``index`` in the last observation; NaN if none is defined."""
    return float(episode.final.margin[index])


def _number(value: float) -> float | None:
    return None if value != value else float(value)  # noqa: PLR0124 - NaN differs from itself


def _all_or(column: Callable[[Any, Schema], Any]) -> Callable[[Any, Schema], Any]:
    return lambda subject, schema: None if subject is None else column(subject, schema)


FIRST_DIAGNOSIS = Row(
    "The first diagnosis of one fact in an episode, with the routes that the fact was sent to.",
    {
        **fact_columns(fact_of),
        **printed(DIAGNOSIS, "truth", "margin", via=diagnosis_of),
        "margin_after": Column(
            "number", lambda part, _: _number(margin_after(part.episode, part.diagnosis.index)), null=True
        ),
        **unit_column(fact_of),
        **printed(DIAGNOSIS, "failure", via=diagnosis_of),
        "route": Column(
            "word:route", lambda part, schema: next(iter(part.routes(schema)), None), CORE + "route", null=True
        ),
        "routes": Column("words:route", lambda part, schema: part.routes(schema)),
        **printed(DIAGNOSIS, "source", via=diagnosis_of),
    },
    ("arity",),
)
VERIFIED = Row(
    "The native predicate's answer, and whether it held after settling (null: nobody asked).", printed(VERIFICATION)
)


def _verification(term: str = TRACE + "verification", *, null: bool = True) -> dict[str, Column]:
    value = _all_or(VERIFIED.of)
    return {
        "verification": Column("record:Verification", lambda held, names: value(held.verification, names), term, null)
    }


def _selected(attempt: Attempt) -> Any:  # noqa: ANN401 - a decision or None
    return attempt.selected


def _chosen(attempt: Attempt) -> Diagnosis | None:
    return None if attempt.selected is None else attempt.selected.diagnosis


def _if_imagined(value: Callable[[Attempt, Schema], Any]) -> Callable[[Attempt, Schema], Any]:
    """Of an attempt whose proposal was only imagined."""
    return lambda attempt, schema: OMITTED if attempt.prediction is None else value(attempt, schema)


def _predicted_margin(attempt: Attempt) -> float | None:
    # ABoxes hold the goal's facts: of a precondition nothing is predicted.
    chosen = _chosen(attempt)
    if chosen is None or chosen.precondition or attempt.prediction is None:
        return None
    return _number(float(attempt.prediction.observation.margin[chosen.index]))


ATTEMPT_ROW = Row(
    "One turn of the correction loop: the selected fact and its route, what was applied and how, and what came of it.",
    {
        "fact": Column(
            "string",
            lambda a, schema: None if a.selected is None else atom(a.selected.diagnosis.fact, schema),
            null=True,
        ),
        **printed(DIAGNOSIS, "failure", via=_chosen, null=True),
        **printed(ROUTE_DECISION, via=_selected, null=True),
        **printed(PROPOSAL, via=lambda attempt: attempt.application and attempt.application.proposal, null=True),
        **printed(APPLICATION, via=lambda attempt: attempt.application, null=True),
        **_verification(),
        **printed(ATTEMPT),
        # `plan` is a place in the episode's plans.
        "plan": Column("integer", _if_imagined(lambda attempt, _: attempt.plan), optional=True, null=True),
        **{
            name: replace(column, value=_if_imagined(column.value), optional=True)
            for name, column in printed(PREDICTION, via=lambda attempt: attempt.prediction).items()
        },
        "predicted_margin": Column(
            "number", _if_imagined(lambda attempt, _: _predicted_margin(attempt)), null=True, optional=True
        ),
    },
    ("route",),
)


@dataclass(frozen=True, slots=True)
class _Planned:
    """A fact at the end of an executed plan."""

    fact: Fact
    plan: ExecutedPlan
    index: int


def _truth_predicted(planned: _Planned) -> bool | None:
    seen, index = planned.plan.predicted, planned.index
    return bool(seen.truth[index]) if seen is not None and seen.observed[index] else None


def _of_predicted(array: str) -> Callable[[_Planned, Schema], float | None]:
    def value(planned: _Planned, schema: Schema) -> float | None:
        del schema
        seen = planned.plan.predicted
        return None if seen is None else _number(float(getattr(seen, array)[planned.index]))

    return value


PLANNED_FACT = Row(
    "A required fact at the end of an executed plan: as the simulator shows it, and as it was predicted.",
    {
        **fact_columns(lambda planned: planned.fact),
        "truth": Column("boolean", lambda p, _: bool(p.plan.simulated.truth[p.index]), CORE + "truth"),
        "margin": Column("number", lambda p, _: _number(p.plan.simulated.margin[p.index]), CORE + "margin", null=True),
        **unit_column(lambda planned: planned.fact),
        "predicted": Column("boolean", lambda planned, _: _truth_predicted(planned), null=True),
        "predicted_margin": Column("number", _of_predicted("margin"), null=True),
        "score": Column("number", _of_predicted("score"), CORE + "score", null=True),
    },
    ("arity",),
)


@dataclass(frozen=True, slots=True)
class _PlanOf:
    """A plan within its episode."""

    plan: ExecutedPlan
    episode: Episode


PLAN_ROW = Row(
    "A plan that was executed; `retained` is whether every required fact was predicted, which is no success.",
    {
        **printed(EXECUTED_PLAN, via=lambda part: part.plan),
        "retained": Column(
            "boolean", lambda part, _: None if part.plan.predicted is None else not part.plan.diagnoses, null=True
        ),
        "failures": Column(
            "words:failure", lambda part, schema: [short_name(each.failure, schema) for each in part.plan.diagnoses]
        ),
        "facts": Column(
            "list:PlannedFact",
            lambda part, schema: [
                PLANNED_FACT.of(_Planned(fact, part.plan, index), schema)
                for index, fact in enumerate(part.episode.required.facts)
            ],
        ),
        "verification": Column(
            "record:Verification",
            lambda part, schema: VERIFIED.of(part.plan.verification, schema),
            TRACE + "verification",
        ),
    },
)


def _plans(episode: Episode, schema: Schema) -> Any:  # noqa: ANN401 - a list, or nothing of the kind
    return [PLAN_ROW.of(_PlanOf(plan, episode), schema) for plan in episode.plans] or OMITTED


def _setting(name: str) -> Callable[[Episode, Schema], Any]:
    """The value of ``name`` in an episode's provenance."""
    return lambda episode, _: dict(episode.provenance).get(name, OMITTED)


def _uncertain(episode: Episode, schema: Schema) -> Any:  # noqa: ANN401 - a list, or nothing of the kind
    del schema
    settings = dict(episode.provenance)
    return json.loads(settings.get("uncertain", "[]")) if "start_settle_steps" in settings else OMITTED


EPISODE_ROW = Row(
    "One run of the correction loop, as `onto repair --json` prints it.",
    {
        **printed(EPISODE),
        "language": Column("string", lambda episode, _: episode.required.language, TRACE + "language"),
        "required": Column("strings", lambda episode, schema: [atom(fact, schema) for fact in episode.required.facts]),
        "diagnoses": Column(
            "list:Diagnosis",
            lambda episode, schema: [
                FIRST_DIAGNOSIS.of(_InEpisode(d, episode), schema) for d in first_diagnoses(episode)
            ],
            PROV + "wasGeneratedBy",
            reverse=True,
        ),
        "attempts": Column("integer", lambda episode, _: len(episode.attempts)),
        "history": Column(
            "list:Attempt",
            lambda episode, schema: [ATTEMPT_ROW.of(attempt, schema) for attempt in episode.attempts],
            TRACE + "inEpisode",
            reverse=True,
        ),
        "plans": Column("list:ExecutedPlan", _plans, TRACE + "inEpisode", reverse=True, optional=True),
        "settle_steps": Column("integer", _setting("start_settle_steps"), optional=True),
        "uncertain": Column("list:UncertainFact", _uncertain, optional=True),
        "reason": Column("string", _setting("reason"), optional=True),
        "accepted": Column("boolean", lambda episode, _: episode.accepted),
        "judge": Column("string", lambda episode, _: episode.judge),
        "settled": Column(
            "boolean",
            lambda episode, _: None if episode.verification is None else episode.verification.settled,
            null=True,
        ),
        **_verification(),
    },
)


# What commands print


def _key(name: str) -> Callable[[Mapping[str, Any], Schema], Any]:
    return lambda found, _: found[name]


def _plain(value: Any) -> Any:  # noqa: ANN401 - an object for a record
    return asdict(value) if is_dataclass(value) and not isinstance(value, type) else value


def _field(name: str) -> Callable[[Any, Schema], Any]:
    """A field of a result of :mod:`runtime.commands.tasks`; records as objects."""

    def value(task: Any, schema: Schema) -> Any:  # noqa: ANN401 - of any field
        del schema
        found = getattr(task, name)
        return list(map(_plain, found)) if isinstance(found, tuple) else found

    return value


def _start(value: Callable[[str], Callable[[Any, Schema], Any]]) -> dict[str, Column]:
    """How the judged state was made; ``value`` finds each of these by its name."""
    return {
        "settle_steps": Column("integer", value("settle_steps")),
        "fixtures": Column("string", value("fixtures"), null=True),
        "uncertain": Column("list:UncertainFact", value("uncertain")),
    }


UNCERTAIN = Row(
    "A fact whose verdict hangs on where fixtures stood, which a flat state does not say: how far they may be moved.",
    {
        "fact": Column("string", _key("fact")),
        "margin": Column("number", _key("margin"), CORE + "margin", null=True),
        "unit": Column("word:unit", _key("unit"), CORE + "unit", blank=True),
        "fixtures": Column("strings", _key("fixtures")),
        "reach": Column("number", _key("reach")),
    },
)
GROUNDING = Row(
    "What `onto ground --json` prints.",
    {
        "world": Column("string", _field("world")),
        "suite": Column("string", _field("suite"), TRACE + "suite"),
        "task": Column("string", _field("task"), TRACE + "task"),
        "state": Column("integer", _field("state"), TRACE + "stateIndex"),
        "facts": Column("list:ObservedFact", _field("facts"), TRACE + "memberFact"),
        "premise": Column("list:ObservedFact", _field("premise"), TRACE + "declares"),
        "native_success": Column("boolean", _field("native_success"), TRACE + "outcomeTruth", null=True),
        **_start(_field),
    },
)
DIAGNOSES = Row(
    "What `onto diagnose --json` prints.",
    {
        "task": Column("string", _field("task"), TRACE + "task"),
        "state": Column("integer", _field("state"), TRACE + "stateIndex"),
        "diagnoses": Column("list:UnmetFact", _field("diagnoses"), PROV + "wasGeneratedBy", reverse=True),
        "alternatives": Column("rows:string", _field("alternatives"), optional=True),
        **_start(_field),
    },
)
DEMONSTRATION = Row(
    "What `onto demo --json` prints: one episode per task, and how many ended well.",
    {
        "tasks": Column(
            "list:Episode", lambda found, schema: [EPISODE_ROW.of(each, schema) for each in found["tasks"]], GRAPH
        ),
        "accepted": Column("integer", _key("accepted")),
        "settled": Column("integer", _key("settled")),
        "wall_s": Column("number", _key("wall_s")),
    },
)
RECORDED = Described(
    RECORDS,
    {
        "Attempt": ATTEMPT_ROW,
        "Demonstration": DEMONSTRATION,
        "Diagnoses": DIAGNOSES,
        "Diagnosis": FIRST_DIAGNOSIS,
        "Episode": EPISODE_ROW,
        "ExecutedPlan": PLAN_ROW,
        "Grounding": GROUNDING,
        "ObservedFact": OBSERVED,
        "PlannedFact": PLANNED_FACT,
        "UncertainFact": UNCERTAIN,
        "UnmetFact": UNMET,
        "Verification": VERIFIED,
    },
    ("Grounding", "Diagnoses", "Episode", "Demonstration"),
)
"""What the runtime adds to ``onto schema``, by the entry point ``onto_evwm.records``."""
