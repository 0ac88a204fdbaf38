"""Forms that only a trace has: vectors, and references to the fact of a diagnosis and the diagnosis of a decision."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pyoxigraph import Literal

from onto_compiler.rdf import CORE, TRACE, XSD, integer, node
from onto_compiler.record.forms import Iri, Notation, Scalar, of_class
from onto_compiler.record.places import Spot, Statement, Subject
from onto_compiler.record.table import Field, PropertyShape, Record, same
from onto_compiler.record.walk import read_record, write_record
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.required_rdf import FACT
from onto_compiler.schema import Schema
from runtime.loop.records import Diagnosis

__all__ = ["ARRAY", "Diagnosed", "FactReference", "OfDiagnosis", "diagnosis_iri"]

OF = TRACE + "of"


def _array(value: ArrayLike) -> Literal:
    data = base64.b64encode(np.ascontiguousarray(value, dtype="<f8").tobytes()).decode("ascii")
    return Literal(data, datatype=node(XSD + "base64Binary"))


def _numbers(text: str) -> NDArray[np.float64]:
    return np.frombuffer(base64.b64decode(text, validate=True), dtype="<f8").astype(np.float64)


ARRAY = Scalar(XSD + "base64Binary", "array", _array, _numbers)
"""A vector as one literal: its doubles (IEEE 754, little-endian) in base64. Every bit comes back, in two thirds of the
characters that decimals need and in one statement, where an RDF list takes two for each number."""


@dataclass(frozen=True, slots=True)
class FactReference:
    """A diagnosis refers to its fact by number: to one of the goal, or to a precondition of one."""

    json: str = "string"

    def write(self, field: Field, value: tuple[Fact, int, bool], spot: Spot) -> Iterator[Statement]:
        """The reference. A diagnosis of another fact states that fact, and the shapes refuse it (ABX002)."""
        fact, index, precondition = value
        facts = _facts(spot.holder("required").required, precondition=precondition)
        iri = f"{spot.top}/required/{'precondition/' if precondition else ''}fact/{index}"
        if not (0 <= index < len(facts) and (facts[index] is fact or facts[index] == fact)):
            iri = f"{spot.iri}/fact/0"
            yield from write_record(FACT, spot.part(fact, iri, spot.graph))
        yield from spot.say(field.term, node(iri))

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is a reference."""
        return subject.one(field.term) is not None

    def read(self, field: Field, subject: Subject) -> tuple[Fact, int, bool]:
        """The fact that the required ABox, which is read first, has under that number."""
        other = subject.at(subject.need(field.term).value)
        precondition = "/precondition/" in other.iri
        facts = _facts(subject.shared["required"], precondition=precondition)
        if other.number >= len(facts):
            raise subject.fault("speaks of a fact that the required ABox does not hold")
        return facts[other.number], other.number, precondition

    def printed(self, value: Any, names: Schema) -> Any:  # noqa: ANN401 - rows decide what they show of a fact
        """The value itself."""
        del names
        return value

    def shapes(self, field: Field) -> tuple[PropertyShape, ...]:
        """One required fact."""
        return (PropertyShape(field.term, 1, 1, *of_class(CORE + "RequiredFact")),)


def _facts(required: RequiredABox, *, precondition: bool) -> tuple[Fact, ...]:
    return tuple(each.fact for each in required.preconditions) if precondition else required.facts


def diagnosis_iri(spot: Spot) -> tuple[str, int | None]:
    """Of the decision at ``spot``: the IRI of its diagnosis, and its place among those that the attempt lists."""
    attempt = spot.above
    if attempt is None:
        raise ValueError("a decision stands within an attempt")
    listed: Sequence[Diagnosis] = attempt.record.diagnoses
    place = next((number for number, each in enumerate(listed) if same(each, spot.record.diagnosis)), None)
    return f"{attempt.iri}/diagnosis/{'selected' if place is None else place}", place


@dataclass(frozen=True, slots=True)
class Diagnosed:
    """A decision speaks of one of the diagnoses of its attempt, or of one of its own."""

    record: Record
    json: str = "record"

    def write(self, field: Field, value: Diagnosis, spot: Spot) -> Iterator[Statement]:
        """The reference; a diagnosis that the attempt does not list is stated beside those that it lists."""
        iri, place = diagnosis_iri(spot)
        yield from spot.say(field.term, node(iri))
        if place is None:
            part = spot.part(value, iri, spot.graph)
            yield from part.say(TRACE + "index", integer(len(spot.holder("diagnoses").diagnoses)))
            yield from write_record(self.record, part)

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is a reference."""
        return subject.one(field.term) is not None

    def read(self, field: Field, subject: Subject) -> Diagnosis:
        """The diagnosis."""
        found: Diagnosis = read_record(self.record, subject.at(subject.need(field.term).value))
        return found

    def printed(self, value: Diagnosis, names: Schema) -> Diagnosis:
        """The value itself."""
        del names
        return value

    def shapes(self, field: Field) -> tuple[PropertyShape, ...]:
        """One diagnosis."""
        return (PropertyShape(field.term, 1, 1, *of_class(self.record.type)),)


@dataclass(frozen=True, slots=True)
class OfDiagnosis:
    """A value that is said of the diagnosis that a decision speaks of, where the routing rules look for it."""

    form: Iri | Notation

    @property
    def json(self) -> str:
        """As of the form."""
        return self.form.json

    def write(self, field: Field, value: str, spot: Spot) -> Iterator[Statement]:
        """The form's statement, of the diagnosis."""
        yield spot.graph, diagnosis_iri(spot)[0], field.term, self.form.term(value)

    def present(self, field: Field, subject: Subject) -> bool:
        """As of the form."""
        return self.form.present(field, subject.at(subject.need(OF).value))

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - text
        """As of the form."""
        return self.form.read(field, subject.at(subject.need(OF).value))

    def printed(self, value: Any, names: Schema) -> Any:  # noqa: ANN401 - text
        """As of the form."""
        return self.form.printed(value, names)

    def shapes(self, field: Field) -> tuple[PropertyShape, ...]:
        """Nothing of the decision: it is for the shape of diagnoses."""
        del field
        return ()
