"""RDF triples indexed for validation: lexical forms are kept, and Oxigraph answers SPARQL over the same triples.

Oxigraph's store reads ``"5"^^xsd:byte`` as the integer 5; ``sh:datatype`` asks for what was written. So values are
looked up here, and a store is made only where a query is asked.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import cast

from pyoxigraph import BlankNode, DefaultGraph, Literal, NamedNode, Quad, Store, Triple

from onto_compiler.rdf import RDF, RDFS

__all__ = ["Graph", "Subject", "Term"]

Term = NamedNode | BlankNode | Literal
Subject = NamedNode | BlankNode
Ordered = dict[Term, None]  # a set that keeps its order

_TYPE, _SUBCLASS = NamedNode(RDF + "type"), NamedNode(RDFS + "subClassOf")
_NOTHING: Mapping[Term, None] = {}
_NONE: Mapping[Term, Ordered] = {}
_SCRATCH = NamedNode("urn:onto-evwm:term")


class Graph:
    """The triples of all graphs of ``quads`` together. ``store``, where given, holds the same ones for SPARQL."""

    def __init__(self, quads: Iterable[Quad | Triple] = (), store: Store | None = None) -> None:
        self._forward: dict[NamedNode, dict[Term, Ordered]] = {}
        self._backward: dict[NamedNode, dict[Term, Ordered]] = {}
        self._subclasses: dict[Term, Ordered] = {}
        self._described: dict[Term, list[NamedNode]] = {}
        self._written: dict[Literal, Literal] | None = None
        self._given, self._store = store, store
        forward = self._forward
        for quad in quads:
            predicate, subject = quad.predicate, quad.subject
            by_subject = forward.get(predicate)
            if by_subject is None:
                by_subject = forward[predicate] = {}
            values = by_subject.get(subject)  # type: ignore[arg-type]  # a quoted triple is no subject of ours
            if values is None:
                by_subject[subject] = {quad.object: None}  # type: ignore[index, dict-item]
            else:
                values[quad.object] = None  # type: ignore[index]

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
        subject, value = cast("Term", triple.subject), cast("Term", triple.object)
        values = self._forward.setdefault(triple.predicate, {}).setdefault(subject, {})
        if value in values:
            return False
        values[value] = None
        self._backward.pop(triple.predicate, None)
        self._described.clear()
        self._written = None
        if triple.predicate == _SUBCLASS:
            self._subclasses.clear()
        if self._store is not None:
            self._store.add(Quad(triple.subject, triple.predicate, triple.object))
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
    def store(self) -> Store:
        """The triples as Oxigraph holds them; queries ask the union of its graphs."""
        if self._store is None:
            self._store = self._copy()
        return self._store

    def beside(self, other: Graph, name: NamedNode) -> Store:
        """A store whose default graph is this graph, and whose graph ``name`` is ``other``."""
        store = self._copy()
        store.bulk_extend(Quad(t.subject, t.predicate, t.object, name) for t in other)
        return store

    def _copy(self) -> Store:
        store = Store()
        default = DefaultGraph()
        store.bulk_extend(Quad(t.subject, t.predicate, t.object, default) for t in self)
        return store

    def written(self, term: Term) -> Term:
        """A term that came out of the store, as this graph writes it."""
        if not isinstance(term, Literal) or self._given is not None:
            return term
        if self._written is None:
            self._written = _spellings(self)
        return self._written.get(term, term)


_FIRST, _REST, _NIL = (NamedNode(RDF + name) for name in ("first", "rest", "nil"))


def _spellings(graph: Graph) -> dict[Literal, Literal]:
    """Of each literal that a store spells in another way, one of the ways in which the graph does."""
    literals = {t.object for t in graph if isinstance(t.object, Literal) and t.object.language is None}
    numbered = list(literals)
    store = Store()
    names = [NamedNode(f"urn:onto-evwm:term:{number}") for number in range(len(numbered))]
    store.bulk_extend(Quad(name, _SCRATCH, value) for name, value in zip(names, numbered, strict=True))
    found: dict[Literal, Literal] = {}
    for quad in store:
        literal = numbered[int(quad.subject.value.rpartition(":")[2])]
        stored = cast("Literal", quad.object)
        if stored != literal and stored not in literals:
            found[stored] = literal
    return found
