"""Circles of subclasses, and what is under two disjoint classes. Python, since a query's path looks at every pair.

SPARQL's ``rdfs:subClassOf*`` between two unknown ends takes a second for a chain of a thousand classes; here each class
is looked at once for each class that another is disjoint with.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations, product
from typing import cast

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.rdf import RDFS
from onto_compiler.reasoning.axioms import TYPE, disjoint_groups
from onto_compiler.reasoning.reach import circles

__all__ = ["check_hierarchy"]

_SUBCLASS = NamedNode(RDFS + "subClassOf")


def check_hierarchy(model: Model) -> Iterator[Finding]:
    """The problems of the class hierarchy of all files.

    OWL004 for each ``rdfs:subClassOf`` of a circle, OWL006 for each that puts a class under two disjoint ones, and
    OWL005 for each type that puts an individual there.
    """
    above: defaultdict[Term, list[Term]] = defaultdict(list)
    below: defaultdict[Term, list[Term]] = defaultdict(list)
    for quad in model.store.quads_for_pattern(None, _SUBCLASS, None, None):
        above[cast("Term", quad.subject)].append(cast("Term", quad.object))
        below[cast("Term", quad.object)].append(cast("Term", quad.subject))
    yield from _circles(above)
    groups = {frozenset(filter(_is_named, group)) for group in disjoint_groups(model.store)}
    under = {cls: _reached(below, cls) for cls in {cls for group in groups for cls in group}}
    members: defaultdict[Term, list[Term]] = defaultdict(list)
    for quad in model.store.quads_for_pattern(None, TYPE, None, None):
        members[cast("Term", quad.object)].append(cast("Term", quad.subject))
    for group in groups:
        tops = _tops(group, under)
        yield from _individuals(members, tops)
        yield from _impossible(tops, under, above)


def _circles(above: Mapping[Term, list[Term]]) -> Iterator[Finding]:
    for circle in circles(above):
        within = set(circle)
        for cls in circle:
            for wider in dict.fromkeys(above.get(cls, ())):
                if wider in within:
                    yield Finding(
                        "OWL004",
                        "error",
                        "`{subject}` is a subclass of itself, by way of `{object}`",
                        "remove one rdfs:subClassOf of the circle",
                        cls,
                        _SUBCLASS,
                        wider,
                    )


def _tops(group: frozenset[Term], under: Mapping[Term, set[Term]]) -> dict[Term, list[Term]]:
    """The members of ``group`` above each class that is below any, in the order of their IRIs."""
    found: dict[Term, list[Term]] = {}
    for top in sorted(group, key=lambda one: one.value):
        for cls in under[top]:
            found.setdefault(cls, []).append(top)
    return found


def _individuals(members: Mapping[Term, list[Term]], tops: Mapping[Term, list[Term]]) -> Iterator[Finding]:
    types: defaultdict[Term, list[tuple[Term, Term]]] = defaultdict(list)
    for cls, found in tops.items():
        for subject in members.get(cls, ()):
            types[subject] += [(cls, top) for top in found]
    for subject, held in types.items():
        for (cls, two), (_, one) in product(held, held):
            if one.value < two.value:
                yield Finding(
                    "OWL005",
                    "error",
                    "`{subject}` is a `{one}` and a `{two}`, which are disjoint",
                    "give it one of the two types",
                    subject,
                    TYPE,
                    cls,
                    values={"one": one, "two": two},
                )


def _impossible(
    tops: Mapping[Term, list[Term]], under: Mapping[Term, set[Term]], above: Mapping[Term, list[Term]]
) -> Iterator[Finding]:
    for cls, found in tops.items():
        for one, two in combinations(found, 2):
            wider = dict.fromkeys(above.get(cls, ()))
            for to in [to for to in wider if to in under[two]] or [to for to in wider if to in under[one]]:
                yield Finding(
                    "OWL006",
                    "error",
                    "`{subject}` is under `{one}` and under `{two}`, which are disjoint, so nothing can be one",
                    "keep one of the two superclasses",
                    cls,
                    _SUBCLASS,
                    to,
                    values={"one": one, "two": two},
                )


def _is_named(term: Term) -> bool:
    return isinstance(term, NamedNode)


def _reached(edges: Mapping[Term, Iterable[Term]], start: Term) -> set[Term]:
    found, waiting = {start}, [start]
    while waiting:
        further = set(edges.get(waiting.pop(), ())) - found
        found |= further
        waiting += further
    return found
