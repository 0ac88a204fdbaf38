"""The forms of fields that hold other records: said of the same subject, one at a path, several in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from onto_compiler.rdf import integer, node
from onto_compiler.record.forms import INDEX, Names, Single, of_class
from onto_compiler.record.places import Spot, Statement, Subject
from onto_compiler.record.table import Field, PropertyShape, Record
from onto_compiler.record.walk import read_record, write_record

__all__ = ["Inline", "Part", "Parts"]


@dataclass(frozen=True, slots=True)
class Inline:
    """A record that is said of the subject of the record that holds it."""

    record: Record
    json: str = "record"

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - a record
        """Its statements."""
        del field
        yield from write_record(self.record, spot.part(value, spot.iri, spot.graph))

    def present(self, field: Field, subject: Subject) -> bool:
        """Whether its first field is there."""
        del field
        first = self.record.fields[0]
        return first.form.present(first, subject)

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - a record
        """The record."""
        del field
        return read_record(self.record, subject)

    def printed(self, value: Any, names: Names) -> Any:  # noqa: ANN401 - a record
        """Rows have the fields of such a record in the place of it."""
        del names
        return value

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Those of its fields, none of which must be there where it may be missing as a whole."""
        for inner in self.record.fields:
            for shape in inner.form.shapes(inner):
                least = shape.least if field.needed and field.asked else 0
                yield PropertyShape(shape.path, least, shape.most, shape.pairs, shape.wanted)


@dataclass(frozen=True, slots=True)
class Part(Single):
    """Another record, at ``path``, in a graph of its own where it is to have one."""

    record: Record
    at: str
    graph: bool = False
    json: str = "record"

    @property
    def constraint(self) -> tuple[tuple[tuple[str, str], ...], str]:
        """The SHACL constraints on the value."""
        return of_class(self.record.type)

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - a record
        """One statement."""
        iri = spot.path(self.at)
        yield from spot.say(field.term, node(iri))
        yield from write_record(self.record, spot.part(value, iri, iri if self.graph else ""))

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - a record
        """The value."""
        return read_record(self.record, subject.at(subject.need(field.term).value))


@dataclass(frozen=True, slots=True)
class Parts:
    """Several records in order, at ``at`` with their number in the place of ``{}``.

    ``reverse``: they point to the record that holds them. ``own``: they know their number themselves, as a field
    ``index``; else it is their place. ``split`` and ``join`` lead from the field's value to the records and back;
    ``graph``: the path of the graph that they stand in, ``{}`` for one of their own. ``find`` takes the place of a
    field's term where nothing points to them. ``show`` makes the JSON of the field's value, of the kind ``json``.
    """

    record: Record
    at: str
    reverse: bool = False
    own: bool = False
    graph: str = ""
    split: Callable[[Any, Spot], Sequence[Any]] = lambda value, _: value
    join: Callable[[list[Any]], Any] = tuple
    find: Callable[[Subject], list[Subject]] | None = None
    json: str = "list"
    show: Callable[[Any], Any] = lambda value: value

    def write(self, field: Field, value: Any, spot: Spot) -> Iterator[Statement]:  # noqa: ANN401 - any number of records
        """The link, the number and the statements of each."""
        for place, record in enumerate(self.split(value, spot)):
            iri = spot.path(self.at, record.index if self.own else place)
            graph = iri if self.graph == "{}" else spot.path(self.graph) if self.graph else spot.graph
            part = spot.part(record, iri, graph)
            if self.reverse:
                yield from part.say(field.term, node(spot.iri))
            elif field.term:
                yield from spot.say(field.term, node(iri))
            if not self.own:
                yield from part.say(INDEX, integer(place))
            yield from write_record(self.record, part)

    def present(self, field: Field, subject: Subject) -> bool:
        """No records are as good as any number."""
        del field, subject
        return True

    def read(self, field: Field, subject: Subject) -> Any:  # noqa: ANN401 - as above
        """The records by number."""
        if self.find is not None:
            found = self.find(subject)
        elif self.reverse:
            found = [each for each in subject.back(field.term) if each.is_a(self.record.type)]
        else:
            found = subject.follow(field.term)
        return self.join([read_record(self.record, each) for each in sorted(found, key=_index)])

    def printed(self, value: Any, names: Names) -> Any:  # noqa: ANN401 - as above
        """What ``show`` makes of them."""
        del names
        return self.show(value)

    def shapes(self, field: Field) -> Iterable[PropertyShape]:
        """Records of their class; at least one where the field may not be empty."""
        if field.term and not self.reverse:
            pairs, wanted = of_class(self.record.type)
            yield PropertyShape(field.term, int(field.needed and field.asked), 0, pairs, wanted)


def _index(subject: Subject) -> int:
    term = subject.need(INDEX)
    try:
        return int(term.value)
    except ValueError as error:
        raise subject.fault(f"has the unusable value `{term.value}` of `trace:index`") from error
