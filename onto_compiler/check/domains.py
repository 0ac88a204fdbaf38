"""Domains and ranges: what has a property, and what is its value, is of the class that the property asks for.

Python, since SPARQL's ``rdfs:subClassOf*`` walks the hierarchy again for each triple; here it is walked once for each
class. A class expression counts for the members of its union or intersection; of other expressions nothing is asked.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cache

from pyoxigraph import BlankNode, NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, RDF, RDFS
from onto_compiler.reasoning.axioms import TYPE, owl
from onto_compiler.shacl.graph import Graph
from onto_compiler.terms import Term

__all__ = ["check_domains"]

_OUTSIDE_DOMAIN = (
    "VOC005",
    "`{subject}` is not of class `{wanted}`, which `{predicate}` describes",
    "use a property of what `{subject}` is, or correct its type",
)
_OUTSIDE_RANGE = (
    "VOC004",
    "`{object}` is not of class `{wanted}`, which `{predicate}` asks for",
    "give an instance of `{wanted}`",
)
_DOMAIN, _RANGE = NamedNode(RDFS + "domain"), NamedNode(RDFS + "range")
_SUBCLASS = NamedNode(RDFS + "subClassOf")
_ALL = {owl("Thing"), NamedNode(RDFS + "Resource")}
_CLASS, _PROPERTY = NamedNode(RDFS + "Class"), NamedNode(RDF + "Property")
_PROPERTIES = ("ObjectProperty", "DatatypeProperty", "AnnotationProperty", "OntologyProperty")
_KINDS = ("Functional", "InverseFunctional", "Transitive", "Symmetric", "Asymmetric", "Irreflexive", "Reflexive")
_META: Mapping[Term, tuple[Term, ...]] = {  # what OWL 2's RDF-based semantics says of its own classes
    _CLASS: (owl("Class"), NamedNode(RDFS + "Datatype")),
    owl("Class"): (owl("Restriction"), _CLASS),
    _PROPERTY: tuple(map(owl, (*_PROPERTIES, *(f"{kind}Property" for kind in _KINDS)))),
    owl("ObjectProperty"): tuple(owl(f"{kind}Property") for kind in _KINDS[1:]),
}


def check_domains(model: Model) -> Iterator[Finding]:
    """VOC005 for a subject outside the domain of its property, VOC004 for a value outside the range."""
    graph = model.graph
    classes = _Classes(graph, _edges(model))
    for predicate, inside, wanted in classes.declared(_DOMAIN):
        for subject, values in graph.holders(predicate).items():
            if not classes.may_be(subject, inside):
                yield from (_finding(_OUTSIDE_DOMAIN, subject, predicate, value, wanted) for value in values)
    for predicate, inside, wanted in classes.declared(_RANGE):
        if owl("ObjectProperty") not in graph.objects(predicate, TYPE):
            continue
        for value, subjects in graph.values(predicate).items():
            if isinstance(value, NamedNode) and not classes.may_be(value, inside):
                yield from (_finding(_OUTSIDE_RANGE, subject, predicate, value, wanted) for subject in subjects)


def _finding(words: tuple[str, str, str], subject: Term, predicate: NamedNode, value: Term, wanted: Term) -> Finding:
    code, message, hint = words
    return Finding(code, "error", message, hint, subject, predicate, value, values={"wanted": wanted}, general=True)


def _edges(model: Model) -> Mapping[Term, set[Term]]:
    """What is directly under each class, by whichever axiom says so."""
    below: defaultdict[Term, set[Term]] = defaultdict(set)
    for narrower, found in model.axioms.above.items():
        for wider, _ in found:
            below[wider].add(narrower)
    for known, narrowers in _META.items():
        below[known].update(narrowers)
    return below


@dataclass(eq=False)
class _Classes:
    graph: Graph
    below: Mapping[Term, AbstractSet[Term]]

    def __post_init__(self) -> None:
        self.under = cache(self._under)
        self.is_open = cache(self._is_open)
        self.within = cache(self._within)

    def _under(self, cls: Term) -> frozenset[Term]:
        """A class and everything below it."""
        found, waiting = {cls}, [cls]
        while waiting:
            further = self.below.get(waiting.pop(), frozenset()) - found
            found |= further
            waiting += further
        return frozenset(found)

    def declared(self, axiom: NamedNode) -> Iterator[tuple[NamedNode, frozenset[Term], Term]]:
        """Each property that is used and has a domain, or range, with the classes that it allows and the one it names.

        Left out are those that allow everything, or what cannot be told.
        """
        for predicate, named in self.graph.holders(axiom).items():
            if isinstance(predicate, NamedNode) and self.graph.holders(predicate):
                for cls in named:
                    if (inside := self.within(cls)) is not None:
                        yield predicate, inside, cls

    def _within(self, cls: Term) -> frozenset[Term] | None:
        """The classes whose instances are surely of ``cls``; None where that is everything, or cannot be told."""
        if cls in _ALL or not self.under(cls).isdisjoint(_ALL):
            return None
        if not isinstance(cls, BlankNode):
            return self.under(cls)
        for union in self.graph.objects(cls, owl("unionOf")):
            parts = [self.within(member) for member in self.graph.items(union) or [owl("Thing")]]
            known = [part for part in parts if part is not None]
            return self.under(cls).union(*known) if len(known) == len(parts) else None
        for intersection in self.graph.objects(cls, owl("intersectionOf")):
            parts = [self.within(member) for member in self.graph.items(intersection) or ()]
            known = [part for part in parts if part is not None]
            return self.under(cls).union(known[0].intersection(*known[1:])) if known else None
        return None

    def may_be(self, node: Term, inside: AbstractSet[Term]) -> bool:
        """Whether ``node`` is of one of the classes ``inside``, or nobody can say that it is not."""
        types = self.graph.objects(node, TYPE)
        return not types or any(one in inside for one in types) or any(map(self.is_open, types))

    def _is_open(self, cls: Term) -> bool:
        """Whether ``cls`` is under something that no file declares: what else it is under, is not known."""
        found, waiting = {cls}, [cls]
        while waiting:
            one = waiting.pop()
            if not self.graph.objects(one, TYPE) and not (isinstance(one, NamedNode) and one.value.startswith(OWL)):
                return True
            further = self.graph.objects(one, _SUBCLASS).keys() - found
            found |= further
            waiting += further
        return False
