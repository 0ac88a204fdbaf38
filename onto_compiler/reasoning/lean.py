"""Axioms with which a closure has the same clashes and fewer facts: of the classes above, only those that matter.

A class matters where an axiom waits for it: one that holds it apart from another, restricts its instances, or counts
them. What is derived of the others is of no use to a search for contradictions, and a chain of n classes would have
n² / 2 of them. The premises of such a closure are not those that a person wrote.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

from onto_compiler.reasoning.axioms import Axioms, Fact, Term, owl
from onto_compiler.reasoning.reach import above

__all__ = ["contentious", "lean", "representatives"]


def contentious(axioms: Axioms, classes: Iterable[Term]) -> dict[Term, frozenset[Term]]:
    """For each class, and each of ``classes``, the classes that matter among it and those above it."""
    return above({**dict.fromkeys(classes, ()), **_edges(axioms)}, _wanted(axioms))


def lean(axioms: Axioms) -> Axioms:
    """``axioms``, in which each class is directly below the next ones that matter."""
    edges, wanted = _edges(axioms), _wanted(axioms)
    following = above({cls: () if cls in wanted else found for cls, found in edges.items()}, wanted)
    shorter: defaultdict[Term, list[tuple[Term, Fact]]] = defaultdict(list)
    for cls, found in axioms.above.items():
        follows = {to: axiom for direct, axiom in found for to in following.get(direct, {direct} & wanted)}
        shorter[cls] = list(follows.items())
    return replace(axioms, above=shorter)


def representatives(axioms: Axioms, upper: Mapping[Term, frozenset[Term]], classes: Collection[Term]) -> list[Term]:
    """One of ``classes`` for each set of classes that matter, unless a subclass is under as many and more.

    Where nothing matters, nothing can clash.
    """
    surpassed = {
        to
        for cls in classes
        for to, _ in axioms.above.get(cls, ())
        if upper[to] is not upper[cls] and upper[to] != upper[cls]
    }
    chosen: dict[frozenset[Term], Term] = {}
    for cls in sorted(classes, key=lambda one: one.value):
        if upper[cls] and cls not in surpassed:
            chosen.setdefault(upper[cls], cls)
    return list(chosen.values())


def _edges(axioms: Axioms) -> dict[Term, list[Term]]:
    return {cls: [to for to, _ in found] for cls, found in axioms.above.items()}


def _wanted(axioms: Axioms) -> set[Term]:
    waiting = (axioms.both, axioms.disjoint, axioms.only, axioms.value, axioms.some_of, axioms.at_most)
    counted = {qualifier for limits in axioms.at_most.values() for _, _, qualifier, _ in limits if qualifier}
    return {owl("Nothing"), *counted, *(cls for index in waiting for cls in index)}
