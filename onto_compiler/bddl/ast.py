"""The syntax tree of a task file.

Two trees are equal when they say the same: spans and the file's path take no part in the comparison. Names of objects,
fixtures, regions and categories are in lower case, which is how LIBERO reads them (``bddl.parsing.scan_tokens``);
predicates, the problem's name and the instruction stay as they were written.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from onto_compiler.problems import Span

__all__ = ["And", "Atom", "Declaration", "Formula", "Not", "Or", "Region", "Symbol", "TaskSpec", "atoms"]

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


Formula: TypeAlias = Atom | And | Or | Not


@dataclass(frozen=True, slots=True)
class TaskSpec:
    """A whole task file. ``language`` is the instruction, single-spaced; ``scene`` pairs a property with its value."""

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
    file: str = field(default="", compare=False)
    span: Span = field(default=NOWHERE, compare=False)
    domain_span: Span = field(default=NOWHERE, compare=False)

    @property
    def declarations(self) -> tuple[Declaration, ...]:
        """Fixtures, then objects."""
        return (*self.fixtures, *self.objects)


def atoms(formula: Formula) -> tuple[Atom, ...]:
    """The atoms of ``formula`` in file order, whatever connects them."""
    match formula:
        case Atom():
            return (formula,)
        case Not(part=part):
            return atoms(part)
        case And(parts=parts) | Or(parts=parts):
            return tuple(atom for part in parts for atom in atoms(part))
