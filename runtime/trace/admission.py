"""What may enter a trace: every record is held to the shapes before anything is written."""

from __future__ import annotations

from collections.abc import Iterable

from pyoxigraph import NamedNode, Quad

from onto_compiler.problems import OntoError
from onto_compiler.rdf import shorten
from onto_compiler.shacl.graph import Term
from onto_compiler.validator.records import Validator, problem_of
from runtime.trace.names import RUNS

__all__ = ["refuse_invalid"]

_FEW = 20  # problems that are told; one wrong number repeats itself in every record after it


def refuse_invalid(validator: Validator, quads: Iterable[Quad]) -> None:
    """Hold every record that ``quads`` describe to the shapes.

    Raises:
        OntoError: one problem for each violation (the first twenty): the shape's code, the record, what was expected.
    """
    results = [result for result in validator.validate(quads) if result.severity == "Violation"]
    if results:
        raise OntoError(*(problem_of(result, validator.home(result.shape), _name) for result in results[:_FEW]))


def _name(term: Term) -> str:
    """A term in one word; a record by its place in its run."""
    return f"`{shorten(term.value).removeprefix(RUNS) if isinstance(term, NamedNode) else term.value}`"
