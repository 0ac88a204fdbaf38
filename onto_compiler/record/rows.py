"""The JSON of records: rows of columns, each with its JSON Schema, its JSON-LD term and a function for its value.

A flat row speaks of several things at once (an attempt of its decision and application, say); read as RDF it is one
node that is all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from onto_compiler.record.table import NAN, Field, Record, same

__all__ = ["GRAPH", "OMITTED", "TYPE", "Column", "Row", "printed"]

GRAPH = "@graph"  # the term of a column that holds records and says nothing itself
TYPE = "@type"  # the term of a column that names the class of its record
OMITTED: Final = object()
"""The value of an optional column that its row does not have."""

Value = Callable[[Any, Any], Any]  # of what a row is about and the schema


@dataclass(frozen=True, slots=True)
class Column:
    """A column's type, term and value.

    ``kind`` is a JSON type, ``strings``, ``word:KIND`` (see :mod:`onto_compiler.emit.words`), ``words:KIND``,
    ``record:NAME``, ``list:NAME`` or ``rows:TYPE``, a list of lists.
    """

    kind: str
    value: Value
    term: str = ""  # IRI; empty if the vocabulary has no word for it
    null: bool = False
    reverse: bool = False  # the term leads from the value to the record
    blank: bool = False  # the empty string stands for none
    optional: bool = False  # not every record has it


@dataclass(frozen=True, slots=True)
class Row:
    """One kind of object. ``rules`` is what JSON Schema adds: ``signature``, ``arity``, ``route``."""

    about: str
    columns: Mapping[str, Column]
    rules: tuple[str, ...] = ()

    def of(self, subject: Any, names: Any = None) -> dict[str, Any]:  # noqa: ANN401 - whatever the columns look at
        """The object for ``subject``; ``names`` is the schema."""
        found = {name: column.value(subject, names) for name, column in self.columns.items()}
        return {name: value for name, value in found.items() if value is not OMITTED}

    def pick(self, *names: str) -> Row:
        """The row with these columns alone."""
        return Row(self.about, {name: self.columns[name] for name in names}, self.rules)


def printed(
    record: Record, *only: str, via: Callable[[Any], Any] = lambda subject: subject, null: bool = False
) -> dict[str, Column]:
    """A column for each field of ``record`` that JSON has, or for those named ``only``.

    ``via`` leads from what the row is about to the record, or to None; ``null``: it may be None.
    """
    shown = [field for field in record.fields if (field.name in only if only else field.key != "")]
    return {field.key or field.name: _column(field, via, null=null) for field in shown}


def _column(field: Field, via: Callable[[Any], Any], *, null: bool) -> Column:
    undefined = not field.needed and any(same(field.missing, nothing) for nothing in (None, "", NAN))
    iri = "" if field.form.json == "object" else field.term

    def value(subject: Any, names: Any) -> Any:  # noqa: ANN401 - of any field
        held = via(subject)
        found = None if held is None else getattr(held, field.name)
        return None if found is None or (undefined and found == "") else field.form.printed(found, names)

    return Column(field.form.json, value, iri, null=null or undefined)
