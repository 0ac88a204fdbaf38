"""Axioms with which a closure has the same clashes and fewer facts: of the classes above, only those that matter.

A class matters where an axiom waits for it: one that holds it apart from another, restricts its instances, or counts
them. What is derived of the others is of no use to a search for contradictions, and a chain of n classes would have
n² / 2 of them. The premises of such a closure are not those that a person wrote.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import replace

from onto_compiler.reasoning.axioms import Axioms, Fact, Term, owl
from onto_compiler.reasoning.reach import above

__all__ = ["contentious", "lean", "representatives"]


def contentious(axioms: Axioms, classes: Iterable[Term]) -> dict[Term, frozenset[Term]]:
    """For each class, and each of ``classes``, the classes that matter among it and those above it."""
    waiting = (axioms.both, axioms.disjoint, axioms.only, axioms.value, axioms.some_of, axioms.at_most)
    wanted = {owl("Nothing"), *(cls for index in waiting for cls in index)}
    wanted |= {qualifier for limits in axioms.at_most.values() for _, _, qualifier, _ in limits if qualifier}
    edges = {cls: [to for to, _ in found] for cls, found in axioms.above.items()}
    return above({**dict.fromkeys(classes, ()), **edges}, wanted)


def lean(axioms: Axioms, upper: dict[Term, frozenset[Term]]) -> Axioms:
    """``axioms``, in which each class is directly below those of ``upper``."""
    shorter: defaultdict[Term, list[tuple[Term, Fact]]] = defaultdict(list)
    for cls, found in axioms.above.items():
        shorter[cls] = [(to, found[0][1]) for to in upper[cls] if to != cls]
    return replace(axioms, above=shorter)


def representatives(upper: dict[Term, frozenset[Term]], classes: Iterable[Term]) -> list[Term]:
    """One of ``classes`` for each different set of classes that matter; where nothing matters, nothing can clash."""
    chosen: dict[frozenset[Term], Term] = {}
    for cls in sorted(classes, key=lambda one: one.value):
        if upper[cls]:
            chosen.setdefault(upper[cls], cls)
    return list(chosen.values())
