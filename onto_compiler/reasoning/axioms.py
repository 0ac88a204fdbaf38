"""The axioms of a store, indexed by what they wait for. Each keeps the triple that it was read from.

Source: the OWL 2 mapping to RDF graphs, sections 3.2.4 and 3.2.5.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode, Store

from onto_compiler.rdf import OWL, RDF, RDFS

__all__ = ["TYPE", "Axioms", "Fact", "Term", "disjoint_groups", "owl", "read_axioms"]

Term = NamedNode | BlankNode | Literal
Fact = tuple[Term, Term, Term]
TYPE = NamedNode(RDF + "type")
_FIRST, _REST, _NIL = (NamedNode(RDF + name) for name in ("first", "rest", "nil"))

# Term -> the groups that it is a member of; any two of one group are held apart.
Groups = defaultdict[Term, list[tuple[frozenset[Term], Fact]]]


def owl(name: str) -> NamedNode:
    """A term of OWL."""
    return NamedNode(OWL + name)


def _index() -> defaultdict[Term, list[tuple[Term, Fact]]]:
    return defaultdict(list)


@dataclass
class Axioms:
    """``above[c]`` are the classes that every instance of ``c`` belongs to, and so on; each with its triple."""

    above: defaultdict[Term, list[tuple[Term, Fact]]] = field(default_factory=_index)
    wider: defaultdict[Term, list[tuple[Term, Fact]]] = field(default_factory=_index)  # property -> property
    inverse: defaultdict[Term, list[tuple[Term, Fact]]] = field(default_factory=_index)
    domain: defaultdict[Term, list[tuple[Term, Fact]]] = field(default_factory=_index)
    range: defaultdict[Term, list[tuple[Term, Fact]]] = field(default_factory=_index)
    disjoint: Groups = field(default_factory=lambda: defaultdict(list))
    disjoint_property: Groups = field(default_factory=lambda: defaultdict(list))
    different: Groups = field(default_factory=lambda: defaultdict(list))
    marks: dict[tuple[Term, str], Fact] = field(default_factory=dict)  # (property, "TransitiveProperty")
    both: defaultdict[Term, list[tuple[Term, tuple[Term, ...], Fact]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    some: defaultdict[Term, list[tuple[Term, Term, Fact]]] = field(default_factory=lambda: defaultdict(list))
    some_of: defaultdict[Term, list[tuple[Term, Term, Fact]]] = field(default_factory=lambda: defaultdict(list))
    only: defaultdict[Term, list[tuple[Term, Term, Fact]]] = field(default_factory=lambda: defaultdict(list))
    value: defaultdict[Term, list[tuple[Term, Term, Fact]]] = field(default_factory=lambda: defaultdict(list))
    has_value: defaultdict[tuple[Term, Term], list[tuple[Term, Fact]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    at_most: defaultdict[Term, list[tuple[Term, int, Term | None, Fact]]] = field(
        default_factory=lambda: defaultdict(list)
    )
    negative: dict[Fact, Fact] = field(default_factory=dict)
    facts: list[tuple[Fact, Fact]] = field(default_factory=list)  # what an axiom says of an individual
    properties: set[Term] = field(default_factory=set)  # those whose assertions can matter


_MARKS = (
    "FunctionalProperty",
    "InverseFunctionalProperty",
    "TransitiveProperty",
    "SymmetricProperty",
    "AsymmetricProperty",
    "IrreflexiveProperty",
)


def read_axioms(store: Store) -> Axioms:
    """Every axiom of all graphs of ``store``."""
    found = Axioms()
    _classes(store, found)
    _restrictions(store, found)
    _properties(store, found)
    _individuals(store, found)
    return found


def _triples(store: Store, predicate: NamedNode, object_: Term | None = None) -> Iterator[Fact]:
    for quad in store.quads_for_pattern(None, predicate, object_, None):
        yield cast("Fact", (quad.subject, quad.predicate, quad.object))


def _list(store: Store, head: Term) -> tuple[Term, ...]:
    items: list[Term] = []
    seen: set[Term] = set()
    while head != _NIL and head not in seen and not isinstance(head, Literal):
        seen.add(head)
        first = next(store.quads_for_pattern(head, _FIRST, None, None), None)
        rest = next(store.quads_for_pattern(head, _REST, None, None), None)
        if first is None or rest is None:
            break
        items.append(cast("Term", first.object))
        head = cast("Term", rest.object)
    return tuple(items)


def _apart(index: Groups, members: tuple[Term, ...], fact: Fact) -> None:
    """Hold ``members`` apart; a group of one is held apart from itself, as is each that is named twice."""
    group = frozenset(members)  # shared: a list of n has n²/2 pairs
    for one, times in Counter(members).items():
        if times > 1:
            index[one].append((frozenset((one,)), fact))
    if owl("Thing") in group:
        for one in group - {owl("Thing")}:
            index[one].append((frozenset((one,)), fact))
    elif len(group) > 1:
        for one in group:
            index[one].append((group, fact))


def _classes(store: Store, found: Axioms) -> None:
    for fact in _triples(store, NamedNode(RDFS + "subClassOf")):
        found.above[fact[0]].append((fact[2], fact))
    for fact in _triples(store, owl("equivalentClass")):
        found.above[fact[0]].append((fact[2], fact))
        found.above[fact[2]].append((fact[0], fact))
    for fact in _triples(store, owl("intersectionOf")):
        members = _list(store, fact[2])
        for member in members:
            found.above[fact[0]].append((member, fact))
            found.both[member].append((fact[0], members, fact))
    _unions(store, found)
    _disjointness(store, found)


def _unions(store: Store, found: Axioms) -> None:
    for name in ("unionOf", "disjointUnionOf"):
        for fact in _triples(store, owl(name)):
            members = _list(store, fact[2])
            for member in members:
                found.above[member].append((fact[0], fact))
            if name == "disjointUnionOf":
                _apart(found.disjoint, members, fact)
    for fact in _triples(store, owl("oneOf")):
        found.facts += [((member, TYPE, fact[0]), fact) for member in _list(store, fact[2])]


def disjoint_groups(store: Store) -> list[frozenset[Term]]:
    """The classes that ``owl:disjointWith`` and ``owl:AllDisjointClasses`` hold apart, together."""
    return [frozenset(members) for members, _ in _declared_disjoint(store)]


def _declared_disjoint(store: Store) -> Iterator[tuple[tuple[Term, ...], Fact]]:
    for fact in _triples(store, owl("disjointWith")):
        yield (fact[0], fact[2]), fact
    for group in _triples(store, TYPE, owl("AllDisjointClasses")):
        for fact in _of(store, group[0], "members"):
            yield _list(store, fact[2]), fact


def _disjointness(store: Store, found: Axioms) -> None:
    for members, fact in _declared_disjoint(store):
        _apart(found.disjoint, members, fact)
    for fact in _triples(store, owl("complementOf")):
        _apart(found.disjoint, (fact[0], fact[2]), fact)


def _of(store: Store, subject: Term, *names: str) -> Iterator[Fact]:
    for name in names:
        for quad in store.quads_for_pattern(subject, owl(name), None, None):  # type: ignore[arg-type]
            yield cast("Fact", (quad.subject, quad.predicate, quad.object))


def _restrictions(store: Store, found: Axioms) -> None:
    for restriction, _, prop in _triples(store, owl("onProperty")):
        found.properties.add(prop)
        for fact in _of(store, restriction, "someValuesFrom"):
            found.some[prop].append((restriction, fact[2], fact))
            found.some_of[fact[2]].append((restriction, prop, fact))
        for fact in _of(store, restriction, "allValuesFrom"):
            found.only[restriction].append((prop, fact[2], fact))
        for fact in _of(store, restriction, "hasValue"):
            found.value[restriction].append((prop, fact[2], fact))
            found.has_value[prop, fact[2]].append((restriction, fact))
        qualifier = next((fact[2] for fact in _of(store, restriction, "onClass")), None)
        names = ("maxCardinality", "cardinality", "maxQualifiedCardinality", "qualifiedCardinality")
        for fact in _of(store, restriction, *names):
            number = cast("Literal", fact[2]).value
            if number in {"0", "1"}:
                found.at_most[restriction].append((prop, int(number), qualifier, fact))


def _properties(store: Store, found: Axioms) -> None:
    for name, index in (("subPropertyOf", found.wider), ("domain", found.domain), ("range", found.range)):
        for fact in _triples(store, NamedNode(RDFS + name)):
            index[fact[0]].append((fact[2], fact))
    for fact in _triples(store, owl("equivalentProperty")):
        found.wider[fact[0]].append((fact[2], fact))
        found.wider[fact[2]].append((fact[0], fact))
    for fact in _triples(store, owl("inverseOf")):
        found.inverse[fact[0]].append((fact[2], fact))
        found.inverse[fact[2]].append((fact[0], fact))
    for fact in _triples(store, owl("propertyDisjointWith")):
        _apart(found.disjoint_property, (fact[0], fact[2]), fact)
    for mark in _MARKS:
        for fact in _triples(store, TYPE, owl(mark)):
            found.marks[fact[0], mark] = fact
            found.properties.add(fact[0])
    for index in (found.wider, found.domain, found.range, found.inverse):
        found.properties |= index.keys()
    found.properties |= found.disjoint_property.keys()


def _individuals(store: Store, found: Axioms) -> None:
    for fact in _triples(store, owl("differentFrom")):
        _apart(found.different, (fact[0], fact[2]), fact)
    for group in _triples(store, TYPE, owl("AllDifferent")):
        for fact in _of(store, group[0], "members", "distinctMembers"):
            _apart(found.different, _list(store, fact[2]), fact)
    for source, _, subject in _triples(store, owl("sourceIndividual")):
        for fact in _of(store, source, "assertionProperty"):
            for target in _of(store, source, "targetIndividual", "targetValue"):
                found.negative[subject, fact[2], target[2]] = fact
                found.properties.add(fact[2])
