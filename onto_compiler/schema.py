"""The compiled TBox: what :mod:`onto_compiler.compile_schema` reads out of Turtle, as immutable Python.

IRIs are plain strings. Where a table is ordered, the order is part of the meaning (bindings are tried first to last).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = [
    "Binding",
    "JointThreshold",
    "PreconditionRule",
    "PredicateSignature",
    "Route",
    "Schema",
    "Score",
    "ScoreTerm",
    "local_name",
]


def local_name(iri: str) -> str:
    """The part of an IRI after its last ``#`` or ``/``."""
    return re.split(r"[#/]", iri)[-1]


@dataclass(frozen=True, slots=True)
class PredicateSignature:
    """A typed predicate: ``name`` is its ``skos:notation``; ``parameters`` holds one class IRI per argument."""

    iri: str
    name: str
    kind: str  # the subclass of core:Predicate that routes and rules speak of
    parameters: tuple[str, ...]
    margin_unit: str | None  # a QUDT unit IRI; None if no continuous margin is defined
    grounded_by: str | None  # the registered name of the function that grounds it, unless its binding names another
    definition: str = ""
    acyclic: bool = False  # with the others of this kind: nothing stands in it to itself, not even by way of others
    tolerance: float | None = None  # what its margin is counted from, in the margin's unit; None if it has none
    moves: int | None = None  # the argument (from 0) that is moved to bring a fact about; None if none is


@dataclass(frozen=True, slots=True)
class JointThreshold:
    """When a joint counts as open, closed, on or off: ``qpos`` above or below ``bound`` (radians or metres)."""

    iri: str
    category: str  # the asset category whose joints it speaks of
    native: str  # the native predicate that it serves, e.g. "Open"
    above: bool
    bound: float
    inclusive: bool
    every_joint: bool  # True: all joints must pass; False: any
    unit: str


@dataclass(frozen=True, slots=True)
class Binding:
    """Lifts a native atom to a typed predicate, when the atom's argument types (and region name) match."""

    iri: str
    native: str
    arguments: tuple[str, ...]  # class IRI of each native argument
    lifts: str  # predicate IRI
    grounded_by: str
    order: int
    landmark: re.Pattern[str] | None = None  # on the region's name; its group "landmark" names the second argument
    threshold: bool = False  # the second argument is the category's JointThreshold
    premise_grounded_by: str | None = None  # what grounds the atom in :init, where that differs
    premise_tolerance: float = 0.0  # how far below zero the margin of an initial fact may lie after settling
    domain: str = ""  # the task domain whose predicate is meant; empty: LIBERO's
    goal_margin: float = 0.0  # the smallest margin that satisfies a goal's fact


@dataclass(frozen=True, slots=True)
class PreconditionRule:
    """A declared precondition: which facts need it, and which atom of the task language it is.

    The atom is ``native(argument)``; with ``others`` it is ``native(other, argument)`` for each other instance of that
    class. The argument is the fact's ``argument``-th (from 0) if it is of ``argument_class``, or else what it is a
    region of.
    """

    iri: str
    precedes: frozenset[str]  # predicates, or kinds of predicates
    argument: int
    argument_class: str
    native: str
    must_hold: bool = True
    others: str | None = None
    extends: frozenset[str] = frozenset()  # predicates, or kinds, that need it too of what such a fact places


@dataclass(frozen=True, slots=True)
class Route:
    """A declared correction route: a dispatch label, not a robot action."""

    iri: str
    name: str
    level: str  # "plan" | "state" | "action"
    admits: frozenset[str]  # failure classes
    supports: frozenset[str]  # kinds of predicate
    on_rejection: str | None = None


@dataclass(frozen=True, slots=True)
class ScoreTerm:
    """``weight`` (0 or more) of a field's IRI, for the facts of one predicate where the field is of facts."""

    field: str
    weight: float
    predicate: str | None = None


@dataclass(frozen=True, slots=True)
class Score:
    """A weighted sum by which predicted plans are compared. ``name`` is its ``skos:notation``."""

    iri: str
    name: str
    terms: tuple[ScoreTerm, ...]


@dataclass(frozen=True, slots=True)
class Schema:
    """Everything that the rest of the system needs to know of the ontology."""

    classes: Mapping[str, frozenset[str]]  # class IRI -> the class and all its superclasses
    predicates: Mapping[str, PredicateSignature]
    failures: Mapping[str, int]  # failure class IRI -> priority, the smaller the sooner
    routes: Mapping[str, Route]
    bindings: tuple[Binding, ...]
    thresholds: Mapping[tuple[str, str], JointThreshold]  # (category, native predicate)
    categories: Mapping[str, str]  # asset category -> class IRI
    regions: Mapping[tuple[str, str], str]  # (category of the target, region name) -> class IRI
    defaults: Mapping[str, str]  # "object" | "fixture" | "region" | "workspace_region" -> class IRI
    labels: Mapping[str, str] = field(default_factory=dict)
    preconditions: tuple[PreconditionRule, ...] = ()
    notations: Mapping[str, str] = field(default_factory=dict)  # term IRI -> its short name in records and JSON
    scores: Mapping[str, Score] = field(default_factory=dict)  # by name
    symbols: Mapping[str, str] = field(default_factory=dict)  # IRI of a unit -> its ``qudt:symbol``

    def is_a(self, cls: str, ancestor: str) -> bool:
        """Whether class ``cls`` is ``ancestor`` or one of its subclasses."""
        return ancestor in self.classes.get(cls, frozenset((cls,)))

    def symbol(self, unit: str) -> str:
        """How the unit of this IRI is written, or its local name where the ontology does not say."""
        return self.symbols.get(unit, local_name(unit))

    def threshold(self, iri: str) -> JointThreshold | None:
        """The joint threshold whose IRI is ``iri``."""
        return next((found for found in self.thresholds.values() if found.iri == iri), None)

    def predicate_named(self, name: str) -> PredicateSignature | None:
        """The predicate whose notation is ``name``, compared without case."""
        folded = name.casefold()
        return next((p for p in self.predicates.values() if p.name.casefold() == folded), None)
