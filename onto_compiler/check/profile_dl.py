"""What RDF can say and OWL 2 DL cannot: broken expressions, and the global restrictions that can be read off triples.

Source: OWL 2 Structural Specification, sections 3, 5.8 and 11 (global restrictions); OWL 2 Mapping to RDF Graphs,
section 3.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, RDF, RDFS, XSD, shorten
from onto_compiler.reasoning.axioms import TYPE, owl
from onto_compiler.reasoning.reach import circles

__all__ = ["CARDINALITIES", "FILLERS", "check_dl", "read_list"]

_FIRST, _REST, _NIL = (NamedNode(RDF + name) for name in ("first", "rest", "nil"))
_CHAIN, _ON = owl("propertyChainAxiom"), owl("onProperty")
CARDINALITIES = tuple(
    owl(name)
    for kind in ("Cardinality", "QualifiedCardinality")
    for name in (f"min{kind}", f"max{kind}", kind[0].lower() + kind[1:])
)
FILLERS = (*map(owl, ("someValuesFrom", "allValuesFrom", "hasValue", "hasSelf")), *CARDINALITIES)
_LISTS = (
    *map(owl, ("intersectionOf", "unionOf", "oneOf", "disjointUnionOf", "members", "distinctMembers")),
    _CHAIN,
)
_SORTS = ("ObjectProperty", "DatatypeProperty", "AnnotationProperty")
_SIMPLE = ("FunctionalProperty", "InverseFunctionalProperty", "IrreflexiveProperty", "AsymmetricProperty")
_DEFINING = (
    *(NamedNode(RDFS + name) for name in ("subClassOf", "subPropertyOf", "domain", "range")),
    owl("equivalentClass"),
    owl("disjointWith"),
)
Triple = tuple[Term, NamedNode, Term]


def check_dl(model: Model) -> Iterator[Finding]:
    """OWL011 for expressions that say nothing, OWL012 to OWL015 for what OWL 2 DL leaves out."""
    yield from _restrictions(model)
    yield from _lists(model)
    yield from _two_sorts(model)
    yield from _reserved(model)
    yield from _composite(model)
    yield from _irregular(model)


def read_list(model: Model, head: Term) -> tuple[Term, ...] | None:
    """The members of an RDF list; None if it is broken."""
    items: list[Term] = []
    seen: set[Term] = set()
    while head != _NIL:
        if isinstance(head, Literal) or head in seen:
            return None
        seen.add(head)
        first, rest = ([o for _, _, o in _triples(model, head, each)] for each in (_FIRST, _REST))
        if len(first) != 1 or len(rest) != 1:
            return None
        items += first
        head = rest[0]
    return tuple(items)


def _triples(model: Model, subject: Term | None, predicate: NamedNode, value: Term | None = None) -> Iterator[Triple]:
    found = model.store.quads_for_pattern(subject, predicate, value, None)  # type: ignore[arg-type]
    return (cast("Triple", (quad.subject, quad.predicate, quad.object)) for quad in found)


def _finding(code: str, message: str, hint: str, at: Triple, severity: str = "warning") -> Finding:
    return Finding(code, severity, message, hint, *at, general=True)


def _restrictions(model: Model) -> Iterator[Finding]:
    fillers: dict[Term, Triple] = {}
    for filler in FILLERS:
        for triple in _triples(model, None, filler):
            fillers.setdefault(triple[0], triple)
    on = {triple[0]: triple for triple in _triples(model, None, _ON)}
    typed = {triple[0]: triple for triple in _triples(model, None, TYPE, owl("Restriction"))}
    for node, triple in {**typed, **fillers}.items():
        if node not in on:
            message = "a restriction without owl:onProperty restricts nothing"
            yield _finding("OWL011", message, "say which property it is on", triple, "error")
    for node, triple in on.items():
        if node not in fillers:
            message = "this restriction says nothing of `{object}`"
            hint = "add owl:someValuesFrom, owl:allValuesFrom, owl:hasValue or a cardinality"
            yield _finding("OWL011", message, hint, triple, "error")


def _lists(model: Model) -> Iterator[Finding]:
    for predicate in _LISTS:
        for triple in _triples(model, None, predicate):
            if read_list(model, triple[2]) is None:
                message = f"the value of {shorten(predicate.value)} is no list"
                yield _finding("OWL011", message, "write its members in parentheses: `( ex:A ex:B )`", triple, "error")


def _two_sorts(model: Model) -> Iterator[Finding]:
    for sorts in ([owl(sort) for sort in _SORTS], [owl("Class"), NamedNode(RDFS + "Datatype")]):
        known: dict[Term, NamedNode] = {}
        for sort in sorts:
            for triple in _triples(model, None, TYPE, sort):
                if isinstance(triple[0], NamedNode) and known.setdefault(triple[0], sort) != sort:
                    message = f"`{{subject}}` is both {shorten(known[triple[0]].value)} and {shorten(sort.value)}"
                    yield _finding("OWL012", message, "keep one of the two, or use two names", triple)


def _reserved(model: Model) -> Iterator[Finding]:
    message = "`{term}` is a word of RDF or OWL itself, which OWL 2 DL lets no axiom speak of"
    annotating = {triple[0] for triple in _triples(model, None, TYPE, owl("AnnotationProperty"))}
    for predicate in _DEFINING:
        for triple in _triples(model, None, predicate):
            if triple[0] in annotating and not _is_reserved(triple[0]):
                continue  # annotations mean nothing to a reasoner, and neither do their domain and range
            for term in (triple[0], triple[2]):
                if _is_reserved(term):
                    hint = "use a term of your own"
                    yield Finding("OWL013", "warning", message, hint, *triple, values={"term": term}, general=True)


def _is_reserved(term: Term) -> bool:
    if not isinstance(term, NamedNode) or not term.value.startswith((OWL, RDF, RDFS)):
        return False
    datatypes = {RDF + "PlainLiteral", RDF + "langString", RDF + "XMLLiteral", RDFS + "Literal", XSD + "string"}
    numbers = {OWL + "real", OWL + "rational"}
    built_in = {OWL + name for name in ("Thing", "Nothing", "topObjectProperty", "topDataProperty")}
    return term.value not in datatypes | numbers | built_in


def _composite(model: Model) -> Iterator[Finding]:
    composite = {triple[0] for triple in _triples(model, None, TYPE, owl("TransitiveProperty"))}
    composite |= {triple[0] for triple in _triples(model, None, _CHAIN)}
    wider: defaultdict[Term, set[Term]] = defaultdict(set)
    for sub, _, upper in _triples(model, None, NamedNode(RDFS + "subPropertyOf")):
        wider[sub].add(upper)
    for name in ("equivalentProperty", "inverseOf"):
        for one, _, other in _triples(model, None, owl(name)):
            wider[one].add(other)
            wider[other].add(one)
    waiting = list(composite)
    while waiting:
        further = wider[waiting.pop()] - composite
        composite |= further
        waiting += further
    for triple in _uses_of_simple(model):
        subject, predicate, value = triple
        for prop in {value, subject} & composite if predicate != TYPE else {subject} & composite:
            message = "`{property}` is transitive or implied by a chain, and OWL 2 DL counts and excludes none of those"
            hint = "leave out this axiom, or the transitivity"
            yield Finding("OWL014", "warning", message, hint, *triple, values={"property": prop}, general=True)


def _uses_of_simple(model: Model) -> Iterator[Triple]:
    for mark in _SIMPLE:
        yield from _triples(model, None, TYPE, owl(mark))
    yield from _triples(model, None, owl("propertyDisjointWith"))
    counted = {triple[0] for each in (*CARDINALITIES, owl("hasSelf")) for triple in _triples(model, None, each)}
    yield from (triple for triple in _triples(model, None, _ON) if triple[0] in counted)


def _irregular(model: Model) -> Iterator[Finding]:
    edges: defaultdict[Term, list[Term]] = defaultdict(list)
    for sub, _, upper in _triples(model, None, NamedNode(RDFS + "subPropertyOf")):
        edges[sub].append(upper)
    chains = [(triple, read_list(model, triple[2]) or ()) for triple in _triples(model, None, _CHAIN)]
    for (whole, _, _), links in chains:
        for link in links:
            if link != whole:
                edges[link].append(whole)
    circle = {node: number for number, found in enumerate(circles(edges)) for node in found}
    for triple, links in chains:
        whole = triple[0]
        within = any(circle.get(link) == circle.get(whole) for link in links if link != whole)
        if within or (whole in links[1:-1]) or (len(links) > 2 and links[0] == whole == links[-1]):
            message = "the chain of `{subject}` leads back to it, which OWL 2 DL allows at one end of the chain alone"
            yield _finding("OWL015", message, "break the circle: chain properties that do not follow from it", triple)
