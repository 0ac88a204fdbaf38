"""The required ABox: the typed facts of a task (paper, section 3: A*_g = phi_req(g))."""

from __future__ import annotations

from dataclasses import dataclass

from onto_compiler.problems import Span
from onto_compiler.schema import local_name

__all__ = ["Entity", "Fact", "NativeAtom", "Precondition", "RequiredABox"]


@dataclass(frozen=True, slots=True)
class Entity:
    """An argument of a fact: the name that the scene knows (or a threshold's local name) and its class or own IRI."""

    name: str
    type: str


@dataclass(frozen=True, slots=True)
class NativeAtom:
    """The atom as the task file has it, which is what the native predicate tests."""

    predicate: str
    arguments: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.predicate}({', '.join(self.arguments)})"


@dataclass(frozen=True, slots=True)
class Fact:
    """One required assertion. ``threshold`` is the smallest margin that satisfies it (its unit the margin's)."""

    predicate: str  # IRI
    arguments: tuple[Entity, ...]
    native: NativeAtom
    grounded_by: str
    polarity: bool = True
    threshold: float = 0.0
    span: Span | None = None

    def __str__(self) -> str:
        text = f"{local_name(self.predicate)}({', '.join(a.name for a in self.arguments)})"
        return text if self.polarity else f"not {text}"


@dataclass(frozen=True, slots=True)
class Precondition:
    """A ``fact`` that must hold before others can be brought about through a controller."""

    fact: Fact
    before: tuple[int, ...]  # indices of the required facts that need it
    declared: str  # IRI of the core:Precondition that asks for it


@dataclass(frozen=True, slots=True)
class RequiredABox:
    """What a task requires. ``facts`` belong to the goal; ``premise`` must hold after settling (the task's ``:init``).

    Without ``alternatives`` all ``facts`` must hold at the end. Otherwise each alternative is a set of their indices,
    and the goal is reached where all facts of one alternative hold (the goal's disjunctive normal form).
    ``preconditions`` are empty until :func:`onto_compiler.bddl.conditions.with_preconditions` derives them.
    """

    task: str
    language: str
    problem: str
    facts: tuple[Fact, ...]
    premise: tuple[Fact, ...] = ()
    source: str = ""  # path of the task file
    alternatives: tuple[tuple[int, ...], ...] = ()
    preconditions: tuple[Precondition, ...] = ()

    @property
    def ways(self) -> tuple[tuple[int, ...], ...]:
        """The alternatives, or the one way to reach a goal without a choice: every fact."""
        return self.alternatives or (tuple(range(len(self.facts))),)
