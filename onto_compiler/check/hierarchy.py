"""Circles of subclasses, and classes under two disjoint ones. Python, since a query's path looks at every pair.

SPARQL's ``rdfs:subClassOf*`` between two unknown ends takes a second for a chain of a thousand classes; here each class
is looked at once for each class that another is disjoint with.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations
from typing import cast

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.rdf import RDFS
from onto_compiler.reasoning.axioms import disjoint_groups
from onto_compiler.reasoning.reach import circles

__all__ = ["check_hierarchy"]

_SUBCLASS = NamedNode(RDFS + "subClassOf")


def check_hierarchy(model: Model) -> Iterator[Finding]:
    """OWL004 for each ``rdfs:subClassOf`` of a circle, OWL006 for each that puts a class where nothing can be."""
    above: defaultdict[Term, list[Term]] = defaultdict(list)
    below: defaultdict[Term, list[Term]] = defaultdict(list)
    for quad in model.store.quads_for_pattern(None, _SUBCLASS, None, None):
        above[cast("Term", quad.subject)].append(cast("Term", quad.object))
        below[cast("Term", quad.object)].append(cast("Term", quad.subject))
    yield from _circles(above)
    groups = {frozenset(filter(_is_named, group)) for group in disjoint_groups(model.store)}
    yield from _impossible(groups, above, below)


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


def _impossible(
    groups: Iterable[frozenset[Term]], above: Mapping[Term, list[Term]], below: Mapping[Term, list[Term]]
) -> Iterator[Finding]:
    under = {cls: _reached(below, cls) for cls in {cls for group in groups for cls in group}}
    for group in groups:
        over: defaultdict[Term, list[Term]] = defaultdict(list)
        for top in sorted(group, key=lambda one: one.value):
            for cls in under[top]:
                over[cls].append(top)
        for cls, tops in over.items():
            for one, two in combinations(tops, 2):
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
