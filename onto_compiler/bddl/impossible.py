"""Whether a required ABox can hold at all: facts that exclude each other, or things that would be on themselves.

No scene is used. What is reported is certain: of predicates by what the ontology declares of them
(``core:characteristic``), of joints by their thresholds. On two supports at a time a thing may well rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

from onto_compiler.bddl import codes
from onto_compiler.conflicts import exclude
from onto_compiler.problems import OntoError, Problem, Span
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema

__all__ = ["impossible", "refuse_impossible"]


def impossible(required: RequiredABox, schema: Schema) -> tuple[Problem, ...]:
    """Why the goal can never hold, a problem for each of its alternatives; empty if one of them may hold."""
    found = []
    for way in required.ways:
        problem = _reason([required.facts[index] for index in way], schema, required.source)
        if problem is None:
            return ()
        found.append(problem)
    return tuple(dict.fromkeys(found))


def refuse_impossible(required: RequiredABox, schema: Schema) -> None:
    """Stop before anything is tried for a goal that can never hold.

    Raises:
        OntoError: BDDL024, if a fact must and must not hold; BDDL026 if an object would be on or in itself;
            BDDL027, where two facts exclude each other.

    """
    problems = impossible(required, schema)
    if problems:
        raise OntoError(*problems)


def _reason(facts: Sequence[Fact], schema: Schema, file: str) -> Problem | None:
    for one, other in combinations(facts, 2):
        if exclude(one, other, schema):
            same = one.predicate == other.predicate and one.arguments == other.arguments
            code = codes.CONTRADICTION if same else codes.OPPOSITES
            message = f"the goal can never hold: `{one}` and `{other}` exclude each other"
            return _problem(other, code, message, "remove one of the two", file)
    circle = _circle(facts, schema)
    if not circle:
        return None
    links = ", ".join(f"`{fact}`" for fact in circle)
    what = circle[0].arguments[0].name
    message = f"the goal can never hold: {links} would put `{what}` on or in itself"
    return _problem(circle[-1], codes.ITSELF, message, "name another place", file)


def _circle(facts: Iterable[Fact], schema: Schema) -> list[Fact]:
    """Facts of acyclic predicates of which each ends where the next begins, and the last where the first does."""
    above: dict[str, list[Fact]] = {}
    for fact in facts:
        predicate = schema.predicates.get(fact.predicate)
        if fact.polarity and predicate is not None and predicate.acyclic and len(fact.arguments) == 2:
            above.setdefault(fact.arguments[0].name, []).append(fact)
    done: set[str] = set()
    for start, first in above.items():
        path: list[Fact] = []
        pending = [iter(first)]
        while pending:
            following = next(pending[-1], None)
            if following is None:
                pending.pop()
                done.add(path.pop().arguments[1].name if path else start)
                continue
            links = [*path, following]
            names = [each.arguments[0].name for each in links]
            here = following.arguments[1].name
            if here in names:
                return links[names.index(here) :]
            if here not in done:
                path = links
                pending.append(iter(above.get(here, ())))
    return []


def _problem(fact: Fact, code: str, message: str, hint: str, file: str) -> Problem:
    return Problem.at(fact.span or Span(file), code, message, hint)
