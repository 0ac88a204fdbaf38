"""SHACL property paths as functions from a focus node to its value nodes (SHACL, section 2.3.1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import RDF, SH, node
from onto_compiler.validator.facts import Facts, Term, Values

__all__ = ["Walk", "items", "walk"]

Walk = Callable[[Facts, Term], Values]
_FIRST, _REST, _NIL = (node(RDF + name) for name in ("first", "rest", "nil"))
_INVERSE, _EITHER = node(SH + "inversePath"), node(SH + "alternativePath")
_DEPTH = 32


def walk(shapes: Facts, path: Term) -> Walk | None:
    """The path that ``path`` writes in ``shapes``, or None where it is none that SHACL knows."""
    return _walk(shapes, path, False, _DEPTH)


def items(shapes: Facts, head: Term) -> tuple[Term, ...]:
    """The members of an RDF list; what is no list, or turns in a circle, ends where it breaks off."""
    found: list[Term] = []
    seen = set()
    while head != _NIL and head not in seen:
        seen.add(head)
        first, rest = shapes.values(head, _FIRST), shapes.values(head, _REST)
        if not first or not rest:
            break
        found.append(next(iter(first)))
        head = next(iter(rest))
    return tuple(found)


def _walk(shapes: Facts, path: Term, back: bool, depth: int) -> Walk | None:  # noqa: FBT001 - the path's direction
    """``path``, or the way ``back`` along it: a sequence from its end, with each of its parts turned round."""
    if isinstance(path, NamedNode):
        return _backwards(path) if back else _forwards(path)
    if isinstance(path, Literal) or depth == 0:
        return None
    for inner in shapes.values(path, _INVERSE):
        return _walk(shapes, inner, not back, depth - 1)
    for key, repeat in _REPEATED.items():
        for inner in shapes.values(path, key):
            step = _walk(shapes, inner, back, depth - 1)
            return None if step is None else repeat(step)
    either = next(iter(shapes.values(path, _EITHER)), None)
    members = [_walk(shapes, item, back, depth - 1) for item in items(shapes, path if either is None else either)]
    steps = [step for step in members if step is not None]
    if not steps or len(steps) != len(members):
        return None
    return _alternatives(steps) if either is not None else _sequence(steps[::-1] if back else steps)


def _forwards(predicate: NamedNode) -> Walk:
    return lambda facts, focus: facts.values(focus, predicate)


def _backwards(predicate: NamedNode) -> Walk:
    return lambda facts, focus: facts.subjects(predicate, focus)


def _any(step: Walk) -> Walk:
    return lambda facts, focus: dict.fromkeys([focus, *_reached(step, facts, focus)])


def _some(step: Walk) -> Walk:
    return lambda facts, focus: dict.fromkeys(_reached(step, facts, focus))


def _maybe(step: Walk) -> Walk:
    return lambda facts, focus: dict.fromkeys([focus, *step(facts, focus)])


_REPEATED: dict[NamedNode, Callable[[Walk], Walk]] = {
    node(SH + "zeroOrMorePath"): _any,
    node(SH + "oneOrMorePath"): _some,
    node(SH + "zeroOrOnePath"): _maybe,
}


def _sequence(steps: list[Walk]) -> Walk:
    def follow(facts: Facts, focus: Term) -> Values:
        reached: Values = (focus,)
        for step in steps:
            reached = dict.fromkeys(value for each in reached for value in step(facts, each))
        return reached

    return follow


def _alternatives(steps: list[Walk]) -> Walk:
    return lambda facts, focus: dict.fromkeys(value for step in steps for value in step(facts, focus))


def _reached(step: Walk, facts: Facts, focus: Term) -> Iterator[Term]:
    seen: set[Term] = set()
    todo = [focus]
    while todo:
        for value in step(facts, todo.pop()):
            if value not in seen:
                seen.add(value)
                todo.append(value)
                yield value
