"""Records to statements and back: two walks of their table."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from pyoxigraph import Quad

from onto_compiler.rdf import RDF, node
from onto_compiler.record.places import Spot, Statement, Subject
from onto_compiler.record.table import Field, Record, missing

__all__ = ["quads_of", "read_record", "write_record"]

_TYPE = RDF + "type"


def write_record(record: Record, spot: Spot) -> Iterator[Statement]:
    """Every statement about the record at ``spot`` and its parts; what is not defined is left out."""
    if record.type:
        yield from spot.say(_TYPE, node(record.type))
    for field in record.fields:
        value = _value(field, spot.record)
        if not missing(field, value):
            yield from field.form.write(field, value, spot)
    for each in record.derived:
        yield from spot.say(each.term, *each.values(spot))


def read_record(record: Record, subject: Subject) -> Any:  # noqa: ANN401 - of the record's class
    """The record that :func:`write_record` wrote; ``subject.shared["read"]`` has the IRIs of it and its parts.

    Raises:
        OntoError: TRC003 if a statement that the record needs is not there, or a value cannot be used.
    """
    subject.shared.setdefault("read", set()).add(subject.iri)
    found: dict[str, Any] = {}
    for field in record.fields:
        value = _read(field, subject)
        names = field.name.split()
        found |= {field.name: value} if len(names) == 1 else dict(zip(names, value, strict=True))
    return record.cls(**found)


def quads_of(statements: Iterable[Statement]) -> Iterator[Quad]:
    """The statements as quads."""
    for graph, subject, predicate, value in statements:
        yield Quad(node(subject), node(predicate), value, node(graph))


def _value(field: Field, record: Any) -> Any:  # noqa: ANN401 - of any field
    names = field.name.split()
    values = tuple(getattr(record, name) for name in names)
    return values[0] if len(values) == 1 else values


def _read(field: Field, subject: Subject) -> Any:  # noqa: ANN401 - of any field
    former = field.older(subject) if field.older is not None else None
    if former is not None:
        return former
    if not field.needed and not field.form.present(field, subject):
        return field.missing
    return field.form.read(field, subject)
