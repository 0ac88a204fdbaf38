"""Quads in, records out: the exact inverse of :mod:`runtime.trace.write`."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from pyoxigraph import Literal, NamedNode, Store

from grounding.observation import Observation
from onto_compiler.problems import OntoError, Span
from onto_compiler.rdf import CORE, RDF, RDFS, TRACE, node
from onto_compiler.required import Entity, Fact, NativeAtom, Precondition, RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.tables import ABSENT
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
from runtime.trace.names import ENDS, LEVELS, MODES, OUTCOMES, RUNS, SOURCES, inverse

__all__ = ["episode_iris", "read_episode"]

_PLACE = re.compile(r"(\d+):(\d+)-(\d+):(\d+)")
_ATOM = re.compile(r"([^(]*)\((.*)\)", re.DOTALL)
_END, _LEVEL, _MODE, _OUTCOME, _SOURCE = (inverse(table) for table in (ENDS, LEVELS, MODES, OUTCOMES, SOURCES))
_TRUE = frozenset(("true", "1"))
T = TypeVar("T")


def episode_iris(store: Store) -> tuple[str, ...]:
    """The IRIs of every recorded episode, by suite, task and state index."""
    return tuple(sorted(_pointing(store, RDF + "type", TRACE + "Episode"), key=_natural))


def _pointing(store: Store, predicate: str, target: str) -> set[str]:
    """The IRIs of the subjects that point to ``target`` with ``predicate``."""
    quads = store.quads_for_pattern(None, node(predicate), node(target), None)
    return {quad.subject.value for quad in quads if isinstance(quad.subject, NamedNode)}


def _natural(text: str) -> list[tuple[int, str]]:
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", text)]


def read_episode(store: Store, iri: str) -> Episode:
    """The episode ``iri`` as it was recorded.

    Raises:
        OntoError: TRC003, where the trace lacks a statement that the record needs, or holds an unusable value.
    """
    about = _Subject(store, iri)
    required = _required(about.subject("trace_requires"))
    provenance = about.json("trace_provenance")
    parts = list(about.incoming(TRACE + "inEpisode"))
    attempts = [_attempt(part, required) for part in parts if not part.is_a(TRACE + "ExecutedPlan")]
    plans = [_plan(part, required) for part in parts if part.is_a(TRACE + "ExecutedPlan")]
    verification = about.subject_or_none("trace_verification")
    return Episode(
        task=about.text("trace_task"),
        suite=about.text("trace_suite"),
        state_index=about.integer("trace_stateIndex"),
        seed=about.integer("trace_seed"),
        required=required,
        initial=_observation(about.subject("trace_initial")),
        premise=_observation(about.subject("trace_premise")),
        premise_holds=about.boolean("trace_premiseHolds"),
        attempts=tuple(sorted(attempts, key=lambda attempt: attempt.index)),
        final=_observation(about.subject("trace_final")),
        outcome=about.word("trace_outcome", _OUTCOME),
        verification=_verification(verification) if verification else None,
        provenance=tuple(provenance.items()),
        plans=tuple(sorted(plans, key=lambda plan: plan.index)),
    )


@dataclass(frozen=True, slots=True)
class _Subject:
    """One subject of the trace and typed access to what is said of it, in whatever graph."""

    store: Store
    iri: str

    def _values(self, key: str) -> list[str]:
        space, _, local = key.partition("_")
        predicate = node({"core": CORE, "trace": TRACE, "rdf": RDF, "rdfs": RDFS}[space] + local)
        objects = {quad.object for quad in self.store.quads_for_pattern(node(self.iri), predicate, None, None)}
        return sorted(term.value for term in objects if isinstance(term, (NamedNode, Literal)))

    def text_or_none(self, key: str) -> str | None:
        """The lexical form or IRI of the one value of ``key``."""
        values = self._values(key)
        if len(values) > 1:
            raise self.fault(f"has {len(values)} values of `{key.replace('_', ':', 1)}` where one is allowed")
        return values[0] if values else None

    def text(self, key: str) -> str:
        """As :meth:`text_or_none`, of a statement that must be there."""
        value = self.text_or_none(key)
        if value is None:
            raise self.fault(f"lacks `{key.replace('_', ':', 1)}`")
        return value

    def convert(self, key: str, convert: Callable[[str], T]) -> T:
        """The value of ``key`` through ``convert``."""
        text = self.text(key)
        try:
            return convert(text)
        except (ValueError, KeyError) as error:
            raise self.fault(f"has the unusable value `{text}` of `{key.replace('_', ':', 1)}`") from error

    def integer(self, key: str) -> int:
        return self.convert(key, int)

    def number(self, key: str) -> float:
        """A double; NaN where nothing is said."""
        return float("nan") if self.text_or_none(key) is None else self.convert(key, float)

    def boolean(self, key: str) -> bool:
        return self.text(key) in _TRUE

    def word(self, key: str, words: dict[str, str]) -> str:
        return self.convert(key, words.__getitem__)

    def word_or_none(self, key: str, words: dict[str, str]) -> str | None:
        return None if self.text_or_none(key) is None else self.word(key, words)

    def json(self, key: str) -> Any:  # noqa: ANN401 - whatever JSON holds
        return self.convert(key, json.loads)

    def place(self) -> int:
        """The number that ends the IRI: what is pointed to may not be there, as where a run broke off."""
        number = self.iri.rpartition("/")[2]
        if not number.isdecimal():
            raise self.fault("is no numbered part of an episode")
        return int(number)

    def is_a(self, kind: str) -> bool:
        pattern = self.store.quads_for_pattern(node(self.iri), node(RDF + "type"), node(kind), None)
        return next(pattern, None) is not None

    def subject(self, key: str) -> _Subject:
        return _Subject(self.store, self.text(key))

    def subject_or_none(self, key: str) -> _Subject | None:
        iri = self.text_or_none(key)
        return None if iri is None else _Subject(self.store, iri)

    def members(self, key: str) -> list[_Subject]:
        """The values of ``key`` in the order of their trace:index."""
        found = [_Subject(self.store, iri) for iri in self._values(key)]
        return sorted(found, key=lambda subject: subject.integer("trace_index"))

    def incoming(self, predicate: str) -> Iterator[_Subject]:
        """The subjects that point here with ``predicate``."""
        return (_Subject(self.store, iri) for iri in sorted(_pointing(self.store, predicate, self.iri)))

    def fault(self, what: str) -> OntoError:
        """TRC003 about this subject."""
        return OntoError.of("TRC003", f"the trace is incomplete: <{self.iri}> {what}", "record the episode again")


def _preconditions(facts: Sequence[_Subject]) -> Iterator[Precondition]:
    before: dict[str, list[int]] = {}
    for fact in facts:
        for needed in fact.members("core_precondition"):
            before.setdefault(needed.iri, []).append(fact.integer("trace_index"))
    subjects = [_Subject(facts[0].store, iri) for iri in before]
    for subject in sorted(subjects, key=lambda each: each.integer("trace_index")):
        yield Precondition(_fact(subject), tuple(sorted(before[subject.iri])), subject.text("core_declaration"))


def _required(about: _Subject) -> RequiredABox:
    members = list(about.members("trace_memberFact"))
    return RequiredABox(
        task=about.text("trace_task"),
        language=about.text("trace_language"),
        problem=about.text("trace_problem"),
        facts=tuple(_fact(fact) for fact in members),
        premise=tuple(_fact(fact) for fact in about.members("trace_declares")),
        source=about.text("trace_taskFile"),
        alternatives=tuple(
            tuple(fact.integer("trace_index") for fact in way.members("trace_asksFor"))
            for way in about.members("trace_alternative")
        ),
        preconditions=tuple(_preconditions(members)),
    )


def _fact(about: _Subject) -> Fact:
    arguments = (about.subject_or_none(key) for key in ("core_argument1", "core_argument2"))
    return Fact(
        predicate=about.text("core_predicate"),
        arguments=tuple(_entity(argument) for argument in arguments if argument is not None),
        native=about.convert("core_nativeAtom", _atom),
        grounded_by=about.text("core_groundedBy"),
        polarity=about.boolean("core_polarity"),
        threshold=about.convert("core_requiredMargin", float),
        span=_span(about) if about.text_or_none("trace_place") is not None else None,
    )


def _entity(about: _Subject) -> Entity:
    """An entity of the episode; a term of the ontology (a threshold) has no type in a record and stands for itself."""
    label = about.text_or_none("rdfs_label") if about.iri.startswith(RUNS) else None
    return Entity(local_name(about.iri), about.iri) if label is None else Entity(label, about.text("rdf_type"))


def _atom(text: str) -> NativeAtom:
    match = _ATOM.fullmatch(text)
    if match is None:
        raise ValueError(text)
    return NativeAtom(match[1], tuple(match[2].split(", ")) if match[2] else ())


def _span(about: _Subject) -> Span:
    match = _PLACE.fullmatch(about.text("trace_place"))
    if match is None:
        raise about.fault("has an unusable value of `trace:place`")
    return Span(about.text("trace_taskFile"), *(int(number) for number in match.groups()))


def _observation(about: _Subject) -> Observation:
    members = about.members("trace_memberFact")
    return Observation(
        source=about.word("core_source", _SOURCE),
        step=about.integer("trace_step"),
        observed=np.array([member.text("core_status") != ABSENT for member in members], dtype=np.bool_),
        truth=np.array([member.text_or_none("core_truth") in _TRUE for member in members], dtype=np.bool_),
        margin=np.array([member.number("core_margin") for member in members], dtype=np.float64),
        score=np.array([member.number("core_score") for member in members], dtype=np.float64),
        limit=tuple(member.text_or_none("core_limit") or "" for member in members),
    )


def _attempt(about: _Subject, required: RequiredABox) -> Attempt:
    application = about.subject_or_none("trace_applied")
    verification = about.subject_or_none("trace_verification")
    plan = about.subject_or_none("trace_forPlan")
    return Attempt(
        index=about.integer("trace_index"),
        observation=_observation(about.subject("trace_observed")),
        diagnoses=tuple(_diagnosis(diagnosis, required) for diagnosis in about.members("trace_diagnosis")),
        selected=_decision(about.subject("trace_selected"), required),
        application=_application(application) if application else None,
        verification=_verification(verification) if verification else None,
        fault=about.text_or_none("trace_fault") or "",
        plan=plan.place() if plan else None,
        prediction=_prediction(about) if about.text_or_none("trace_predicted") is not None else None,
    )


def _prediction(about: _Subject) -> Prediction:
    return Prediction(
        observation=_observation(about.subject("trace_predicted")),
        adopted=about.boolean("trace_adopted"),
        evaluations=about.integer("trace_evaluations"),
    )


def _plan(about: _Subject, required: RequiredABox) -> ExecutedPlan:
    predicted = about.subject_or_none("trace_predicted")
    return ExecutedPlan(
        index=about.integer("trace_index"),
        planner=about.text("trace_proposer"),
        evaluations=about.integer("trace_evaluations"),
        steps=about.integer("trace_controlSteps"),
        predicted=_observation(predicted) if predicted else None,
        diagnoses=tuple(_diagnosis(diagnosis, required) for diagnosis in about.members("trace_diagnosis")),
        simulated=_observation(about.subject("trace_simulated")),
        verification=_verification(about.subject("trace_verification")),
        mode=about.word("trace_mode", _MODE),
    )


def _diagnosis(about: _Subject, required: RequiredABox) -> Diagnosis:
    fact = about.subject("core_fact")
    index, precondition = fact.integer("trace_index"), next(fact.incoming(CORE + "precondition"), None) is not None
    facts = [each.fact for each in required.preconditions] if precondition else required.facts
    if index >= len(facts):
        raise about.fault("speaks of a fact that the required ABox does not hold")
    return Diagnosis(
        fact=facts[index],
        index=index,
        precondition=precondition,
        failure=about.text("core_failureClass"),
        status=about.text("core_status"),
        truth=about.boolean("core_truth"),
        margin=about.number("core_margin"),
        limit=about.text_or_none("core_limit") or "",
        source=about.word("core_source", _SOURCE),
        rule=about.text("core_diagnosedBy"),
        priority=about.integer("core_priority"),
    )


def _decision(about: _Subject, required: RequiredABox) -> RouteDecision:
    diagnosis = about.subject("trace_of")
    return RouteDecision(
        route=about.text("core_route"),
        diagnosis=_diagnosis(diagnosis, required),
        level=about.word("trace_atLevel", _LEVEL),
        decision=about.text("core_decision"),
        rule=about.text("core_routedBy"),
        attempt_status=diagnosis.text_or_none("core_attemptStatus") or "",
        previous=diagnosis.text_or_none("core_previousRoute"),
        requested=diagnosis.word_or_none("core_requestedLevel", _LEVEL) or "",
    )


def _application(about: _Subject) -> Application:
    return Application(
        proposal=_proposal(about.subject("trace_proposal")),
        mode=about.word("trace_mode", _MODE),
        displacement=about.convert("trace_displacement", float),
        steps=None if about.text_or_none("trace_controlSteps") is None else about.integer("trace_controlSteps"),
        end=about.word_or_none("trace_end", _END) or "",
        reason=about.text_or_none("trace_reason") or "",
    )


def _proposal(about: _Subject) -> Proposal:
    addresses: list[int] = about.json("trace_changed")
    return Proposal(
        route=about.text("trace_routeName"),
        proposer=about.text("trace_proposer"),
        candidate=about.integer("trace_candidate"),
        qpos=np.array(about.json("trace_qpos"), dtype=np.float64),
        changed=tuple(addresses),
        note=about.text_or_none("trace_note") or "",
    )


def _verification(about: _Subject) -> Verification:
    return Verification(
        query=about.text("trace_query"),
        outcome=about.boolean("trace_outcomeTruth"),
        settled=None if about.text_or_none("trace_settled") is None else about.boolean("trace_settled"),
        settle_steps=about.integer("trace_settleSteps"),
    )
