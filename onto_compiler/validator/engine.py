"""The Python forms of the implications for the SHACL engine, in the place of the queries that they stand for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from pyoxigraph import NamedNode

from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Check, Custom, Hit, Run, Shape, Shapes
from onto_compiler.shacl.reader import Reader
from onto_compiler.shacl.sparql import fill, sparql_custom
from onto_compiler.validator.implications import IMPLICATIONS, Implication, query_key

__all__ = ["with_implications"]

_COMPONENT = "SPARQLConstraintComponent"


def with_implications(shapes: Shapes) -> Shapes:
    """The same shapes; those whose every query has a Python form run it, some twenty times as fast as the query."""
    reader = Reader(shapes.graph)
    known = {name: _native(reader, shape) for name, shape in shapes.known.items()}
    return replace(shapes, known=known, roots=tuple(known[shape.iri] for shape in shapes.roots))


def _native(reader: Reader, shape: Shape) -> Shape:
    """``shape`` with Python forms in the place of all its queries, or as it is where one has none."""
    queries = [each for each in reader.values(shape.iri, "sparql") if not reader.is_true(each, "deactivated")]
    forms = [IMPLICATIONS.get(query_key(reader.text(each, "select"))) for each in queries]
    found = [_check(reader, each, form) for each, form in zip(queries, forms, strict=True) if form is not None]
    if shape.deactivated or not found or len(found) < len(forms):
        return shape
    others = (check for check in shape.checks if not isinstance(check, Custom) or check.component != _COMPONENT)
    return replace(shape, checks=(*others, *found))


def _check(reader: Reader, constraint: Term, implication: Implication) -> Check:
    message = reader.text(constraint, "message")

    def find(run: Run, focus: Term, _: Sequence[Term]) -> Iterator[Hit]:
        for row in implication(run.data, focus):
            path = row["path"]
            bound = {**row, "this": focus}
            yield Hit(row["value"], path if isinstance(path, NamedNode) else None, fill(message, bound), bound=bound)

    return sparql_custom(reader, constraint, find)
