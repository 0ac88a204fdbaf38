"""Validates records as they are written, with the shapes of the shipped ontology and of the user's own Turtle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from pyoxigraph import NamedNode, Quad, Store, Triple

from onto_compiler.problems import OntoError, Problem, Span
from onto_compiler.rdf import shorten
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import Nested, Shape, ShapeFault, ShapeResult, Shapes
from onto_compiler.shacl.overlay import Overlay
from onto_compiler.shacl.severity import level
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.sources import collect, read_into
from onto_compiler.terms import sentence, show
from onto_compiler.validator.engine import with_implications
from ontology import turtle_files

__all__ = ["Validator", "compile_validator", "problem_of", "record_validator"]

NOWHERE = Span("")


@dataclass(frozen=True, slots=True)
class Validator:
    """Shapes over ``vocabulary``, what records rest on: classes, individuals, predicates, routes.

    The focus nodes are those that the statements describe or, where a shape targets objects, point to. What the
    vocabulary alone states of its own terms is for ``onto check``.
    """

    vocabulary: Graph
    shapes: Shapes

    def validate(self, statements: Iterable[Quad | Triple]) -> tuple[ShapeResult, ...]:
        """Every violation of every record that ``statements`` describe, each once, graph names aside.

        Raises:
            OntoError: SHP002 if a query cannot run or a shape follows a chain of nodes that is too long.

        """
        return tuple(dict.fromkeys(validate_graph(Overlay(self.vocabulary, statements), self.shapes)))

    def home(self, shape: Term) -> Term:
        """The targeted shape whose property shape ``shape`` is, however deep, or ``shape`` itself."""
        return next((root.iri for root in self.shapes.roots if shape in self._parts(root)), shape)

    def _parts(self, root: Shape) -> dict[Term, None]:
        found: dict[Term, None] = {}
        todo = [root.iri]
        while todo:
            one = todo.pop()
            if one not in found:
                found[one] = None
                todo += [check.shape for check in self.shapes.known[one].checks if isinstance(check, Nested)]
        return found


def compile_validator(
    vocabulary: Iterable[Quad | Triple],
    shapes: Iterable[Quad | Triple] | None = None,
    faults: list[ShapeFault] | None = None,
) -> Validator:
    """Compile the shapes that ``vocabulary`` holds, or those of ``shapes``. As for ``faults``, see ``compile_graph``.

    Raises:
        OntoError: SHP002 if a shape cannot run and no list is given.

    """
    known = Graph(vocabulary)
    compiled = compile_graph(known if shapes is None else Graph(shapes), faults)
    return Validator(known, with_implications(compiled))


def record_validator(ontology: Sequence[Path | str] = ()) -> Validator:
    """The shapes of the shipped ontology and of the user's own Turtle, compiled; once for the shipped one alone.

    Raises:
        OntoError: as :func:`onto_compiler.sources.load_store`; SHP002 if a shape cannot run.
    """
    # A person's files may change while the process lives, the shipped ones do not.
    return _read(ontology) if ontology else _shipped()


@lru_cache(maxsize=1)
def _shipped() -> Validator:
    return _read(())


def _read(extra: Sequence[Path | str]) -> Validator:
    """From files, whose literals count as they are spelled there; a store does not keep that."""
    written: list[Quad] = []
    store, problems, faults = Store(), list[Problem](), list[ShapeFault]()
    files = tuple(dict.fromkeys([*turtle_files(), *collect(extra)]))
    for path in files:
        problems += read_into(store, path, written=written)
    if problems:
        raise OntoError(*problems)
    validator = compile_validator(written, faults=faults)
    if faults:
        from onto_compiler.check.locate import locate  # noqa: PLC0415 - sound shapes need no places
        from onto_compiler.check.model import Model  # noqa: PLC0415
        from onto_compiler.check.run import fault_finding  # noqa: PLC0415

        raise OntoError(*locate(Model(store, files, written=tuple(written)), map(fault_finding, faults)))
    return validator


def _shape(node: Term) -> str:
    return f"the shape `{show(node)}`" if isinstance(node, NamedNode) else "a shape within it"


def problem_of(result: ShapeResult, home: Term, name: Callable[[Term], str], span: Span = NOWHERE) -> Problem:
    """What ``result`` states of a record as a problem at ``span``; ``name`` is how its terms are called.

    ``home`` is the shape to name (:meth:`Validator.home`).
    """
    expected = result.message or sentence(result.expected, show, _shape)
    if not result.message and isinstance(result.path, NamedNode):
        expected = f"violates `{shorten(result.path.value)}`: {expected}"
    found = f", and has {name(result.value)}" if result.value is not None and result.path is not None else ""
    shape = f" ({shorten(home.value)})" if isinstance(home, NamedNode) else ""
    hint = result.hint or "correct what made the record, or the shape; see `onto explain SHP001`"
    message = f"{name(result.focus)} {expected}{found}{shape}"
    return Problem.at(span, result.code or "SHP001", message, hint, level(result.severity))
