"""Goals that cannot hold, hold already, or repeat themselves. Findings are warnings.

A goal with alternatives is reported if each of them is at fault; repetitions only in goals without alternatives, since
alternatives share facts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from onto_compiler.bddl import codes
from onto_compiler.bddl.ast import Atom, TaskSpec
from onto_compiler.bddl.dialects import Dialect, dialect_of
from onto_compiler.bddl.literals import GoalLiterals, Literal
from onto_compiler.problems import Problem

__all__ = ["lint_goal"]

Way: TypeAlias = tuple[Literal, ...]
Key: TypeAlias = tuple[str, tuple[str, ...]]


def lint_goal(spec: TaskSpec, goal: GoalLiterals) -> tuple[Problem, ...]:
    """Warnings on the goal of ``spec``."""
    dialect = dialect_of(spec.domain)
    found = [] if goal.alternatives else list(_repeated(goal.literals))
    checks: tuple[Callable[[Way, Dialect], Iterator[Problem]], ...] = (_contradicted, _opposed, _supported, _itself)
    for check in checks:
        each = [list(check(way, dialect)) for way in goal.ways]
        if all(each):
            found += each[0]
    found += _already(spec, goal)
    return tuple(dict.fromkeys(found))


def _key(atom: Atom) -> Key:
    return atom.predicate.lower(), tuple(symbol.name for symbol in atom.arguments)


def _repeated(literals: Way) -> Iterator[Problem]:
    seen: dict[tuple[Key, bool], Atom] = {}
    for atom, polarity in literals:
        first = seen.setdefault((_key(atom), polarity), atom)
        if first is not atom and first.span != atom.span:
            message = f"the goal asks for `{atom}` twice; the first time on line {first.span.line}"
            yield Problem.at(atom.span, codes.DUPLICATE_ATOM, message, "remove one of the two", "warning")


def _contradicted(way: Way, dialect: Dialect) -> Iterator[Problem]:  # noqa: ARG001 - one signature for every check
    wanted = {_key(atom): atom for atom, polarity in way if polarity}
    for atom, polarity in way:
        first = wanted.get(_key(atom))
        if not polarity and first is not None:
            message = f"the goal can never hold: `{atom}` must and must not hold (line {first.span.line})"
            yield Problem.at(atom.span, codes.CONTRADICTION, message, "remove one of the two", "warning")


def _opposed(way: Way, dialect: Dialect) -> Iterator[Problem]:
    """Two predicates that exclude each other, such as Open and Close of one joint."""
    wanted = {_key(atom): atom for atom, polarity in way if polarity}
    for one, other in dialect.opposites:
        for (predicate, arguments), atom in wanted.items():
            rival = wanted.get((other, arguments)) if predicate == one else None
            if rival is not None:
                later, first = (rival, atom) if rival.span > atom.span else (atom, rival)
                message = (
                    f"the goal can never hold: `{later}` and `{first}` (line {first.span.line}) exclude each other"
                )
                yield Problem.at(later.span, codes.OPPOSITES, message, "remove one of the two", "warning")


def _supported(way: Way, dialect: Dialect) -> Iterator[Problem]:
    """An object that would have to be in two places at once."""
    for names, verb in ((dialect.supports, "rest on"), (dialect.contains, "be in")):
        places: dict[str, Atom] = {}
        for atom, polarity in way:
            if not polarity or atom.predicate.lower() not in names or len(atom.arguments) != 2:
                continue
            what, where = (symbol.name for symbol in atom.arguments)
            first = places.setdefault(what, atom)
            other = first.arguments[1].name
            if other != where:
                message = f"`{what}` would have to {verb} `{where}` and `{other}` (line {first.span.line}) at once"
                yield Problem.at(atom.span, codes.TWO_SUPPORTS, message, "name one place", "warning")


def _itself(way: Way, dialect: Dialect) -> Iterator[Problem]:
    """An object on or in itself, directly or by way of others; the problem is at the atom that closes the cycle."""
    stacked = [
        atom
        for atom, polarity in way
        if polarity and atom.predicate.lower() in (*dialect.supports, *dialect.contains) and len(atom.arguments) == 2
    ]
    while True:
        # An object with nothing on it, or on nothing, is not part of a cycle.
        tops, bottoms = ({atom.arguments[i].name for atom in stacked} for i in (0, 1))
        circular = [a for a in stacked if a.arguments[0].name in bottoms and a.arguments[1].name in tops]
        if len(circular) == len(stacked):
            break
        stacked = circular
    if stacked:
        atom = stacked[-1]
        what, where = (symbol.name for symbol in atom.arguments)
        message = f"the goal can never hold: `{atom}` puts `{what}` on or in itself"
        if what != where:
            message += ", by way of what else the goal asks for"
        yield Problem.at(atom.span, codes.ITSELF, message, "name another place", "warning")


@dataclass(frozen=True, slots=True)
class _Start:
    """The facts of ``:init``."""

    dialect: Dialect
    targets: dict[str, str]  # region: what it is part of
    true: set[Key]
    false: set[Key]

    def says(self, atom: Atom, *, polarity: bool) -> bool:
        """Whether a literal holds at the start: of a negated one, that something else is there in its place."""
        predicate, arguments = key = _key(atom)
        if polarity:
            return key in self.true
        if key in self.true:
            return False
        for one, other in self.dialect.opposites:
            if predicate in {one, other} and ((other if predicate == one else one), arguments) in self.true:
                return True
        placed = (*self.dialect.supports, *self.dialect.contains)
        elsewhere = any(name in placed and self._apart(where, arguments) for name, where in self.true)
        return key in self.false or (predicate in placed and elsewhere)

    def _apart(self, one: tuple[str, ...], other: tuple[str, ...]) -> bool:
        """Whether both are about the same object, and about places of different objects (regions may overlap)."""
        if len(one) != 2 or len(other) != 2 or one[0] != other[0]:
            return False
        return self.targets.get(one[1], one[1]) != self.targets.get(other[1], other[1])


def _already(spec: TaskSpec, goal: GoalLiterals) -> Iterator[Problem]:
    """A goal that the declared initial facts satisfy: ``:init`` has all facts of some alternative."""
    targets = {region.site: region.target.name for region in spec.regions}
    true, false = ({_key(atom) for atom in atoms} for atoms in (spec.init, spec.absent))
    start = _Start(dialect_of(spec.domain), targets, true, false)
    for way in goal.ways:
        if way and all(start.says(atom, polarity=polarity) for atom, polarity in way):
            message = "the goal holds at the start: `:init` declares all that it asks for"
            yield Problem.at(spec.goal.span, codes.ALREADY_TRUE, message, "ask for what is not there yet", "warning")
            return
