"""The JSON rows of facts: as observed in a state, and as diagnosed and routed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from grounding.observation import Observation
from onto_compiler.rdf import CORE
from onto_compiler.record.rows import Column, Row, printed
from onto_compiler.required import Fact
from onto_compiler.required_rdf import FACT
from onto_compiler.tables import SATISFIED, STATUSES
from runtime.loop.diagnosis import evidence_status
from runtime.loop.records import Diagnosis
from runtime.trace.table import DIAGNOSIS, OBSERVED_FACT, ROUTE_DECISION
from runtime.wording import atom, unit_of

__all__ = [
    "OBSERVED",
    "UNMET",
    "RoutedDiagnosis",
    "SeenFact",
    "diagnosis_of",
    "fact_columns",
    "fact_of",
    "limit_column",
    "seen_facts",
    "unit_column",
]


@dataclass(frozen=True, slots=True)
class SeenFact:
    """Fact ``index`` of an ABox with its observation; ``status`` is an IRI."""

    fact: Fact
    observation: Observation
    index: int
    status: str

    @property
    def truth(self) -> bool:
        """Whether it was observed to hold."""
        return bool(self.observation.truth[self.index])

    @property
    def margin(self) -> float:
        """In the unit of the fact; NaN if none is defined."""
        return float(self.observation.margin[self.index])

    @property
    def limit(self) -> str:
        """The term that decides the margin."""
        return self.observation.limit[self.index]


def seen_facts(facts: Sequence[Fact], observation: Observation) -> list[SeenFact]:
    """Each of ``facts`` with its ``observation``."""
    codes = evidence_status(facts, observation)
    return [SeenFact(fact, observation, i, STATUSES[codes[i]]) for i, fact in enumerate(facts)]


def fact_columns(via: Callable[[Any], Fact]) -> dict[str, Column]:
    """Predicate, arguments and polarity of the fact that ``via`` leads to."""
    return printed(FACT, "predicate", "arguments", "polarity", via=via)


def unit_column(via: Callable[[Any], Fact]) -> dict[str, Column]:
    """The symbol of the unit of the fact's margin."""
    value = lambda subject, schema: unit_of(via(subject), schema)  # noqa: E731 - the column's value
    return {"unit": Column("word:unit", value, CORE + "unit", blank=True)}


def limit_column(via: Callable[[Any], Any]) -> dict[str, Column]:
    """The term that decides the margin."""
    return {"limit": Column("string", lambda subject, _: via(subject).limit, CORE + "limit")}


def itself(subject: Any) -> Any:  # noqa: ANN401 - whatever a row is about
    return subject


OBSERVED = Row(
    "What the simulator's state says of one required fact.",
    {
        "fact": Column("string", lambda seen, schema: atom(seen.fact, schema)),
        **fact_columns(lambda seen: seen.fact),
        # Closed world: what was not seen to hold is false, and never undefined.
        "truth": Column("boolean", lambda seen, _: seen.truth, CORE + "truth"),
        "satisfied": Column("boolean", lambda seen, _: seen.status == SATISFIED),
        **printed(OBSERVED_FACT, "status", "margin"),
        **unit_column(lambda seen: seen.fact),
        **limit_column(itself),
        "native": Column("string", lambda seen, _: str(seen.fact.native), CORE + "nativeAtom"),
    },
    ("arity",),
)


@dataclass(frozen=True, slots=True)
class RoutedDiagnosis:
    """A diagnosis of one state with the route of a first attempt (its IRI), and whether it is the one to act on."""

    diagnosis: Diagnosis
    route: str
    selected: bool = False


def diagnosis_of(subject: Any) -> Diagnosis:  # noqa: ANN401 - what has a diagnosis
    """The diagnosis of what a row is about."""
    found: Diagnosis = subject.diagnosis
    return found


def fact_of(subject: Any) -> Fact:  # noqa: ANN401 - as above
    """The diagnosed fact of what a row is about."""
    return diagnosis_of(subject).fact


UNMET = Row(
    "A diagnosis of one state, with the route that a first attempt would take.",
    {
        "fact": Column("string", lambda unmet, schema: atom(unmet.diagnosis.fact, schema)),
        **fact_columns(fact_of),
        **printed(DIAGNOSIS, "truth", "status", "margin", via=diagnosis_of),
        **unit_column(fact_of),
        **limit_column(diagnosis_of),
        **printed(DIAGNOSIS, "failure", via=diagnosis_of),
        **printed(ROUTE_DECISION, "route"),
        "rule": Column("string", lambda unmet, schema: schema.labels.get(unmet.diagnosis.rule, unmet.diagnosis.rule)),
        "selected": Column("boolean", lambda unmet, _: unmet.selected),
    },
    ("arity", "route"),
)
