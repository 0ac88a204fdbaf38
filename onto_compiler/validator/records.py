"""The shapes that records are held to: those of the shipped ontology, and of a person's own Turtle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path

from pyoxigraph import NamedNode, Quad, Store

from onto_compiler.problems import OntoError, Problem, Span
from onto_compiler.rdf import shorten
from onto_compiler.shapes import ShapeResult
from onto_compiler.sources import collect, read_into
from onto_compiler.validator.compile import compile_validator
from onto_compiler.validator.facts import Term
from onto_compiler.validator.validator import Validator
from ontology import turtle_files

__all__ = ["problem_of", "record_validator"]

NOWHERE = Span("")


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


def problem_of(result: ShapeResult, home: Term, name: Callable[[Term], str], span: Span = NOWHERE) -> Problem:
    """What ``result`` says of a record as a problem at ``span``; ``name`` is how its terms are called.

    ``home`` is the shape to name (:meth:`~onto_compiler.validator.validator.Validator.home`).
    """
    expected = result.message or f"violates {result.component.removesuffix('ConstraintComponent')}"
    found = f", and has {name(result.value)}" if result.value is not None and result.path is not None else ""
    shape = f" ({shorten(home.value)})" if isinstance(home, NamedNode) else ""
    hint = result.hint or "correct what made the record, or the shape; see `onto explain SHP001`"
    severity = "error" if result.severity == "Violation" else "warning"
    return Problem.at(span, result.code or "SHP001", f"{name(result.focus)} {expected}{found}{shape}", hint, severity)
