"""A goal formula as a list of literals: atoms, each wanted or unwanted, that must all come true.

Removes ``And``, ``Or`` and ``Not``. Negation is pushed inwards, so ``(Not (Or a b))`` is "neither a nor b"; what would
still be a choice afterwards, a disjunction or a negated conjunction, is a problem.
"""

from __future__ import annotations

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import And, Atom, Formula, Not, Or
from onto_compiler.problems import Problem

__all__ = ["literals"]


def literals(goal: Formula) -> tuple[tuple[tuple[Atom, bool], ...], tuple[Problem, ...]]:
    """The (atom, polarity) pairs of ``goal`` in file order, and the problems that were found."""
    found: list[tuple[Atom, bool]] = []
    problems: list[Problem] = []
    _collect(goal, True, found, problems)
    return tuple(found), tuple(problems)


def _collect(formula: Formula, polarity: bool, found: list[tuple[Atom, bool]], problems: list[Problem]) -> None:  # noqa: FBT001 - a literal is an atom and its polarity
    match formula:
        case Atom():
            found.append((formula, polarity))
        case Not(part=part):
            _collect(part, not polarity, found, problems)
        case And(parts=()) | Or(parts=()):
            word = type(formula).__name__
            message = f"`({word})` joins nothing, so the goal asks for nothing"
            problems.append(Problem.at(formula.span, codes.EMPTY_GOAL, message, "name the facts that shall hold"))
        case And(parts=parts) | Or(parts=parts):
            if len(parts) > 1 and isinstance(formula, And) != polarity:
                problems.append(_choice(formula))
                return
            for part in parts:
                _collect(part, polarity, found, problems)


def _choice(formula: And | Or) -> Problem:
    if isinstance(formula, Or):
        message, hint = "disjunctive goals are not supported yet", "write one task for each alternative"
    else:
        message = "disjunctive goals are not supported yet, and a negated `And` is one: any of its parts may fail"
        hint = "negate the facts one by one, or use (Not (Or ...)) if none of them may hold"
    return Problem.at(formula.span, codes.DISJUNCTION, message, hint)
