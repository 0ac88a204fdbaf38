"""The syntax tree of a task file.

Two trees are equal when they say the same: spans and the file's path take no part in the comparison. Names of objects,
fixtures, regions and categories are in lower case, which is how LIBERO reads them (``bddl.parsing.scan_tokens``);
predicates, the problem's name and the instruction stay as they were written.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from onto_compiler.problems import Problem, Span

__all__ = [
    "And",
    "Atom",
    "Declaration",
    "Domain",
    "Formula",
    "Imply",
    "Not",
    "Or",
    "Quantified",
    "Region",
    "Symbol",
    "TaskSpec",
    "Variable",
    "atoms",
]

NOWHERE = Span("")


@dataclass(frozen=True, slots=True)
class Symbol:
    """A name, where it is used."""

    name: str
    span: Span = field(default=NOWHERE, compare=False)

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True, slots=True)
class Declaration:
    """An object or a fixture; ``category`` is the asset that it is an instance of."""

    name: str
    category: str
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Region:
    """A place on or in ``target``.

    ``ranges`` are rectangles (x0, y0, x1, y1) in metres in the target's frame; ``yaw`` bounds the yaw of what is put
    there, in radians; ``rgba`` is the colour that the region is drawn in.
    """

    name: str
    target: Symbol
    ranges: tuple[tuple[float, float, float, float], ...] = ()
    yaw: tuple[float, float] | None = None
    rgba: tuple[float, float, float, float] | None = None
    span: Span = field(default=NOWHERE, compare=False)
    yaw_span: Span = field(default=NOWHERE, compare=False)

    @property
    def site(self) -> str:
        """The name that LIBERO gives the region's site, and atoms use (``bddl_utils.get_regions``)."""
        return f"{self.target.name}_{self.name}"


@dataclass(frozen=True, slots=True)
class Atom:
    """A predicate over names. ``name_span`` is the place of the predicate's name, ``span`` that of the whole atom."""

    predicate: str
    arguments: tuple[Symbol, ...]
    span: Span = field(default=NOWHERE, compare=False)
    name_span: Span = field(default=NOWHERE, compare=False)

    def __str__(self) -> str:
        return f"({' '.join((self.predicate, *map(str, self.arguments)))})"


@dataclass(frozen=True, slots=True)
class And:
    """All of ``parts`` hold."""

    parts: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Or:
    """At least one of ``parts`` holds."""

    parts: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Not:
    """``part`` does not hold."""

    part: Formula
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Imply:
    """Where ``antecedent`` holds, so does ``consequent``."""

    antecedent: Formula
    consequent: Formula
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Variable:
    """A name, with its question mark, that stands for each declared instance of ``category`` in turn."""

    name: str
    category: str
    span: Span = field(default=NOWHERE, compare=False)


@dataclass(frozen=True, slots=True)
class Quantified:
    """``body`` for some of the values of ``variables``; ``kind`` says for which, and ``count`` for how many.

    ``forall``, ``exists`` and ``forn`` (exactly ``count``) bind one variable, ``forpairs`` (as many of each as there
    are of the fewer) and ``fornpairs`` (at least ``count`` of each) bind two.
    """

    kind: str
    variables: tuple[Variable, ...]
    body: Formula
    count: int | None = None
    span: Span = field(default=NOWHERE, compare=False)


Formula: TypeAlias = Atom | And | Or | Not | Imply | Quantified


@dataclass(frozen=True, slots=True)
class TaskSpec:
    """A whole task file. ``language`` is the instruction, single-spaced; ``scene`` pairs a property with its value.

    ``init`` holds at the start, and ``absent`` does not.
    """

    problem: str
    domain: str
    language: str
    regions: tuple[Region, ...]
    fixtures: tuple[Declaration, ...]
    objects: tuple[Declaration, ...]
    interest: tuple[Symbol, ...]
    init: tuple[Atom, ...]
    goal: Formula
    requirements: tuple[str, ...] = ()
    scene: tuple[tuple[str, str], ...] = ()
    absent: tuple[Atom, ...] = ()
    file: str = field(default="", compare=False)
    span: Span = field(default=NOWHERE, compare=False)
    domain_span: Span = field(default=NOWHERE, compare=False)
    language_span: Span = field(default=NOWHERE, compare=False)
    passed_over: tuple[Problem, ...] = field(default=(), compare=False)  # what was read past, as warnings

    @property
    def declarations(self) -> tuple[Declaration, ...]:
        """Fixtures, then objects."""
        return (*self.fixtures, *self.objects)


@dataclass(frozen=True, slots=True)
class Domain:
    """A domain file: each predicate's name with the number of its arguments."""

    name: str
    predicates: tuple[tuple[str, int], ...]
    requirements: tuple[str, ...] = ()
    types: tuple[str, ...] = ()
    file: str = field(default="", compare=False)


def atoms(formula: Formula) -> tuple[Atom, ...]:
    """The atoms of ``formula`` in file order, whatever connects them."""
    match formula:
        case Atom():
            return (formula,)
        case Not(part=part) | Quantified(body=part):
            return atoms(part)
        case Imply(antecedent=antecedent, consequent=consequent):
            return (*atoms(antecedent), *atoms(consequent))
        case And(parts=parts) | Or(parts=parts):
            return tuple(atom for part in parts for atom in atoms(part))
