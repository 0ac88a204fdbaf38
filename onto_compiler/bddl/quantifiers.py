"""A formula without quantifiers and implications: each variable becomes every declared instance of its category.

Removes ``Quantified``, ``Imply`` and question marks; introduces ``And``, ``Or`` and ``Not``. Ground atoms keep the span
of the atom that they come from. The meaning is that of BEHAVIOR's own evaluation (``bddl.condition_evaluation``):
``forn`` asks for exactly n, ``forpairs`` that as many instances of either category have a partner as there are of the
fewer, and an instance is never its own partner.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import comb
from typing import Final

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import And, Atom, Formula, Imply, Not, Or, Quantified, Symbol, TaskSpec, Variable
from onto_compiler.problems import Problem, Span, near

__all__ = ["MAX_ALTERNATIVES", "too_many", "unquantified"]

MAX_ALTERNATIVES: Final = 1024
"""The most alternatives that a goal may have, and that any step on the way to them may make."""
MAX_GROUND: Final = 50_000
"""The most ground atoms that the quantifiers of a goal may make."""
ANY: Final = "*"  # BEHAVIOR: `table.n.02_*` stands for as many more tables as the scene has

Scope = Mapping[str, str]


def unquantified(formula: Formula, spec: TaskSpec) -> tuple[Formula, tuple[Problem, ...]]:
    """``formula`` over the instances that ``spec`` declares, and what is wrong with its quantifiers."""
    grounder = _Grounder(spec)
    ground = grounder.formula(formula, {})
    return ground, tuple(dict.fromkeys(grounder.problems))


def too_many(span: Span) -> Problem:
    """The goal at ``span`` has more alternatives than are kept apart."""
    message = f"the goal has more than {MAX_ALTERNATIVES:,} alternatives"
    hint = "name the facts that must hold, or write one task for each way to reach the goal"
    return Problem.at(span, codes.TOO_MANY, message, hint)


@dataclass
class _Grounder:
    spec: TaskSpec
    problems: list[Problem] = field(default_factory=list)
    atoms: int = 0

    def formula(self, formula: Formula, scope: Scope) -> Formula:
        match formula:
            case Atom():
                return self.atom(formula, scope)
            case Not(part=part):
                return Not(self.formula(part, scope), formula.span)
            case And(parts=parts) | Or(parts=parts):
                return replace(formula, parts=tuple(self.formula(part, scope) for part in parts))
            case Imply(antecedent=antecedent, consequent=consequent):
                without = Not(self.formula(antecedent, scope), antecedent.span)
                return Or((without, self.formula(consequent, scope)), formula.span)
            case Quantified():
                return self.quantified(formula, scope)

    def atom(self, atom: Atom, scope: Scope) -> Atom:
        self.atoms += 1
        return replace(atom, arguments=tuple(self.symbol(symbol, scope) for symbol in atom.arguments))

    def symbol(self, symbol: Symbol, scope: Scope) -> Symbol:
        """What a name stands for: the variable's value, else the instance of that name."""
        name = symbol.name.strip("?")
        if name in scope:
            return Symbol(scope[name], symbol.span)
        if name != symbol.name and all(name != each.name for each in self.spec.declarations):
            message = f"nothing binds `{symbol.name}`, and no instance is called `{name}`"
            known = [f"?{bound}" for bound in scope] + [f"?{each.name}" for each in self.spec.declarations]
            self.problems.append(Problem.at(symbol.span, codes.UNBOUND_VARIABLE, message, near(symbol.name, known)))
            return symbol
        return Symbol(name, symbol.span)

    def quantified(self, formula: Quantified, scope: Scope) -> Formula:
        values = [self.instances(variable) for variable in formula.variables]
        names = [variable.name.strip("?") for variable in formula.variables]
        span = formula.span
        if not all(values):
            return And((), span)  # a problem has been noted
        if len(values) == 1:
            cases = [self.case(formula, {**scope, names[0]: value}) for value in values[0]]
            match formula.kind:
                case "forall":
                    return And(tuple(cases), span)
                case "exists":
                    return Or(tuple(cases), span)
                case _:
                    return self.exactly(formula.count or 0, cases, formula)
        grid = [
            [
                self.case(formula, {**scope, names[0]: first, names[1]: second}) if first != second else None
                for second in values[1]
            ]
            for first in values[0]
        ]
        return self.pairs(grid, formula)

    def case(self, formula: Quantified, scope: Scope) -> Formula:
        if self.atoms <= MAX_GROUND:
            ground = self.formula(formula.body, scope)
            if self.atoms <= MAX_GROUND:
                return ground
        if not any(problem.code == codes.TOO_MANY for problem in self.problems):
            self.problems.append(too_many(formula.span))
        return And((), formula.span)

    def exactly(self, count: int, cases: Sequence[Formula], formula: Quantified) -> Formula:
        span = formula.span
        if count > len(cases):
            self.problems.append(_too_few(formula, count, len(cases)))
            return And((), span)
        if comb(len(cases), count) > MAX_ALTERNATIVES:
            self.problems.append(too_many(span))
            return And((), span)
        return Or(
            tuple(
                And(tuple(case if i in chosen else Not(case, span) for i, case in enumerate(cases)), span)
                for chosen in map(frozenset, combinations(range(len(cases)), count))
            ),
            span,
        )

    def pairs(self, grid: Sequence[Sequence[Formula | None]], formula: Quantified) -> Formula:
        """Enough rows and enough columns of ``grid`` hold at least once."""
        rows = [tuple(case for case in row if case is not None) for row in grid]
        columns = [tuple(case for case in column if case is not None) for column in zip(*grid, strict=True)]
        fewest = min(len(rows), len(columns))
        # Of one category with itself, each instance has one partner fewer.
        count = min(len(rows), len(rows[0])) if formula.kind == "forpairs" else formula.count or 0
        if count > fewest or not all(rows) or not all(columns):
            self.problems.append(_too_few(formula, max(count, 1), fewest if all(rows) else 0))
            return And((), formula.span)
        return And((self.at_least(count, rows, formula), self.at_least(count, columns, formula)), formula.span)

    def at_least(self, count: int, groups: Sequence[tuple[Formula, ...]], formula: Quantified) -> Formula:
        """One of each group, for ``count`` of the groups."""
        span = formula.span
        if comb(len(groups), count) > MAX_ALTERNATIVES:
            self.problems.append(too_many(span))
            return And((), span)
        choices = tuple(And(tuple(Or(group, span) for group in chosen), span) for chosen in combinations(groups, count))
        return choices[0] if len(choices) == 1 else Or(choices, span)

    def instances(self, variable: Variable) -> tuple[str, ...]:
        """The declared instances of the variable's category."""
        declared = [each.name for each in self.spec.declarations if each.category == variable.category]
        if any(name.endswith(ANY) for name in declared):
            message = f"the scene decides how many `{variable.category}` there are, so `{variable.name}` has no end"
            hint = "number the instances instead of declaring them with `*`"
            self.problems.append(Problem.at(variable.span, codes.OPEN_CATEGORY, message, hint))
            return ()
        if not declared:
            message = f"no `{variable.category}` is declared, so `{variable.name}` stands for nothing"
            hint = near(variable.category, {each.category for each in self.spec.declarations})
            self.problems.append(Problem.at(variable.span, codes.EMPTY_QUANTIFIER, message, hint))
        return tuple(declared)


def _too_few(formula: Quantified, wanted: int, there: int) -> Problem:
    what = "pairs" if len(formula.variables) == 2 else "instances"
    message = f"`{formula.kind}` asks for {wanted} {what}, and {there} can be made of what is declared"
    return Problem.at(formula.span, codes.EMPTY_QUANTIFIER, message, "declare more instances, or ask for fewer")
