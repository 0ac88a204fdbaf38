"""RDF triples indexed for validation: values are looked up here, and a store is made only where a query is asked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import cast

from pyoxigraph import BlankNode, NamedNode, Quad, Store, Triple

from onto_compiler.lexical.store import LexicalStore
from onto_compiler.lexical.terms import respelled
from onto_compiler.rdf import RDF, RDFS
from onto_compiler.terms import Term

__all__ = ["Graph", "Subject", "Term"]

Subject = NamedNode | BlankNode
Ordered = dict[Term, None]  # a set that keeps its order

_TYPE, _SUBCLASS = NamedNode(RDF + "type"), NamedNode(RDFS + "subClassOf")
_FIRST, _REST, _NIL = (NamedNode(RDF + name) for name in ("first", "rest", "nil"))
_NOTHING: Mapping[Term, None] = {}
_NONE: Mapping[Term, Ordered] = {}


class Graph:
    """The triples of all graphs of ``quads`` together. ``store``, where given, holds the same ones for SPARQL."""

    def __init__(self, quads: Iterable[Quad | Triple] = (), store: Store | None = None) -> None:
        self._forward: dict[NamedNode, dict[Term, Ordered]] = {}
        self._backward: dict[NamedNode, dict[Term, Ordered]] = {}
        self._subclasses: dict[Term, Ordered] = {}
        self._described: dict[Term, list[NamedNode]] = {}
        if store is not None and not isinstance(quads, Store):
            quads = tuple(quads)
        self._given, self._quads = store, quads if store is not None else ()
        self._store: LexicalStore | None = None
        forward = self._forward
        for quad in quads:
            predicate, subject = quad.predicate, quad.subject
            by_subject = forward.get(predicate)
            if by_subject is None:
                by_subject = forward[predicate] = {}
            values = by_subject.get(subject)
            if values is None:
                by_subject[subject] = {quad.object: None}
            else:
                values[quad.object] = None

    @classmethod
    def of_store(cls, store: Store) -> Graph:
        """All graphs of a store together; SPARQL then runs on the store itself."""
        return cls(store, store)

    def __iter__(self) -> Iterator[Triple]:
        for predicate, by_subject in self._forward.items():
            for subject, values in by_subject.items():
                for value in values:
                    yield Triple(cast("Subject", subject), predicate, value)

    def __len__(self) -> int:
        return sum(len(values) for by_subject in self._forward.values() for values in by_subject.values())

    def __contains__(self, triple: tuple[Term, NamedNode, Term]) -> bool:
        subject, predicate, value = triple
        return value in self.objects(subject, predicate)

    def add(self, triple: Triple) -> bool:
        """Add a triple; false where it was there already."""
        subject, value = triple.subject, triple.object
        values = self._forward.setdefault(triple.predicate, {}).setdefault(subject, {})
        if value in values:
            return False
        values[value] = None
        self._backward.pop(triple.predicate, None)
        self._described.clear()
        if triple.predicate == _SUBCLASS:
            self._subclasses.clear()
        if self._store is not None:
            self._store.extend((Quad(triple.subject, triple.predicate, triple.object),))
        return True

    def objects(self, subject: Term, predicate: NamedNode) -> Mapping[Term, None]:
        """The values of a property, in the order in which they were read."""
        return self._forward.get(predicate, _NONE).get(subject, _NOTHING)

    def subjects(self, predicate: NamedNode, value: Term) -> Mapping[Term, None]:
        """The nodes that have ``value`` for a property."""
        return self.values(predicate).get(value, _NOTHING)

    def sources(self, value: Term, predicate: NamedNode) -> Mapping[Term, None]:
        """As :meth:`subjects`, with the arguments of :meth:`objects`."""
        return self.subjects(predicate, value)

    def describes(self, node: Term) -> bool:  # noqa: ARG002 - records describe less than what they know
        """Whether a shape that names ``node`` for its target has it for a focus node: here, always."""
        return True

    def holders(self, predicate: NamedNode) -> Mapping[Term, Ordered]:
        """Every node that has a property, with its values."""
        return self._forward.get(predicate, _NONE)

    @property
    def properties(self) -> Iterable[NamedNode]:
        """The predicates of all triples."""
        return self._forward.keys()

    def has_subject(self, node: Term) -> bool:
        """Whether a triple has ``node`` for its subject."""
        return any(node in by_subject for by_subject in self._forward.values())

    def values(self, predicate: NamedNode) -> Mapping[Term, Ordered]:
        """Every value of a property, with the nodes that have it."""
        backward = self._backward.get(predicate)
        if backward is None:
            backward = self._backward[predicate] = {}
            for subject, values in self._forward.get(predicate, _NONE).items():
                for value in values:
                    backward.setdefault(value, {})[subject] = None
        return backward

    @property
    def described(self) -> Mapping[Term, list[NamedNode]]:
        """Every node that has a property, with its properties."""
        if not self._described:
            for predicate, by_subject in self._forward.items():
                for own in by_subject:
                    self._described.setdefault(own, []).append(predicate)
        return self._described

    def predicates(self, subject: Term) -> list[NamedNode]:
        """The properties that a node has."""
        return self.described.get(subject, [])

    def pointing(self, value: Term) -> Iterator[NamedNode]:
        """The properties that ``value`` is a value of."""
        return (predicate for predicate in self._forward if self.subjects(predicate, value))

    def instances(self, cls: Term) -> Ordered:
        """The SHACL instances of a class: those of its subclasses are among them (SHACL, section 1.1)."""
        typed = self.values(_TYPE)
        return {node: None for one in self.subclasses(cls) for node in typed.get(one, _NOTHING)}

    def is_a(self, node: Term, cls: Term) -> bool:
        """Whether ``node`` is one of the :meth:`instances` of ``cls``."""
        below = self.subclasses(cls)
        # A loop: this is asked of most values, and a generator would cost as much again.
        for each in self.objects(node, _TYPE):  # noqa: SIM110
            if each in below:
                return True
        return False

    def subclasses(self, cls: Term) -> Ordered:
        """A class and all below it."""
        found = self._subclasses.get(cls)
        if found is None:
            found = self._subclasses[cls] = {cls: None}
            todo = [cls]
            while todo:
                new = [one for one in self.subjects(_SUBCLASS, todo.pop()) if one not in found]
                found.update(dict.fromkeys(new))
                todo += new
        return found

    def items(self, head: Term) -> list[Term] | None:
        """The members of an RDF list, or None if it does not end."""
        members: list[Term] = []
        seen: set[Term] = set()
        while head != _NIL:
            first, rest = self.objects(head, _FIRST), self.objects(head, _REST)
            if head in seen or not first or not rest:
                return None
            seen.add(head)
            members.append(next(iter(first)))
            head = next(iter(rest))
        return members

    @property
    def store(self) -> LexicalStore:
        """The same triples for SPARQL; queries ask the union of its graphs."""
        if self._store is None:
            given = self._given
            if given is None:
                self._store = LexicalStore(self._as_quads())
            elif self._quads is given or not respelled({quad.object for quad in self._quads}):
                self._store = LexicalStore(store=given)
            else:
                self._store = LexicalStore(quad for quad in self._quads if isinstance(quad, Quad))
        return self._store

    def beside(self, other: Graph, name: NamedNode) -> LexicalStore:
        """A store whose default graph is this graph, and whose graph ``name`` is ``other``."""
        return LexicalStore([*self._as_quads(), *other._as_quads(name)])

    def _as_quads(self, *name: NamedNode) -> Iterator[Quad]:
        return (Quad(t.subject, t.predicate, t.object, *name) for t in self)
