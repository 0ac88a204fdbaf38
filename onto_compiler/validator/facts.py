"""Statements by subject and predicate, seen on top of a vocabulary that was indexed once."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Triple

from onto_compiler.rdf import RDF, RDFS, node

__all__ = ["NOTHING", "Facts", "Nodes", "Properties", "Term", "Values", "Vocabulary", "index"]

Term = NamedNode | BlankNode | Literal
Values = Collection[Term]  # distinct, in the order of the statements
Properties = dict[NamedNode, dict[Term, None]]
Nodes = dict[Term, Properties]

NOTHING: Mapping[Term, None] = {}
_NO_PROPERTIES: Properties = {}
_TYPE, _BELOW = node(RDF + "type"), node(RDFS + "subClassOf")


def index(statements: Iterable[Quad | Triple]) -> Nodes:
    """What is said of each subject; graph names are passed over, and a statement counts once."""
    nodes: Nodes = {}
    for statement in statements:
        subject, predicate = statement.subject, statement.predicate
        properties = nodes.get(subject)  # type: ignore[arg-type]  # a quoted triple is no subject of ours
        if properties is None:
            nodes[subject] = properties = {}  # type: ignore[index]
        values = properties.get(predicate)
        if values is None:
            properties[predicate] = {statement.object: None}  # type: ignore[dict-item]
        else:
            values[statement.object] = None  # type: ignore[index]
    return nodes


class Vocabulary:
    """The statements that every record may rest on: classes, individuals, predicates and routes."""

    __slots__ = ("_inverse", "_subclasses", "nodes")

    def __init__(self, nodes: Nodes) -> None:
        self.nodes = nodes
        self._subclasses: dict[Term, frozenset[Term]] = {}
        self._inverse: dict[NamedNode, dict[Term, dict[Term, None]]] = {}

    def subclasses(self, cls: Term) -> frozenset[Term]:
        """``cls`` and every class below it, by ``rdfs:subClassOf``."""
        known = self._subclasses.get(cls)
        if known is None:
            found, todo = {cls}, [cls]
            inverse = self.inverse(_BELOW)
            while todo:
                new = [below for below in inverse.get(todo.pop(), NOTHING) if below not in found]
                found.update(new)
                todo += new
            self._subclasses[cls] = known = frozenset(found)
        return known

    def inverse(self, predicate: NamedNode) -> dict[Term, dict[Term, None]]:
        """The subjects of ``predicate`` by its objects."""
        known = self._inverse.get(predicate)
        if known is None:
            self._inverse[predicate] = known = _inverted(self.nodes, predicate)
        return known


class Facts:
    """The statements that are being validated; a subject that the vocabulary knows keeps what is said of it there."""

    __slots__ = ("_inverse", "nodes", "vocabulary")

    def __init__(self, vocabulary: Vocabulary, statements: Iterable[Quad | Triple]) -> None:
        self.nodes = index(statements)
        known = vocabulary.nodes
        for subject in [subject for subject in self.nodes if subject in known]:
            self.nodes[subject] = _merged(known[subject], self.nodes[subject])
        if any(_BELOW in properties for properties in self.nodes.values()):
            # Statements that extend the class tree are no records, and are taken for what they say all the same.
            vocabulary = Vocabulary({**known, **self.nodes})
        self.vocabulary = vocabulary
        self._inverse: dict[NamedNode, dict[Term, dict[Term, None]]] = {}

    def about(self, subject: Term) -> Properties:
        """All that is said of ``subject``."""
        return self.nodes.get(subject) or self.vocabulary.nodes.get(subject) or _NO_PROPERTIES

    def values(self, subject: Term, predicate: NamedNode) -> Values:
        """The objects of ``predicate`` that ``subject`` has."""
        return self.about(subject).get(predicate) or NOTHING

    def subjects(self, predicate: NamedNode, value: Term) -> Values:
        """The subjects that have ``value`` for ``predicate``."""
        own = self._inverse.get(predicate)
        if own is None:
            self._inverse[predicate] = own = _inverted(self.nodes, predicate)
        here, there = own.get(value), self.vocabulary.inverse(predicate).get(value)
        if here and there:
            return {**there, **here}
        return here or there or NOTHING

    def is_a(self, value: Term, cls: Term) -> bool:
        """Whether ``value`` has ``cls`` or a class below it for a type."""
        below = self.vocabulary.subclasses(cls)
        # A loop: this is asked of most values, and a generator would cost as much again.
        for each in self.about(value).get(_TYPE) or NOTHING:  # noqa: SIM110
            if each in below:
                return True
        return False


def _merged(first: Properties, second: Properties) -> Properties:
    return {key: {**first.get(key, {}), **second.get(key, {})} for key in (*first, *second)}


def _inverted(nodes: Nodes, predicate: NamedNode) -> dict[Term, dict[Term, None]]:
    found: dict[Term, dict[Term, None]] = {}
    for subject, properties in nodes.items():
        for value in properties.get(predicate) or NOTHING:
            found.setdefault(value, {})[subject] = None
    return found
