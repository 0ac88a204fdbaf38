"""The forms that a plain value takes in RDF: a literal, an individual, a reference to a record (or to several)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pyoxigraph import Literal

from onto_compiler.rdf import TRACE, XSD, boolean, double, integer, node, shorten
from onto_compiler.record.places import Spot, Statement, Subject, Term
from onto_compiler.record.table import Field, PropertyShape

__all__ = [
    "BOOLEAN",
    "DOUBLE",
    "INDEX",
    "INTEGER",
    "LITERAL",
    "TEXT",
    "Iri",
    "Notation",
    "Number",
    "Numbers",
    "Scalar",
    "Single",
    "Sorted",
    "of_class",
    "of_datatype",
]

Names = Any  # the schema, from which JSON takes its names
INDEX = TRACE + "index"


def of_datatype(datatype: str) -> tuple[tuple[tuple[str, str], ...], str]:
    """The constraint on literals of ``datatype``, in Turtle and in words."""
    return (("sh:datatype", shorten(datatype)),), f"of datatype {shorten(datatype)}"


def of_class(iri: str) -> tuple[tuple[tuple[str, str], ...], str]:
    """The constraint on instances of the class ``iri``, in Turtle and in words; any IRI where it is empty."""
    return (
        ((("sh:class", shorten(iri)),), f"of class {shorten(iri)}") if iri else ((("sh:nodeKind", "sh:IRI"),), "an IRI")
    )


@dataclass(frozen=True, slots=True)
class Single:
    """The common base of forms with one value of one property."""

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is a value."""
        return bool(subject.all(field.term))

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - of any field
        """The value."""
        term = subject.need(field.term)
        try:
            return self.value(term)
        except (ValueError, KeyError, TypeError) as error:
            found = f"has the unusable value `{term.value}` of `{shorten(field.term)}`"
            raise subject.fault(found) from error

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - as above
        """One statement."""
        yield from spot.say(field.term, self.term(value))

    def printed(self, value: Any, names: Names) -> Any:  # noqa: ANN401 - as above
        """The value itself."""
        del names
        return value

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """One property with one value."""
        yield PropertyShape(field.term, int(field.needed and field.asked), 1, *self.constraint)

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """What SHACL asks of the value, in Turtle and in words."""
        raise NotImplementedError

    def term(self, value: Any) -> Term:  # noqa: ANN401 - as above
        """The value as RDF."""
        raise NotImplementedError

    def value(self, term: Term) -> Any:  # noqa: ANN401 - as above
        """What :meth:`term` made the term of."""
        raise NotImplementedError


@dataclass(frozen=True, slots=True)
class Scalar(Single):
    """A literal of one datatype; ``bounds`` are further constraints on it, with how they are said."""

    datatype: str
    json: str
    write_as: Callable[[Any], Literal]
    read_as: Callable[[str], Any]
    bounds: tuple[tuple[tuple[str, str], ...], str] = ((), "")

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        pairs, wanted = of_datatype(self.datatype)
        return (*pairs, *self.bounds[0]), self.bounds[1] or wanted

    def term(self, value: Any) -> Term:  # noqa: ANN401 - a value of the datatype
        """The value as RDF."""
        return self.write_as(value)

    def value(self, term: Term) -> Any:  # noqa: ANN401 - as above
        """What :meth:`term` made the term of."""
        return self.read_as(term.value)

    def printed(self, value: Any, names: Names) -> Any:  # noqa: ANN401 - as above
        """Numbers of numpy as Python's own, and an undefined one as None."""
        del names
        if self.json == "number" and value is not None:
            return None if value != value else float(value)  # noqa: PLR0124 - NaN differs from itself
        return bool(value) if self.json == "boolean" and value is not None else value


def _truth(text: str) -> bool:
    return {"true": True, "1": True, "false": False, "0": False}[text]


TEXT = Scalar(XSD + "string", "string", Literal, str)
INTEGER = Scalar(XSD + "integer", "integer", integer, int)
DOUBLE = Scalar(XSD + "double", "number", double, float)
BOOLEAN = Scalar(XSD + "boolean", "boolean", boolean, _truth)


@dataclass(frozen=True, slots=True)
class _AnyLiteral(Single):
    """Text, a number or a truth value, each as a literal of its own datatype."""

    json: str = "any"

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        return (("sh:nodeKind", "sh:Literal"),), "a literal"

    def term(self, value: Any) -> Term:  # noqa: ANN401 - one of four types
        """The value as RDF."""
        for kind, form in ((bool, BOOLEAN), (int, INTEGER), (float, DOUBLE), (str, TEXT)):
            if isinstance(value, kind):
                return form.term(value)
        raise ValueError(f"a setting is text, a number or a truth value, and {value!r} is none of them")

    def value(self, term: Term) -> Any:  # noqa: ANN401 - as above
        """What :meth:`term` made the term of."""
        kinds = {form.datatype: form for form in (BOOLEAN, INTEGER, DOUBLE, TEXT)}
        if not isinstance(term, Literal):
            raise TypeError(term)
        return kinds[term.datatype.value].value(term)


LITERAL = _AnyLiteral()


@dataclass(frozen=True, slots=True)
class Iri(Single):
    """A value that is an IRI itself: an instance of ``cls``, or one of ``among``.

    ``word`` names the kind of its short names in JSON (:mod:`onto_compiler.emit.words`); ``say`` makes such a name.
    """

    cls: str = ""
    word: str = ""
    among: tuple[str, ...] = ()
    say: Callable[[str, Names], str] | None = None

    @property
    def json(self) -> str:
        """A word of its kind, or text."""
        return f"word:{self.word}" if self.word else "string"

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        if not self.among:
            return of_class(self.cls)
        names = [shorten(iri) for iri in self.among]
        return (("sh:in", f"( {' '.join(names)} )"),), f"among {', '.join(names)}"

    def term(self, value: Any) -> Term:  # noqa: ANN401 - text
        """The value as RDF."""
        return node(value)

    def value(self, term: Term) -> Any:  # noqa: ANN401 - text
        """What :meth:`term` made the term of."""
        return term.value

    def printed(self, value: Any, names: Names) -> Any:  # noqa: ANN401 - text
        """The short name."""
        return value if self.say is None or not value else self.say(value, names)


@dataclass(frozen=True, slots=True)
class Notation(Single):
    """A short word for one of a class's individuals: ``words`` has their IRIs."""

    word: str
    cls: str
    words: Mapping[str, str]
    closed: bool = False  # whether the shapes list the individuals, where others may be declared for others' use

    @property
    def json(self) -> str:
        """A word of its kind."""
        return f"word:{self.word}"

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        return Iri(self.cls, among=tuple(sorted(self.words.values())) if self.closed else ()).constraint

    def term(self, value: Any) -> Term:  # noqa: ANN401 - text
        """The value as RDF."""
        return node(self.words[value])

    def value(self, term: Term) -> Any:  # noqa: ANN401 - text
        """What :meth:`term` made the term of."""
        return {iri: word for word, iri in self.words.items()}[term.value]


@dataclass(frozen=True, slots=True)
class Number(Single):
    """The number of another record, which becomes a reference to it: ``path`` leads there."""

    path: str
    cls: str
    json: str = "integer"

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        return of_class(self.cls)

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - a number
        """One statement."""
        yield from spot.say(field.term, node(spot.path(self.path, int(value))))

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - a number
        """The value."""
        # What is pointed to may not be there, as where a run broke off: its IRI has the number.
        return subject.at(subject.need(field.term).value).number


@dataclass(frozen=True, slots=True)
class Numbers:
    """The numbers of other records, in ascending order, as references; ``reverse``: they refer to this one."""

    path: str
    cls: str
    reverse: bool = False
    json: str = "integers"

    def write(self, field: Field, value: Sequence[int], spot: Spot) -> Iterator[Statement]:
        """One statement for each number."""
        for number in value:
            other = spot.path(self.path, number)
            if self.reverse:
                yield spot.graph, other, field.term, node(spot.iri)
            else:
                yield from spot.say(field.term, node(other))

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is a reference."""
        return bool(self._others(field, subject))

    def read(self, field: Field, subject: Subject) -> tuple[int, ...]:
        """The numbers."""
        return tuple(sorted(other.number for other in self._others(field, subject)))

    def printed(self, value: Sequence[int], names: Names) -> list[int]:
        """A list."""
        del names
        return list(value)

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Nothing: others' statements about this record are ignored."""
        if not self.reverse:
            pairs, _ = of_class(self.cls)
            least = int(field.needed and field.asked)
            yield PropertyShape(field.term, least, 0, pairs, f"of class {shorten(self.cls)}")

    def _others(self, field: Field, subject: Subject) -> list[Subject]:
        return subject.back(field.term) if self.reverse else subject.follow(field.term)


@dataclass(frozen=True, slots=True)
class Sorted:
    """Integers in ascending order, each a value of one property, so that a query can ask for one of them."""

    json: str = "integers"

    def write(self, field: Field, value: Sequence[int], spot: Spot) -> Iterator[Statement]:
        """One statement for each number; raises ValueError where their order or number would be lost."""
        if list(value) != sorted(set(value)):
            raise ValueError(f"`{field.name}` holds numbers in ascending order, each once, and not {tuple(value)}")
        yield from spot.say(field.term, *map(integer, value))

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether there is a number."""
        return bool(subject.all(field.term))

    def read(self, field: Field, subject: Subject) -> tuple[int, ...]:
        """The numbers; none where there are no statements."""
        try:
            return tuple(sorted(int(term.value) for term in subject.all(field.term)))
        except ValueError as error:
            raise subject.fault(f"has an unusable value of `{shorten(field.term)}`") from error

    def printed(self, value: Sequence[int], names: Names) -> list[int]:
        """A list."""
        del names
        return list(value)

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Any number of integers."""
        pairs, wanted = of_datatype(XSD + "integer")
        yield PropertyShape(field.term, 0, 0, pairs, wanted)
