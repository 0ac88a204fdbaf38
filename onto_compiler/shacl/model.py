"""Compiled shapes, and the results of validation."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from pyoxigraph import NamedNode

from onto_compiler.problems import OntoError, Problem
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.paths import Path

__all__ = [
    "Check",
    "Custom",
    "Hit",
    "Nested",
    "PerValue",
    "Run",
    "Shape",
    "ShapeFault",
    "ShapeResult",
    "Shapes",
    "Target",
    "Whole",
]


class ShapeFault(OntoError):  # noqa: N818 - a fault in a shape, as OntoError one in any input
    """A shape that cannot run (SHP002): ``shape``, and the parameter and value of it that are at fault.

    ``inside`` is the character of the literal ``value`` that the fault begins at, and how many it covers.
    """

    def __init__(
        self,
        message: str,
        shape: Term,
        parameter: str = "",
        value: Term | None = None,
        *,
        code: str = "SHP002",
        hint: str = "",
        inside: tuple[int, int] | None = None,
    ) -> None:
        super().__init__(Problem("", 0, 0, code, "error", message, hint or f"see `onto explain {code}`"))
        self.shape, self.parameter, self.value, self.inside = shape, parameter, value, inside

    def same(self, other: ShapeFault) -> bool:
        """Whether the two are the same fault of the same shape."""
        return str(self) == str(other) and self.shape == other.shape

    @property
    def fields(self) -> tuple[str, str, str]:
        """Code, message and hint, before the fault is located."""
        problem = self.problems[0]
        if problem.code == "SHP002":
            return "SHP002", f"a shape cannot run: {problem.message}", "correct the shape; see `onto explain SHP002`"
        return problem.code, problem.message, problem.hint

    def __reduce__(self) -> tuple[type[OntoError], tuple[Problem, ...]]:
        """Pickle as the plain error: RDF terms stay in their process."""
        return (OntoError, self.problems)


@dataclass(frozen=True, slots=True)
class ShapeResult:
    """One ``sh:ValidationResult``. ``path`` is None for a node shape; our own shapes give ``code`` and ``hint``.

    ``expected`` says in words what the constraint asks for; ``message`` is what the shape's author wrote, if anything.
    """

    focus: Term
    path: Term | None
    value: Term | None
    component: str  # local name, e.g. "MinCountConstraintComponent", or the IRI of the user's own component
    shape: Term
    message: str = ""
    severity: str = "Violation"  # local name, or the IRI of the user's own severity
    code: str = ""
    hint: str = ""
    expected: str = ""


class Run(Protocol):
    """A validation under way, as a constraint sees it."""

    data: Graph
    shapes: Shapes

    def conforms(self, node: Term, shape: Term) -> bool:
        """Whether ``node`` has no result against ``shape``."""

    def results(self, shape: Shape, focus: Term) -> Iterator[ShapeResult]:
        """The results of one focus node against one shape."""

    def select(self, text: str, functions: Mapping[NamedNode, Callable[..., Any]]) -> Iterator[dict[str, Term]]:
        """The solutions of a SELECT over the data; an ASK gives one empty solution, or none."""


@dataclass(frozen=True, slots=True)
class Hit:
    """A violation as a constraint finds it; what it leaves open comes from its shape."""

    value: Term | None = None
    path: Term | None = None
    message: str = ""
    focus: Term | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PerValue:
    """A constraint that each value node meets by itself."""

    component: str
    test: Callable[[Run, Term], bool]
    expected: str


@dataclass(frozen=True, slots=True, eq=False)
class Whole:
    """A constraint on the value nodes together: ``find`` yields a violating value, or None if none is to blame."""

    component: str
    find: Callable[[Run, Term, Sequence[Term]], Iterable[Term | None]]
    expected: str


@dataclass(frozen=True, slots=True, eq=False)
class Custom:
    """A constraint whose hits say more than a value; ``node`` is its own, whose message and code go first."""

    component: str
    find: Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]
    expected: str
    message: str = ""
    code: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Nested:
    """``sh:property``: each value node is a focus node of ``shape``, whose results are passed on."""

    shape: Term


Check = PerValue | Whole | Custom | Nested


@dataclass(frozen=True, slots=True)
class Target:
    """``kind`` is ``node``, ``class``, ``subjects``, ``objects`` or ``query``, whose text is in ``query``."""

    kind: str
    term: Term
    query: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """A node or property shape, compiled; other shapes are referred to by their nodes."""

    iri: Term
    path_node: Term | None
    path: Path | None
    checks: tuple[Check, ...]
    targets: tuple[Target, ...] = ()
    deactivated: bool = False
    severity: str = "Violation"
    message: str = ""
    code: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Shapes:
    """``roots`` have targets; ``known`` holds them and every shape that they refer to."""

    roots: tuple[Shape, ...]
    known: Mapping[Term, Shape]
    graph: Graph
    functions: Mapping[NamedNode, Callable[..., Any]] = field(default_factory=dict)

    def only(self, nodes: Container[Term]) -> Shapes:
        """The same shapes, of which those of ``nodes`` alone look for their targets."""
        return replace(self, roots=tuple(shape for shape in self.roots if shape.iri in nodes))
