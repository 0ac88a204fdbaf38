"""Compiled shapes, and the results of validation."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from pyoxigraph import Literal, NamedNode

from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import SH
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.paths import Path
from onto_compiler.shacl.prebinding import Query
from onto_compiler.terms import Sentence

__all__ = [
    "Annotation",
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
    "note",
    "noting",
]


_HINT = "correct the shape; see `onto explain {}`"


class ShapeFault(OntoError):  # noqa: N818 - a fault in a shape, as OntoError one in any input
    """A shape that cannot run (SHP002): ``shape``, and the parameter and value of it that are at fault.

    ``parameter`` is a local name of SHACL's namespace, or the IRI of another property.
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
        severity: str = "error",
    ) -> None:
        super().__init__(Problem("", 0, 0, code, severity, message, hint or _HINT.format(code)))
        self.shape, self.parameter, self.value, self.inside = shape, parameter, value, inside

    def same(self, other: ShapeFault) -> bool:
        """Whether the two are the same fault of the same shape."""
        return str(self) == str(other) and self.shape == other.shape

    @property
    def predicate(self) -> NamedNode | None:
        """The parameter as a term; None where the shape as a whole is at fault."""
        if not self.parameter:
            return None
        return NamedNode(self.parameter if ":" in self.parameter else SH + self.parameter)

    @property
    def fields(self) -> tuple[str, str, str]:
        """Code, message and hint, before the fault is located."""
        problem = self.problems[0]
        if problem.code == "SHP002":
            hint = problem.hint if "onto explain" in problem.hint else f"{problem.hint}; see `onto explain SHP002`"
            said = problem.message if " cannot run: " in problem.message else f"a shape cannot run: {problem.message}"
            return "SHP002", said, hint
        return problem.code, problem.message, problem.hint

    def __reduce__(self) -> tuple[type[OntoError], tuple[Problem, ...]]:
        """Pickle as the plain error: RDF terms stay in their process."""
        return (OntoError, self.problems)


def note(fault: ShapeFault, faults: list[ShapeFault]) -> None:
    """Append a fault, once."""
    if not any(fault.same(other) for other in faults):
        faults.append(fault)


@contextmanager
def noting(faults: list[ShapeFault] | None) -> Iterator[None]:
    """Let ``faults`` take the fault of a part that cannot run, which is then left out; without a list it is raised."""
    try:
        yield
    except ShapeFault as fault:
        if faults is None:
            raise
        note(fault, faults)


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
    expected: Sentence = ""
    messages: tuple[Literal, ...] = ()  # what the author wrote, in every language
    constraint: Term | None = None  # a ``sh:sparql`` constraint of the shape
    annotations: tuple[tuple[NamedNode, Term], ...] = ()  # properties of the result (``sh:resultAnnotation``)


class Run(Protocol):
    """A validation under way, as a constraint sees it."""

    data: Graph
    shapes: Shapes

    def conforms(self, node: Term, shape: Term) -> bool:
        """Whether ``node`` has no result against ``shape``."""

    def results(self, shape: Shape, focus: Term) -> Iterator[ShapeResult]:
        """The results of one focus node against one shape."""

    def select(self, query: Query, given: Mapping[str, Term]) -> Iterator[dict[str, Term]]:
        """The solutions of a SELECT over the data; an ASK gives one empty solution, or none."""


@dataclass(frozen=True, slots=True)
class Hit:
    """A violation as a constraint finds it; what it leaves open comes from its shape."""

    value: Term | None = None
    path: Term | None = None
    message: str = ""
    focus: Term | None = None
    bound: Mapping[str, Term] = field(default_factory=dict)  # what a query binds, for messages and annotations


@dataclass(frozen=True, slots=True)
class Annotation:
    """``sh:resultAnnotation``: results have ``property`` with what the query binds to ``name``, or else ``values``."""

    property: NamedNode
    name: str
    values: tuple[Term, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class PerValue:
    """A constraint that each value node meets by itself."""

    component: str
    test: Callable[[Run, Term], bool]
    expected: Sentence


@dataclass(frozen=True, slots=True, eq=False)
class Whole:
    """A constraint on the value nodes together: ``find`` yields a violating value, or None if none is to blame."""

    component: str
    find: Callable[[Run, Term, Sequence[Term]], Iterable[Term | None]]
    expected: Sentence


@dataclass(frozen=True, slots=True, eq=False)
class Custom:
    """A constraint whose hits say more than a value; ``node`` is its own, whose message and code go first."""

    component: str
    find: Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]
    expected: Sentence
    message: str = ""
    code: str = ""
    hint: str = ""
    messages: tuple[Literal, ...] = ()
    node: Term | None = None
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Nested:
    """``sh:property``: each value node is a focus node of ``shape``, whose results are passed on."""

    shape: Term


Check = PerValue | Whole | Custom | Nested


@dataclass(frozen=True, slots=True)
class Target:
    """``kind`` is ``node``, ``class``, ``subjects``, ``objects`` or ``query``, which is asked with ``given``."""

    kind: str
    term: Term
    query: Query | None = None
    given: Mapping[str, Term] = field(default_factory=dict, compare=False)


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
    messages: tuple[Literal, ...] = ()


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
