"""The required ABox as RDF: its facts, its premise, its alternatives and the things that they speak of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from urllib.parse import quote

from pyoxigraph import Literal, Quad

from onto_compiler.problems import Span
from onto_compiler.rdf import BASE, CORE, PROV, RDF, RDFS, TRACE, XSD, node
from onto_compiler.record.forms import (
    BOOLEAN,
    DOUBLE,
    INDEX,
    INTEGER,
    TEXT,
    Iri,
    Numbers,
    of_class,
    of_datatype,
)
from onto_compiler.record.parts import Inline, Part, Parts
from onto_compiler.record.places import Known, Spot, Statement, Subject
from onto_compiler.record.table import Derived, Field, PropertyShape, Record
from onto_compiler.record.walk import quads_of, write_record
from onto_compiler.required import Entity, Fact, NativeAtom, Precondition, RequiredABox
from onto_compiler.schema import Schema, local_name

__all__ = ["FACT", "REQUIRED_ABOX", "entity_iri", "refuse_two_types", "required_quads", "stated_facts", "thresholds_of"]

RUNS = BASE + "run/"
_DERIVED = PROV + "wasDerivedFrom"
_PLACE = re.compile(r"(\d+):(\d+)-(\d+):(\d+)")
_ATOM = re.compile(r"([^(]*)\((.*)\)", re.DOTALL)


def required_quads(required: RequiredABox, schema: Schema, top: str) -> Iterator[Quad]:
    """Every statement about a required ABox and its premise, below the IRI ``top``, as an episode holds them.

    Raises:
        ValueError: where one name stands for entities of two types.
    """
    thresholds = thresholds_of(schema)
    refuse_two_types(stated_facts(required), thresholds)
    iri = f"{top}/required"
    yield from quads_of(write_record(REQUIRED_ABOX, Spot(required, iri, iri, top, Known(thresholds))))


def thresholds_of(schema: Schema) -> frozenset[str]:
    """The IRIs that may stand as arguments and are no entities of a scene."""
    return frozenset(threshold.iri for threshold in schema.thresholds.values())


def entity_iri(top: str, name: str) -> str:
    """The IRI of an argument below ``top``: ``plate_1`` of two scenes is two things."""
    return f"{top}/entity/{quote(name, safe='')}"


def stated_facts(required: RequiredABox) -> tuple[Fact, ...]:
    """Every fact that the record of a required ABox holds."""
    return (*required.facts, *required.premise, *(each.fact for each in required.preconditions))


def refuse_two_types(facts: Iterable[Fact], thresholds: frozenset[str]) -> None:
    """Hold ``facts`` to what can be read back: at most two arguments, and one type for each name.

    Raises:
        ValueError: where it cannot.
    """
    types: dict[str, str] = {}
    for fact in facts:
        if len(fact.arguments) > len(_ARGUMENTS):
            raise ValueError(f"`{fact}` has more than {len(_ARGUMENTS)} arguments")
        for argument in fact.arguments:
            if argument.type in thresholds:
                continue
            if types.setdefault(argument.name, argument.type) != argument.type:
                raise ValueError(f"`{argument.name}` is both a {types[argument.name]} and a {argument.type}")


_ARGUMENTS = (CORE + "argument1", CORE + "argument2")


@dataclass(frozen=True, slots=True)
class _Arguments:
    """The typed arguments of a fact: entities below the top, and thresholds, which stand for themselves."""

    json: str = "strings"

    def write(self, field: Field, value: Sequence[Entity], spot: Spot) -> Iterator[Statement]:
        """A link to each, and the type and name of an entity."""
        del field
        for predicate, entity in zip(_ARGUMENTS, value, strict=False):
            own = entity.type in spot.known.thresholds
            iri = entity.type if own else entity_iri(spot.top, entity.name)
            yield from spot.say(predicate, node(iri))
            if not own:
                yield spot.graph, iri, RDF + "type", node(entity.type)
                yield spot.graph, iri, RDFS + "label", Literal(entity.name)

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is one."""
        del field
        return subject.one(_ARGUMENTS[0]) is not None

    def read(self, field: Field, subject: Subject) -> tuple[Entity, ...]:
        """The arguments in order."""
        del field
        found = [subject.one(predicate) for predicate in _ARGUMENTS]
        return tuple(_entity(subject.at(term.value)) for term in found if term is not None)

    def printed(self, value: Sequence[Entity], names: Schema) -> list[str]:
        """Their names."""
        del names
        return [entity.name for entity in value]

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Entities; the second is not every predicate's."""
        del field
        for place, predicate in enumerate(_ARGUMENTS):
            yield PropertyShape(predicate, int(place == 0), 1, *of_class(CORE + "Entity"))


def _entity(subject: Subject) -> Entity:
    """An entity of the episode; a term of the ontology (a threshold) has no type in a record and stands for itself."""
    label = subject.one(RDFS + "label") if subject.iri.startswith(RUNS) else None
    if label is None:
        return Entity(local_name(subject.iri), subject.iri)
    return Entity(label.value, subject.need(RDF + "type").value)


@dataclass(frozen=True, slots=True)
class _Ordered:
    """Texts in order, as the members of an RDF container (``rdf:_1``, ``rdf:_2`` ...)."""

    json: str = "strings"

    def write(self, field: Field, value: Sequence[str], spot: Spot) -> Iterator[Statement]:
        """One statement for each."""
        del field
        for place, text in enumerate(value, 1):
            yield from spot.say(f"{RDF}_{place}", Literal(text))

    def present(self, field: Field, subject: Subject) -> bool:
        """None are as good as any number."""
        del field, subject
        return True

    def read(self, field: Field, subject: Subject) -> tuple[str, ...]:
        """The texts up to the first number that is not there."""
        del field
        found = list[str]()
        while (term := subject.one(f"{RDF}_{len(found) + 1}")) is not None:
            found.append(term.value)
        return tuple(found)

    def printed(self, value: Sequence[str], names: Schema) -> list[str]:
        """A list."""
        del names
        return list(value)

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Nothing: SHACL Core has no word for a container's members."""
        del field
        return ()


def _older_atom(subject: Subject) -> NativeAtom | None:
    """The atom of a trace that has it as text alone."""
    text = subject.one(CORE + "nativeAtom") if subject.one(TRACE + "atom") is None else None
    match = None if text is None else _ATOM.fullmatch(text.value)
    return None if match is None else NativeAtom(match[1], tuple(match[2].split(", ")) if match[2] else ())


def _older_span(subject: Subject) -> Span | None:
    """The place of a trace that has it in one text."""
    place = subject.one(TRACE + "place")
    match = None if place is None else _PLACE.fullmatch(place.value)
    if match is None:
        return None
    return Span(subject.need(TRACE + "taskFile").value, *(int(number) for number in match.groups()))


def _short(iri: str, names: Schema) -> str:
    return names.notations.get(iri, local_name(iri))


SPAN = Record(
    Span,
    "",
    (
        Field("line", TRACE + "line", INTEGER),
        Field("file", TRACE + "taskFile", TEXT, key=""),
        Field("column", TRACE + "column", INTEGER),
        Field("end_line", TRACE + "endLine", INTEGER, key=""),
        Field("end_column", TRACE + "endColumn", INTEGER, key=""),
    ),
)
NATIVE_ATOM = Record(
    NativeAtom,
    TRACE + "Atom",
    (Field("predicate", TRACE + "atomPredicate", TEXT), Field("arguments", "", _Ordered(), missing=())),
    about="What the atom of a task file must have.",
)
FACT = Record(
    Fact,
    CORE + "RequiredFact",
    (
        Field("predicate", CORE + "predicate", Iri(CORE + "Predicate", "predicate", say=_short)),
        Field("arguments", CORE + "arguments", _Arguments(), missing=()),
        Field("native", TRACE + "atom", Part(NATIVE_ATOM, "atom"), asked=False, older=_older_atom, key=""),
        Field("grounded_by", CORE + "groundedBy", TEXT, asked=False),
        Field("polarity", CORE + "polarity", BOOLEAN),
        Field("threshold", CORE + "requiredMargin", DOUBLE, asked=False),
        Field("span", "", Inline(SPAN), missing=None, older=_older_span, key=""),
    ),
    (
        Derived(
            CORE + "nativeAtom",
            lambda spot: (Literal(str(spot.record.native)),),
            (("sh:datatype", "xsd:string"),),
            "of datatype xsd:string",
        ),
        Derived(_DERIVED, lambda spot: (node(f"{spot.top}/required"),)),
    ),
    about="What a required fact must have.",
)
PRECONDITION = Record(
    Precondition,
    "",
    (
        Field("fact", "", Inline(FACT)),
        Field("before", CORE + "precondition", Numbers("/required/fact/{}", CORE + "RequiredFact", reverse=True)),
        Field("declared", CORE + "declaration", Iri(CORE + "Precondition")),
    ),
)


@dataclass(frozen=True, slots=True)
class _Way:
    """One alternative of a goal: the numbers of its facts."""

    facts: tuple[int, ...]


ALTERNATIVE = Record(
    _Way,
    TRACE + "Alternative",
    (Field("facts", TRACE + "asksFor", Numbers("/required/fact/{}", CORE + "RequiredFact")),),
    (
        Derived(INDEX, lambda _: (), *of_datatype(XSD + "integer")),  # the ABox writes it
        Derived(_DERIVED, lambda spot: (node(f"{spot.top}/required"),)),
    ),
    about="What a way to reach a goal must have.",
)


def _ways(value: Sequence[tuple[int, ...]], spot: Spot) -> list[_Way]:
    del spot
    return [_Way(way) for way in value]


def _preconditions(subject: Subject) -> list[Subject]:
    """The preconditions of the facts of an ABox; nothing else leads to them."""
    facts = subject.follow(TRACE + "memberFact")
    needed = {each.iri: each for fact in facts for each in fact.follow(CORE + "precondition")}
    return list(needed.values())


REQUIRED_ABOX = Record(
    RequiredABox,
    TRACE + "RequiredABox",
    (
        Field("task", TRACE + "task", TEXT),
        Field("language", TRACE + "language", TEXT, asked=False),
        Field("problem", TRACE + "problem", TEXT, asked=False),
        Field("source", TRACE + "taskFile", TEXT, asked=False),
        Field("facts", TRACE + "memberFact", Parts(FACT, "fact/{}")),
        Field("premise", TRACE + "declares", Parts(FACT, "/premise/fact/{}", graph="/premise"), missing=()),
        Field("alternatives", TRACE + "alternative", Parts(
            ALTERNATIVE, "alternative/{}", split=_ways, join=lambda ways: tuple(way.facts for way in ways)
        ), missing=()),
        Field("preconditions", "", Parts(
            PRECONDITION, "precondition/fact/{}", find=_preconditions), missing=(), key=""),
    ),
    about="What the ABox of a task must have.",
)  # fmt: skip
