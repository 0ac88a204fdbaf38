"""What may enter a trace: every record is held to the shapes before anything is written."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path

from pyoxigraph import NamedNode, Quad, Store

from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import shorten
from onto_compiler.shapes import ShapeResult
from onto_compiler.sources import collect, read_into
from onto_compiler.validator.compile import compile_validator
from onto_compiler.validator.facts import Term
from onto_compiler.validator.validator import Validator
from ontology import turtle_files
from runtime.trace.names import RUNS

__all__ = ["record_validator", "refuse_invalid"]

_FEW = 20  # problems that are told; one wrong number repeats itself in every record after it


def record_validator(ontology: Sequence[Path | str] = ()) -> Validator:
    """The shapes of the shipped ontology and of a person's own Turtle, compiled; once for the shipped one alone.

    Raises:
        OntoError: as :func:`onto_compiler.sources.load_store`; SHP002, where a shape cannot run.
    """
    # A person's files may change while the process lives, the shipped ones do not.
    return compile_validator(_written(ontology)) if ontology else _shipped()


@lru_cache(maxsize=1)
def _shipped() -> Validator:
    return compile_validator(_written(()))


def _written(extra: Sequence[Path | str]) -> list[Quad]:
    """The statements of the ontology with literals as the files spell them, which a store does not keep."""
    written: list[Quad] = []
    store, problems = Store(), []
    for path in dict.fromkeys([*turtle_files(), *collect(extra)]):
        problems += read_into(store, path, written=written)
    if problems:
        raise OntoError(*problems)
    return written


def refuse_invalid(validator: Validator, quads: Iterable[Quad]) -> None:
    """Hold every record that ``quads`` describe to the shapes.

    Raises:
        OntoError: one problem for each violation (the first twenty): the shape's code, the record, what was expected.
    """
    results = [result for result in validator.validate(quads) if result.severity == "Violation"]
    if results:
        raise OntoError(*(_problem(result, validator.home(result.shape)) for result in results[:_FEW]))


def _problem(result: ShapeResult, home: Term) -> Problem:
    expected = result.message or f"violates {result.component.removesuffix('ConstraintComponent')}"
    found = f", and has {_name(result.value)}" if result.value is not None and result.path is not None else ""
    shape = f" ({shorten(home.value)})" if isinstance(home, NamedNode) else ""
    hint = result.hint or "correct what made the record, or the shape; see `onto explain SHP001`"
    message = f"{_name(result.focus)} {expected}{found}{shape}"
    return Problem("", 0, 0, result.code or "SHP001", "error", message, hint)


def _name(term: Term) -> str:
    """A term in one word; a record by its place in its run."""
    return f"`{shorten(term.value).removeprefix(RUNS) if isinstance(term, NamedNode) else term.value}`"
