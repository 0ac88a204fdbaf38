"""Records on top of a vocabulary: the few statements at hand, seen together with a graph that was indexed once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from pyoxigraph import NamedNode, Quad, Triple

from onto_compiler.rdf import RDFS
from onto_compiler.shacl.graph import Graph, Ordered, Term

__all__ = ["Overlay"]

_SUBCLASS = NamedNode(RDFS + "subClassOf")


class Overlay(Graph):
    """What ``quads`` describe, over ``below``, which is not copied and must not change.

    Asked for the nodes that have a type or a property, it answers with the nodes of ``quads`` alone, so that these are
    the focus nodes. Asked about a node, it knows what ``quads`` and ``below`` state of it.
    """

    def __init__(self, below: Graph, quads: Iterable[Quad | Triple]) -> None:
        super().__init__(quads)
        self._below = below
        self._own = set[Term]().union(*self._forward.values())
        known = below.described
        for node in [node for node in self._own if node in known]:
            for predicate in known[node]:
                by_subject = self._forward.setdefault(predicate, {})
                by_subject[node] = {**below.objects(node, predicate), **by_subject.get(node, {})}

    def __iter__(self) -> Iterator[Triple]:
        yield from super().__iter__()
        yield from self._below

    def describes(self, node: Term) -> bool:
        """Whether a statement of the overlay itself has ``node`` for its subject."""
        return node in self._own

    def objects(self, subject: Term, predicate: NamedNode) -> Mapping[Term, None]:
        """The values of a property, in the order in which they were read."""
        return super().objects(subject, predicate) if subject in self._own else self._below.objects(subject, predicate)

    def subjects(self, predicate: NamedNode, value: Term) -> Mapping[Term, None]:
        """The nodes that have ``value`` for a property."""
        own, below = super().subjects(predicate, value), self._below.subjects(predicate, value)
        return {**below, **own} if own and below else own or below

    def predicates(self, subject: Term) -> list[NamedNode]:
        """The properties that a node has."""
        return super().predicates(subject) if subject in self._own else self._below.predicates(subject)

    def subclasses(self, cls: Term) -> Ordered:
        """A class and all below it; records seldom extend the tree."""
        return super().subclasses(cls) if _SUBCLASS in self._forward else self._below.subclasses(cls)
