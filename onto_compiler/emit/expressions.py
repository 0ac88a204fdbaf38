"""OWL class expressions as SHACL constraints on a node, read under a closed world.

Source: OWL 2 Mapping to RDF Graphs (W3C, 2012), section 3; SHACL (W3C, 2017), section 4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.emit.tbox import TBox, Term
from onto_compiler.emit.turtle import Blank, Pair, Seq, Value, iri_text, term_text
from onto_compiler.rdf import OWL, RDFS, XSD

__all__ = ["NotExpressed", "expression", "path"]

_DEPTH = 16  # a class expression that is nested deeper is taken for one without end
_COUNTS = {
    "minCardinality": ("sh:minCount",),
    "maxCardinality": ("sh:maxCount",),
    "cardinality": ("sh:minCount", "sh:maxCount"),
    "minQualifiedCardinality": ("sh:qualifiedMinCount",),
    "maxQualifiedCardinality": ("sh:qualifiedMaxCount",),
    "qualifiedCardinality": ("sh:qualifiedMinCount", "sh:qualifiedMaxCount"),
}
_FACETS = {
    "minInclusive": "sh:minInclusive",
    "maxInclusive": "sh:maxInclusive",
    "minExclusive": "sh:minExclusive",
    "maxExclusive": "sh:maxExclusive",
    "minLength": "sh:minLength",
    "maxLength": "sh:maxLength",
    "pattern": "sh:pattern",
}
_REPEATABLE = {"sh:class", "sh:property", "sh:not", "sh:or", "sh:and", "sh:hasValue"}


class NotExpressed(Exception):  # noqa: N818 - it is caught where the axiom is left out, and is not a user's error
    """An axiom that SHACL Core cannot express; its text says which."""


def expression(tbox: TBox, term: Term, depth: int = _DEPTH) -> tuple[Pair, ...]:
    """The constraints that every member of the class or datatype ``term`` meets; none for ``owl:Thing``.

    Raises:
        NotExpressed: where SHACL Core cannot say it.
    """
    if depth == 0:
        raise NotExpressed("a class expression that is nested without end")
    if isinstance(term, NamedNode):
        return _named(tbox, term.value)
    if isinstance(term, Literal):
        raise NotExpressed("a literal in the place of a class")
    for name, form in _FORMS.items():
        for value in tbox.values(term, OWL + name):
            return form(tbox, term, value, depth - 1)
    raise NotExpressed("a class expression of unknown form")


def path(tbox: TBox, term: Term) -> Value:
    """A property, or the inverse of one, as ``sh:path``."""
    if isinstance(term, NamedNode):
        return iri_text(term.value)
    inverse = tbox.iris(term, OWL + "inverseOf")
    if not inverse:
        raise NotExpressed("a property expression of unknown form")
    return Blank((("sh:inversePath", iri_text(inverse[0])),))


def _named(tbox: TBox, iri: str) -> tuple[Pair, ...]:
    if iri in {OWL + "Thing", RDFS + "Resource"}:
        return ()
    if iri == OWL + "Nothing":
        return (("sh:in", Seq(())),)
    if iri == RDFS + "Literal":
        return (("sh:nodeKind", "sh:Literal"),)
    return ((("sh:datatype" if tbox.is_datatype(iri) else "sh:class"), iri_text(iri)),)


def _restriction(tbox: TBox, term: Term, prop: Term, depth: int) -> tuple[Pair, ...]:
    pairs: list[Pair] = [("sh:path", path(tbox, prop))]
    pairs += _filled(tbox, term, depth)
    if len(pairs) == 1:
        raise NotExpressed("owl:hasSelf, or a restriction without a filler")
    return (("sh:property", Blank(tuple(pairs))),)


def _filled(tbox: TBox, term: Term, depth: int) -> Iterator[Pair]:
    for filler in tbox.values(term, OWL + "allValuesFrom"):
        yield from expression(tbox, filler, depth)
    for filler in tbox.values(term, OWL + "someValuesFrom"):
        inner = expression(tbox, filler, depth)
        if inner:
            yield ("sh:qualifiedValueShape", Blank(inner))
        yield (("sh:qualifiedMinCount" if inner else "sh:minCount"), "1")
    for filler in tbox.values(term, OWL + "hasValue"):
        if isinstance(filler, BlankNode):
            raise NotExpressed("owl:hasValue of a blank node")
        yield ("sh:hasValue", term_text(filler))
    yield from _counted(tbox, term, depth)


def _counted(tbox: TBox, term: Term, depth: int) -> Iterator[Pair]:
    on = (*tbox.values(term, OWL + "onClass"), *tbox.values(term, OWL + "onDataRange"))
    inner = expression(tbox, on[0], depth) if on else ()
    for name, counts in _COUNTS.items():
        for number in tbox.values(term, OWL + name):
            if not number.value.isdecimal():
                raise NotExpressed(f"owl:{name} that is no number")
            if inner:
                yield ("sh:qualifiedValueShape", Blank(inner))
            for count in counts:
                yield (count if inner else count.replace("qualifiedM", "m"), str(int(number.value)))


def _intersection(tbox: TBox, _: Term, head: Term, depth: int) -> tuple[Pair, ...]:
    parts = [expression(tbox, member, depth) for member in tbox.items(head)]
    flat = tuple(sorted({pair for part in parts for pair in part}, key=str))
    if all(name in _REPEATABLE for name, _ in flat):
        return flat
    return (("sh:and", _alternatives(parts)),)


def _union(tbox: TBox, _: Term, head: Term, depth: int) -> tuple[Pair, ...]:
    parts = [expression(tbox, member, depth) for member in tbox.items(head)]
    if not parts:
        return (("sh:in", Seq(())),)
    return (("sh:or", _alternatives(parts)),) if all(parts) else ()


def _alternatives(parts: list[tuple[Pair, ...]]) -> Seq:
    return Seq(tuple(sorted({Blank(part) for part in parts if part}, key=str)))


def _complement(tbox: TBox, _: Term, other: Term, depth: int) -> tuple[Pair, ...]:
    inner = expression(tbox, other, depth)
    return (("sh:not", Blank(inner)),) if inner else (("sh:in", Seq(())),)


def _one_of(tbox: TBox, _: Term, head: Term, depth: int) -> tuple[Pair, ...]:  # noqa: ARG001 - as the other forms
    members = tbox.items(head)
    if any(isinstance(member, BlankNode) for member in members):
        raise NotExpressed("owl:oneOf with a blank node")
    texts = sorted(term_text(member) for member in members if not isinstance(member, BlankNode))
    return (("sh:in", Seq(tuple(texts))),)


def _facets(tbox: TBox, term: Term, base: Term, depth: int) -> tuple[Pair, ...]:
    pairs = list(expression(tbox, base, depth))
    for head in tbox.values(term, OWL + "withRestrictions"):
        for facet in tbox.items(head):
            facets = [(shacl, value) for name, shacl in _FACETS.items() for value in tbox.values(facet, XSD + name)]
            if not facets:
                raise NotExpressed("a facet that SHACL lacks")
            pairs += [(shacl, term_text(value)) for shacl, value in facets if not isinstance(value, BlankNode)]
    return tuple(pairs)


_FORMS: dict[str, Callable[[TBox, Term, Term, int], tuple[Pair, ...]]] = {
    "onProperty": _restriction,
    "intersectionOf": _intersection,
    "unionOf": _union,
    "complementOf": _complement,
    "datatypeComplementOf": _complement,
    "oneOf": _one_of,
    "onDatatype": _facets,
}
