"""A JSON-LD 1.1 context under which the records that commands print are statements in our vocabulary.

Records nest, so each field that holds records carries the context of what it holds; a word is an IRI only within the
field that it is a word of (``state`` is a level in one and a mode in another).
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from onto_compiler.emit.tbox import TBox
from onto_compiler.emit.words import words
from onto_compiler.rdf import XSD
from onto_compiler.record.described import described
from onto_compiler.record.rows import GRAPH, TYPE, Column, Row

__all__ = ["emit"]

Json = dict[str, Any]


def emit(tbox: TBox) -> str:
    """One context for all documents; a field without a term of the vocabulary is null, which leaves it out."""
    # Whole IRIs: a prefix such as `unit` would be taken for the field of that name.
    context: Json = {"@version": 1.1, **_merged(tbox, described().documents)}
    return json.dumps({"@context": context}, indent=2, ensure_ascii=False) + "\n"


def _merged(tbox: TBox, names: tuple[str, ...]) -> Json:
    """The definitions of every field of the named records; what two of them share is defined for both."""
    fields: dict[str, list[Column]] = {}
    for name, field in (pair for record in names for pair in _columns(described().rows[record])):
        fields.setdefault(name, []).append(field)
    merged = {name: _definition(tbox, name, same) for name, same in sorted(fields.items())}
    classes = [field for same in fields.values() for field in same if field.term == TYPE]
    return {**merged, **_iris(tbox, classes)}


def _iris(tbox: TBox, fields: list[Column]) -> Json:
    """The words of ``fields`` with their IRIs; the empty word stands for nothing."""
    kinds = [kind.partition(":")[2] for kind in (field.kind for field in fields) if kind.startswith("word")]
    return {word: iri for kind in kinds for word, iri in words(tbox, kind).items() if word}


def _columns(row: Row) -> Iterator[tuple[str, Column]]:
    for name, column in row.columns.items():
        yield name, column
        if column.term == GRAPH:
            yield from _columns(described().rows[column.kind.partition(":")[2]])


def _definition(tbox: TBox, name: str, fields: list[Column]) -> Any:  # noqa: ANN401 - a string, an object or null
    terms = {(field.term, field.reverse) for field in fields}
    if len(terms) > 1:
        raise ValueError(f"`{name}` states {sorted(term for term, _ in terms)} in one place")
    term, reverse = terms.pop()
    if not term:
        return None
    if term in {GRAPH, TYPE}:
        return term
    held = tuple(dict.fromkeys(f.kind.partition(":")[2] for f in fields if f.kind.startswith(("list:", "record:"))))
    definition: Json = {"@reverse" if reverse else "@id": term}
    known = _iris(tbox, fields)
    scope = {**_merged(tbox, held), **known}
    if known:
        definition["@type"] = "@vocab"
    elif fields[0].kind == "number":
        definition["@type"] = XSD + "double"
    if name == "arguments":
        definition["@container"] = "@list"
    if scope:
        definition["@context"] = scope
    return definition
