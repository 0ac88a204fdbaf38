"""A goal as literals: atoms, each wanted or unwanted, and the alternative sets of them that reach it.

Removes ``And``, ``Or`` and ``Not``. Negation is pushed inwards, so ``(Not (Or a b))`` is "neither a nor b". A goal
without a choice keeps its atoms in file order, whatever they repeat. Any other becomes a disjunction of conjunctions
(its disjunctive normal form): a conjunction that holds both an atom and its negation is dropped, and so is one that
contains another.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import And, Atom, Formula, Not, Or, TaskSpec
from onto_compiler.bddl.quantifiers import MAX_ALTERNATIVES, too_many, unquantified
from onto_compiler.problems import Problem

__all__ = ["GoalLiterals", "Literal", "goal_of"]

MAX_STEPS: Final = 8_000_000
"""The most comparisons of conjunctions that a goal may cost: about a second."""
Literal = tuple[Atom, bool]


@dataclass(frozen=True, slots=True)
class GoalLiterals:
    """``literals`` in file order; ``alternatives`` are sets of their indices, of which one must hold whole.

    Without ``alternatives`` all ``literals`` must hold.
    """

    literals: tuple[Literal, ...]
    alternatives: tuple[tuple[int, ...], ...] = ()

    @property
    def ways(self) -> tuple[tuple[Literal, ...], ...]:
        """Every way to reach the goal as the literals that it takes."""
        if not self.alternatives:
            return (self.literals,)
        return tuple(tuple(self.literals[i] for i in way) for way in self.alternatives)


def goal_of(spec: TaskSpec) -> tuple[GoalLiterals, tuple[Problem, ...]]:
    """The literals and alternatives of the goal of ``spec``, and the problems that were found.

    Where there are problems, the literals are those that could be read.
    """
    formula, problems = unquantified(spec.goal, spec)
    if problems:
        return GoalLiterals(tuple(_found(formula, True))), problems
    empty = tuple(_empty(formula))
    if empty:
        return GoalLiterals(tuple(_found(formula, True))), empty
    if _without_choice(formula, True):
        return GoalLiterals(tuple(_found(formula, True))), ()
    table = _Table()
    terms = table.terms(formula, True)
    if terms is None:
        return GoalLiterals(tuple(_found(formula, True))), (too_many(spec.goal.span),)
    if not terms:
        message = "no alternative of the goal can hold: each asks for a fact and for its absence"
        return GoalLiterals(tuple(_found(formula, True))), (Problem.at(spec.goal.span, codes.CONTRADICTION, message),)
    return table.goal(terms), ()


def _found(formula: Formula, polarity: bool) -> list[Literal]:  # noqa: FBT001 - a literal is an atom and its polarity
    match formula:
        case Atom():
            return [(formula, polarity)]
        case Not(part=part):
            return _found(part, not polarity)
        case And(parts=parts) | Or(parts=parts):
            return [literal for part in parts for literal in _found(part, polarity)]
        case _:
            raise TypeError(f"{type(formula).__name__} is left in a goal without quantifiers")


def _empty(formula: Formula) -> list[Problem]:
    """A problem for each connective that joins nothing."""
    match formula:
        case Not(part=part):
            return _empty(part)
        case And(parts=()) | Or(parts=()):
            word = type(formula).__name__
            message = f"`({word})` joins nothing, so the goal asks for nothing"
            return [Problem.at(formula.span, codes.EMPTY_GOAL, message, "name the facts that must hold")]
        case And(parts=parts) | Or(parts=parts):
            return [problem for part in parts for problem in _empty(part)]
        case _:
            return []


def _without_choice(formula: Formula, polarity: bool) -> bool:  # noqa: FBT001 - as above
    match formula:
        case Not(part=part):
            return _without_choice(part, not polarity)
        case And(parts=parts) | Or(parts=parts):
            return (len(parts) == 1 or isinstance(formula, And) == polarity) and all(
                _without_choice(part, polarity) for part in parts
            )
        case _:
            return True


@dataclass
class _Table:
    """Numbers literals: bit 2i of a term is atom i, and bit 2i + 1 its negation."""

    numbers: dict[tuple[str, tuple[str, ...]], int] = field(default_factory=dict)
    atoms: list[Atom] = field(default_factory=list)
    steps: int = 0  # comparisons so far

    def number(self, atom: Atom) -> int:
        # Predicates are read without regard to case.
        key = (atom.predicate.casefold(), tuple(symbol.name for symbol in atom.arguments))
        number = self.numbers.setdefault(key, len(self.atoms))
        if number == len(self.atoms):
            self.atoms.append(atom)
        return number

    def terms(self, formula: Formula, polarity: bool) -> list[int] | None:  # noqa: FBT001 - as above
        """The conjunctions of ``formula``, none of which holds another; None if there are too many."""
        match formula:
            case Atom():
                return [1 << (2 * self.number(formula) + (not polarity))]
            case Not(part=part):
                return self.terms(part, not polarity)
            case And(parts=parts) | Or(parts=parts) if isinstance(formula, And) != polarity:
                union: set[int] = set()
                for part in parts:
                    terms = self.terms(part, polarity)
                    if terms is None:
                        return None
                    union.update(terms)
                return self.least(union)
            case _:
                return self.with_all([0], formula, polarity)

    def with_all(self, terms: list[int] | None, formula: Formula, polarity: bool) -> list[int] | None:  # noqa: FBT001 - as above
        """Each of ``terms`` with what ``formula`` takes. Nested conjunctions are taken up one part after the other."""
        match formula:
            case And(parts=parts) | Or(parts=parts) if isinstance(formula, And) == polarity:
                for part in parts:
                    terms = self.with_all(terms, part, polarity)
                return terms
            case Not(part=part):
                return self.with_all(terms, part, not polarity)
            case _:
                more = self.terms(formula, polarity) if terms is not None else None
                return None if terms is None or more is None else self.both(terms, more)

    def both(self, left: Sequence[int], right: Sequence[int]) -> list[int] | None:
        """Each of ``left`` with each of ``right``; None if there are too many."""
        self.steps += len(left) * len(right)
        if self.steps > MAX_STEPS:
            return None
        if any(term.bit_count() > 1 for term in right):
            return self.least({one | other for one in left for other in right if _possible(one | other)})
        # What holds one of `right` already needs nothing more, and only that can lie within an extended term.
        mask = sum(right)
        kept = [term for term in left if term & mask]
        extended = [term | bit for term in left if not term & mask for bit in right]
        self.steps += len(kept) * len(extended)
        if self.steps > MAX_STEPS:
            return None
        kept += [term for term in extended if _possible(term) and not any(term & less == less for less in kept)]
        return kept if len(kept) <= MAX_ALTERNATIVES else None

    def least(self, terms: set[int]) -> list[int] | None:
        """Those that hold no other, the smaller first; None if there are too many."""
        result: list[int] = []
        for term in sorted(terms, key=lambda term: (term.bit_count(), term)):
            self.steps += len(result)
            if len(result) > MAX_ALTERNATIVES or self.steps > MAX_STEPS:
                return None
            if not any(term & less == less for less in result):
                result.append(term)
        return result if len(result) <= MAX_ALTERNATIVES else None

    def goal(self, terms: Sequence[int]) -> GoalLiterals:
        """The terms as indices of literals, each literal once and in the order of the file."""
        used = sorted({bit for term in terms for bit in _bits(term)})
        place = {bit: index for index, bit in enumerate(used)}
        literals = tuple((self.atoms[bit // 2], bit % 2 == 0) for bit in used)
        if len(terms) == 1:
            return GoalLiterals(literals)
        return GoalLiterals(literals, tuple(sorted(tuple(place[bit] for bit in _bits(term)) for term in terms)))


def _bits(term: int) -> list[int]:
    return [bit for bit in range(term.bit_length()) if term >> bit & 1]


def _possible(term: int) -> bool:
    """Whether no atom is both wanted and unwanted."""
    positive = int("01" * ((term.bit_length() + 1) // 2 or 1), 2)
    return not (term & positive) & (term >> 1 & positive)
