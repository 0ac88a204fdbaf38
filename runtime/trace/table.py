"""The one description of what a trace holds: per field of :mod:`runtime.loop.records` its term, form and necessity.

To add a field, add it to its dataclass, to this table and, as a term, to ``ontology/trace.ttl``; writing, reading, the
JSON of the commands, its JSON Schema and the SHACL shapes follow from this table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from pyoxigraph import NamedNode

from grounding.observation import Observation
from onto_compiler.rdf import CORE, PROV, RDF, TRACE, XSD, node
from onto_compiler.record.forms import (
    BOOLEAN,
    DOUBLE,
    INDEX,
    INTEGER,
    LITERAL,
    TEXT,
    Iri,
    Notation,
    Number,
    Scalar,
    Sorted,
    of_class,
)
from onto_compiler.record.parts import Inline, Part, Parts
from onto_compiler.record.places import Spot, Subject
from onto_compiler.record.table import NAN, Derived, Field, Record
from onto_compiler.required_rdf import ALTERNATIVE, FACT, NATIVE_ATOM, REQUIRED_ABOX
from onto_compiler.schema import Schema
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, LEVELS, MARGIN_VIOLATED, STATUSES
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
from runtime.trace.forms import ARRAY, Diagnosed, FactReference, OfDiagnosis, diagnosis_iri
from runtime.trace.members import Seen, Setting, fact_of, join, named_values, settings, split
from runtime.trace.names import ENDS, MODES, OUTCOMES, SOURCES, run_of
from runtime.trace.older import from_json, pairs, vector
from runtime.wording import short_name

__all__ = ["EPISODE", "RECORDS", "TERMS"]

_DERIVED, _GENERATED, _USED, _INFORMED = (
    PROV + name for name in ("wasDerivedFrom", "wasGeneratedBy", "used", "wasInformedBy")
)
_SOURCE = Notation("source", CORE + "Source", SOURCES, closed=True)
_LEVEL = Notation("level", CORE + "Level", LEVELS)
_MODE = Notation("mode", TRACE + "Mode", MODES)


def _status(iri: str, schema: Schema) -> str:
    return schema.labels[iri]


def _lower(iri: str, schema: Schema) -> str:
    return short_name(iri, schema).lower()


def _rule(iri: str, schema: Schema) -> str:
    return schema.labels.get(iri, iri)


_ROUTE = Iri(CORE + "CorrectionRoute", "route", say=short_name)


def _link(predicate: str, lead: Callable[[Spot], str]) -> Derived:
    """A statement of PROV: what led to the record."""
    return Derived(predicate, lambda spot: (node(lead(spot)),))


def _maker(spot: Spot) -> str:
    """The activity that made a part: the nearest record that is one."""
    above = spot.above
    while above is not None and not isinstance(above.record, (Attempt, ExecutedPlan, Episode)):
        above = above.above
    return spot.top if above is None else above.iri


# What one source says of the facts


_ARRAYS = "observed truth margin score limit"


_PROBABILITY = (("sh:minInclusive", "0.0e0"), ("sh:maxInclusive", "1.0e0")), "an xsd:double between 0 and 1"
OBSERVED_FACT = Record(
    Seen,
    CORE + "ObservedFact",
    (
        Field("status", CORE + "status", Iri(word="status", among=tuple(sorted(STATUSES)), say=_status)),
        Field("truth", CORE + "truth", BOOLEAN, missing=None),
        Field("margin", CORE + "margin", DOUBLE, missing=NAN),
        Field(
            "score", CORE + "score", Scalar(XSD + "double", "number", DOUBLE.write_as, float, _PROBABILITY), missing=NAN
        ),
        Field("limit", CORE + "limit", TEXT, missing=""),
    ),
    (
        Derived(CORE + "fact", lambda spot: (node(fact_of(spot)),), *of_class(CORE + "RequiredFact")),
        Derived(CORE + "source", lambda spot: (_SOURCE.term(spot.holder("source").source),), *_SOURCE.constraint),
        _link(_DERIVED, fact_of),
    ),
    about="What an observed fact must have.",
)
OBSERVATION = Record(
    Observation,
    TRACE + "ObservedABox",
    (
        Field("source", CORE + "source", _SOURCE),
        Field("step", TRACE + "step", INTEGER),
        Field(
            _ARRAYS, TRACE + "memberFact", Parts(OBSERVED_FACT, "observation/{}", split=split, join=join), asked=False
        ),
    ),
    (
        Derived(_DERIVED, lambda spot: map(node, (f"{spot.top}/required", *spot.known.origins[spot.iri][1:]))),
        _link(_GENERATED, lambda spot: spot.known.origins[spot.iri][0]),
    ),
    about="What the ABox of one source at one step must have.",
)


# What was concluded of them


def _observed(spot: Spot) -> str:
    """What a diagnosis was concluded from. Observed ABoxes hold the goal's facts; of a precondition it alone speaks."""
    holder = spot.holder("diagnoses")
    abox = f"/observed/{holder.index}" if isinstance(holder, Attempt) else f"/plan/{holder.index}/predicted"
    seen = "" if spot.record.precondition else f"/observation/{spot.record.index}"
    return f"{spot.top}{abox}{seen}"


_UNSATISFIED = tuple(sorted((ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED)))
DIAGNOSIS = Record(
    Diagnosis,
    TRACE + "Diagnosis",
    (
        Field("fact index precondition", CORE + "fact", FactReference(), key=""),
        Field("failure", CORE + "failureClass", Iri(word="failure", say=short_name)),
        Field("status", CORE + "status", Iri(word="status", among=_UNSATISFIED, say=_status)),
        Field("truth", CORE + "truth", BOOLEAN),
        Field("margin", CORE + "margin", DOUBLE, missing=NAN),
        Field("limit", CORE + "limit", TEXT, missing=""),
        Field("source", CORE + "source", _SOURCE),
        Field("rule", CORE + "diagnosedBy", Iri(say=_rule)),
        Field("priority", CORE + "priority", INTEGER),
    ),
    (
        Derived(RDF + "type", lambda spot: (node(spot.record.failure),)),
        Derived(CORE + "requestedLevel", lambda _: (), *_LEVEL.constraint, asked=False),  # a decision writes it
        _link(_DERIVED, _observed),
        _link(_GENERATED, _maker),
    ),
    about="What a diagnosis must have.",
)


ROUTE_DECISION = Record(
    RouteDecision,
    TRACE + "RouteDecision",
    (
        Field("route", CORE + "route", _ROUTE),
        Field("diagnosis", TRACE + "of", Diagnosed(DIAGNOSIS), key=""),
        Field("level", TRACE + "atLevel", _LEVEL, key=""),
        Field("decision", CORE + "decision", Iri(CORE + "Decision", "decision", say=_lower)),
        Field("rule", CORE + "routedBy", Iri(say=_rule), key=""),
        Field("attempt_status", CORE + "attemptStatus", OfDiagnosis(Iri()), missing="", key=""),
        Field("previous", CORE + "previousRoute", OfDiagnosis(Iri()), missing=None, key=""),
        Field("requested", CORE + "requestedLevel", OfDiagnosis(_LEVEL), missing="", key=""),
    ),
    (
        _link(_DERIVED, lambda spot: diagnosis_iri(spot)[0]),
        _link(_GENERATED, _maker),
    ),
    about="What a route decision must have.",
)  # fmt: skip
VERIFICATION = Record(
    Verification,
    TRACE + "Verification",
    (
        Field("query", TRACE + "query", TEXT),
        Field("outcome", TRACE + "outcomeTruth", BOOLEAN),
        Field("settled", TRACE + "settled", BOOLEAN, missing=None),
        Field("settle_steps", TRACE + "settleSteps", INTEGER, asked=False, key=""),
    ),
    (
        Derived(_GENERATED, lambda spot: [node(_verified(spot)[0])]),
        Derived(_DERIVED, lambda spot: map(node, _verified(spot)[1:])),
    ),
    about="What a verification must have.",
)


def _verified(spot: Spot) -> tuple[str, ...]:
    """What a verification was asked by, and what it speaks of."""
    maker = _maker(spot)
    match spot.above.record if spot.above else None:
        case Attempt(application=None, selected=None):
            return maker, f"{spot.top}/observed/{spot.above.record.index}"  # type: ignore[union-attr]
        case Attempt(application=None):
            return maker, f"{maker}/decision"
        case Attempt():
            return f"{maker}/application", f"{maker}/proposal"
        case ExecutedPlan():
            return maker, f"{maker}/simulated"
        case _:
            return maker, f"{spot.top}/final", f"{spot.top}/required"


# What was done about it


def _proposed_route(spot: Spot) -> list[NamedNode]:
    """The declared route that a proposer served, which it names in its own way."""
    route = spot.known.routes.get(spot.record.route)
    return [] if route is None else [node(route)]


PROPOSAL = Record(
    Proposal,
    TRACE + "Proposal",
    (
        Field("route", TRACE + "routeName", TEXT, asked=False, key=""),
        Field("proposer", TRACE + "proposer", TEXT),
        Field("candidate", TRACE + "candidate", INTEGER),
        Field("qpos", TRACE + "qpos", ARRAY, asked=False, older=from_json(TRACE + "qpos", vector), key=""),
        Field("changed", TRACE + "changed", Sorted(), missing=(), older=from_json(TRACE + "changed", tuple), key=""),
        Field("note", TRACE + "note", TEXT, missing=""),
    ),
    (
        Derived(CORE + "route", _proposed_route, *of_class(CORE + "CorrectionRoute")),
        _link(_DERIVED, lambda spot: spot.path("../decision")),
        _link(_GENERATED, _maker),
    ),
    about="What a proposal must have.",
)
APPLICATION = Record(
    Application,
    TRACE + "Application",
    (
        Field("proposal", TRACE + "proposal", Part(PROPOSAL, "../proposal"), key=""),
        Field("mode", TRACE + "mode", _MODE),
        Field("displacement", TRACE + "displacement", DOUBLE, asked=False, key=""),
        Field("steps", TRACE + "controlSteps", INTEGER, missing=None),
        Field("end", TRACE + "end", Notation("end", TRACE + "ExecutionEnd", ENDS), missing=""),
        Field("reason", TRACE + "reason", TEXT, missing=""),
    ),
    (_link(_USED, lambda spot: spot.path("../proposal")), _link(_INFORMED, _maker)),
    about="What an application must have.",
)
PREDICTION = Record(
    Prediction,
    "",
    (
        Field("observation", TRACE + "predicted", Part(OBSERVATION, "predicted", graph=True), key=""),
        Field("adopted", TRACE + "adopted", BOOLEAN),
        Field("evaluations", TRACE + "evaluations", INTEGER),
    ),
)


def _failures(spot: Spot) -> Iterator[NamedNode]:
    """The kinds of failure that an attempt ended with."""
    attempt: Attempt = spot.record
    if attempt.application is not None and attempt.verification is not None and not attempt.verification.outcome:
        yield node(CORE + "ExecutionFailure")
    if attempt.fault:
        yield node(CORE + "RunFault")


_NUMBERED = Field("index", TRACE + "index", INTEGER, key="")
_IN_EPISODE = Derived(TRACE + "inEpisode", lambda _: (), *of_class(TRACE + "Episode"))  # Episode.attempts writes it
ATTEMPT = Record(
    Attempt,
    TRACE + "Attempt",
    (
        _NUMBERED,
        Field("observation", TRACE + "observed", Part(OBSERVATION, "/observed/{}", graph=True), key=""),
        Field("diagnoses", TRACE + "diagnosis", Parts(DIAGNOSIS, "diagnosis/{}"), missing=(), key=""),
        Field("selected", TRACE + "selected", Part(ROUTE_DECISION, "decision"), missing=None, key=""),
        Field("application", TRACE + "applied", Part(APPLICATION, "application"), missing=None, key=""),
        Field("verification", TRACE + "verification", Part(VERIFICATION, "verification"), missing=None, key=""),
        Field("fault", TRACE + "fault", TEXT, missing=""),
        Field("plan", TRACE + "forPlan", Number("/plan/{}", TRACE + "ExecutedPlan"), missing=None, key=""),
        Field("prediction", "", Inline(PREDICTION), missing=None, key=""),
    ),
    (
        _IN_EPISODE,
        Derived(TRACE + "failure", _failures),
        _link(_USED, lambda spot: f"{spot.top}/observed/{spot.record.index}"),
        _link(_INFORMED, lambda spot: spot.known.origins[spot.iri][0]),
    ),
    about="What an attempt must have.",
)
EXECUTED_PLAN = Record(
    ExecutedPlan,
    TRACE + "ExecutedPlan",
    (
        _NUMBERED,
        Field("planner", TRACE + "proposer", TEXT),
        Field("evaluations", TRACE + "evaluations", INTEGER),
        Field("mode", TRACE + "mode", _MODE),
        Field("steps", TRACE + "controlSteps", INTEGER),
        Field("predicted", TRACE + "predicted", Part(OBSERVATION, "predicted", graph=True), missing=None, key=""),
        Field("diagnoses", TRACE + "diagnosis", Parts(DIAGNOSIS, "diagnosis/{}"), missing=(), key=""),
        Field("simulated", TRACE + "simulated", Part(OBSERVATION, "simulated", graph=True), key=""),
        Field("verification", TRACE + "verification", Part(VERIFICATION, "verification"), key=""),
    ),
    (_IN_EPISODE, _link(_INFORMED, lambda spot: spot.known.origins[spot.iri][0])),
    about="What an executed plan must have.",
)


# The whole


SETTING = Record(
    Setting,
    TRACE + "Setting",
    (Field("name", TRACE + "name", TEXT), Field("value", TRACE + "value", LITERAL)),
    about="What a setting must have.",
)


def _named(path: str) -> Parts:
    return Parts(SETTING, path, split=settings, join=named_values, json="object", show=dict)


def _whole(path: str) -> Part:
    return Part(OBSERVATION, path, graph=True)


@dataclass(frozen=True, slots=True)
class _Shared(Part):
    """A part to which others refer by number; it is read before them."""

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - a record
        """The record, stored for those that refer to it."""
        subject.shared[field.name] = found = Part.read(self, field, subject)
        return found


EPISODE = Record(
    Episode,
    TRACE + "Episode",
    (
        Field("suite", TRACE + "suite", TEXT),
        Field("task", TRACE + "task", TEXT),
        Field("state_index", TRACE + "stateIndex", INTEGER, key="state"),
        Field("given", TRACE + "givenState", TEXT, missing=""),
        Field("seed", TRACE + "seed", INTEGER),
        Field("trial", TRACE + "trial", INTEGER, missing=0),
        Field("tags", TRACE + "tag", _named("tag/{}"), missing=()),
        Field("required", TRACE + "requires", _Shared(REQUIRED_ABOX, "/required", graph=True), key=""),
        Field("premise_holds", TRACE + "premiseHolds", BOOLEAN, asked=False),
        Field("initial", TRACE + "initial", _whole("/initial"), key=""),
        Field("premise", TRACE + "premise", _whole("/premise"), asked=False, key=""),
        Field("attempts", TRACE + "inEpisode", Parts(ATTEMPT, "attempt/{}", True, True, "{}"), missing=(), key=""),
        Field("plans", TRACE + "inEpisode", Parts(EXECUTED_PLAN, "plan/{}", True, True, "{}"), missing=(), key=""),
        Field("final", TRACE + "final", _whole("/final"), key=""),
        Field("outcome", TRACE + "outcome", Notation("outcome", TRACE + "Outcome", OUTCOMES)),
        Field("verification", TRACE + "verification", Part(VERIFICATION, "verification"), missing=None, key=""),
        Field(
            "provenance", TRACE + "provenance", _named("provenance/{}"), missing=(),
            older=from_json(TRACE + "provenance", pairs),
        ),
    ),
    (
        Derived(TRACE + "inRun", lambda spot: (node(run_of(spot.top)),), *of_class(TRACE + "Run"), asked=False),
        _link(_INFORMED, lambda spot: run_of(spot.top)),
        _link(_USED, lambda spot: f"{spot.top}/required"),
    ),
    about="What an episode must have.",
)  # fmt: skip

RECORDS = (
    ALTERNATIVE,
    APPLICATION,
    ATTEMPT,
    DIAGNOSIS,
    EPISODE,
    EXECUTED_PLAN,
    NATIVE_ATOM,
    OBSERVATION,
    OBSERVED_FACT,
    PROPOSAL,
    REQUIRED_ABOX,
    FACT,
    ROUTE_DECISION,
    SETTING,
    VERIFICATION,
)
"""Every record with a class of its own, which has a shape."""


def _terms(record: Record) -> Iterator[str]:
    """The classes and properties that a record has."""
    yield record.type
    yield from (each.term for each in record.derived)
    for field in record.fields:
        yield field.term
        if isinstance(field.form, Inline):
            yield from _terms(field.form.record)


TERMS = frozenset(term for record in RECORDS for term in _terms(record)) | {INDEX, TRACE + "place"}
"""Every term that a record states, or stated in former versions: what else a trace says of one would not be read."""
