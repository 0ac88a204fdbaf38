"""SHACL Core's constraint components as functions: the value nodes that violate one (SHACL, section 4).

A component that speaks of the value nodes together, such as ``sh:minCount``, reports ``None``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.problems import OntoError
from onto_compiler.rdf import RDF, SH, node, shorten
from onto_compiler.shacl.patterns import matcher
from onto_compiler.shacl.values import is_well_formed, less
from onto_compiler.validator.facts import Facts, Term, Values
from onto_compiler.validator.paths import items

__all__ = ["COMPONENTS", "LACKING", "Located", "Nested", "Parameter", "Test", "shape_fault"]


@dataclass(frozen=True, slots=True)
class Located:
    """A value that stands at a path of its own, as what ``sh:closed`` forbids does."""

    path: NamedNode
    value: Term


Test = Callable[[Facts, Term, Values], Sequence[Term | Located | None]]
_LANGUAGE = RDF + "langString"
_KINDS: Mapping[str, tuple[type, ...]] = {
    "IRI": (NamedNode,),
    "BlankNode": (BlankNode,),
    "Literal": (Literal,),
    "BlankNodeOrIRI": (BlankNode, NamedNode),
    "BlankNodeOrLiteral": (BlankNode, Literal),
    "IRIOrLiteral": (NamedNode, Literal),
}


class Nested(Protocol):
    """A compiled shape that another one refers to."""

    def conforms(self, facts: Facts, focus: Term) -> bool:
        """Whether ``focus`` has no violation of it."""
        ...


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of a shape: ``value`` stands in ``shapes``, and ``nested`` compiles a shape it refers to."""

    shapes: Facts
    shape: Term
    name: str
    value: Term
    nested: Callable[[Term], Nested]

    def others(self, name: str) -> Values:
        """The values of another parameter of the same shape."""
        return self.shapes.values(self.shape, node(SH + name))

    def iri(self) -> NamedNode:
        """The value as an IRI; raises SHP002 where it is none."""
        if not isinstance(self.value, NamedNode):
            raise self.fault("is no IRI")
        return self.value

    def number(self) -> int:
        """The value as a whole number; raises SHP002 where it is none."""
        try:
            return int(self.value.value)
        except ValueError:
            raise self.fault("is no whole number") from None

    def fault(self, what: str) -> OntoError:
        """The error that this parameter gives."""
        return shape_fault(self.shape, f"the value of sh:{self.name} {what}")


def shape_fault(shape: Term, message: str) -> OntoError:
    """SHP002: a shape that cannot run."""
    name = shorten(shape.value) if isinstance(shape, NamedNode) else "a shape"
    return OntoError.of("SHP002", f"`{name}` cannot run: {message}", "correct the shape; see `onto explain SHP002`")


def _class(own: Parameter) -> Test:
    cls = own.iri()
    return lambda facts, _focus, values: [value for value in values if not facts.is_a(value, cls)]


def _datatype(own: Parameter) -> Test:
    datatype = own.iri()

    def test(_facts: Facts, _focus: Term, values: Values) -> list[Term]:
        return [
            value
            for value in values
            if not isinstance(value, Literal) or value.datatype != datatype or not is_well_formed(value)
        ]

    return test


def _node_kind(own: Parameter) -> Test:
    kinds = _KINDS.get(own.iri().value.removeprefix(SH))
    if kinds is None:
        raise own.fault("is no node kind")
    return lambda _facts, _focus, values: [value for value in values if not isinstance(value, kinds)]


def _min_count(own: Parameter) -> Test:
    least = own.number()
    return lambda _facts, _focus, values: (None,) if len(values) < least else ()


def _max_count(own: Parameter) -> Test:
    most = own.number()
    return lambda _facts, _focus, values: (None,) if len(values) > most else ()


def _bound(*, most: bool, included: bool) -> Callable[[Parameter], Test]:
    def build(own: Parameter) -> Test:
        bound = own.value

        def test(_facts: Facts, _focus: Term, values: Values) -> list[Term]:
            return [v for v in values if not _before(*((v, bound) if most else (bound, v)), included=included)]

        return test

    return build


def _before(left: Term, right: Term, *, included: bool) -> bool:
    return isinstance(left, Literal) and isinstance(right, Literal) and less(left, right, or_equal=included)


def _length(fits: Callable[[int, int], bool]) -> Callable[[Parameter], Test]:
    def build(own: Parameter) -> Test:
        bound = own.number()

        def test(_facts: Facts, _focus: Term, values: Values) -> list[Term]:
            return [v for v in values if isinstance(v, BlankNode) or not fits(len(v.value), bound)]

        return test

    return build


def _pattern(own: Parameter) -> Test:
    flags = next((flag.value for flag in own.others("flags")), "")
    try:
        match = matcher(own.value.value, flags)
    except ValueError as error:
        raise shape_fault(own.shape, str(error)) from error
    return lambda _facts, _focus, values: [v for v in values if isinstance(v, BlankNode) or not match(v.value)]


def _language_in(own: Parameter) -> Test:
    ranges = [item.value.casefold() for item in items(own.shapes, own.value)]

    def fits(value: Term) -> bool:
        tag = (value.language or "").casefold() if isinstance(value, Literal) else ""
        return bool(tag) and any(each in {"*", tag} or tag.startswith(f"{each}-") for each in ranges)

    return lambda _facts, _focus, values: [value for value in values if not fits(value)]


def _unique_lang(own: Parameter) -> Test:
    if own.value.value not in {"true", "1"}:
        return lambda _facts, _focus, _values: ()

    def test(_facts: Facts, _focus: Term, values: Values) -> list[None]:
        tags = [value.language.casefold() for value in values if isinstance(value, Literal) and value.language]
        return [None for tag in dict.fromkeys(tags) if tags.count(tag) > 1]

    return test


def _has_value(own: Parameter) -> Test:
    wanted = own.value
    return lambda _facts, _focus, values: () if wanted in values else (None,)


def _in(own: Parameter) -> Test:
    allowed = frozenset(items(own.shapes, own.value))
    return lambda _facts, _focus, values: [value for value in values if value not in allowed]


def _equals(own: Parameter) -> Test:
    other = own.iri()

    def test(facts: Facts, focus: Term, values: Values) -> list[Term]:
        there = facts.values(focus, other)
        return [*(v for v in values if v not in there), *(v for v in there if v not in values)]

    return test


def _disjoint(own: Parameter) -> Test:
    other = own.iri()
    return lambda facts, focus, values: [value for value in values if value in facts.values(focus, other)]


def _less_than(*, included: bool) -> Callable[[Parameter], Test]:
    def build(own: Parameter) -> Test:
        other = own.iri()

        def test(facts: Facts, focus: Term, values: Values) -> list[Term]:
            there = facts.values(focus, other)
            return [value for value in values for bound in there if not _before(value, bound, included=included)]

        return test

    return build


def _node(own: Parameter) -> Test:
    shape = own.nested(own.value)
    return lambda facts, _focus, values: [value for value in values if not shape.conforms(facts, value)]


def _not(own: Parameter) -> Test:
    shape = own.nested(own.value)
    return lambda facts, _focus, values: [value for value in values if shape.conforms(facts, value)]


def _count(fits: Callable[[int, int], bool]) -> Callable[[Parameter], Test]:
    def build(own: Parameter) -> Test:
        shapes = [own.nested(item) for item in items(own.shapes, own.value)]

        def test(facts: Facts, _focus: Term, values: Values) -> list[Term]:
            return [v for v in values if not fits(sum(s.conforms(facts, v) for s in shapes), len(shapes))]

        return test

    return build


def _qualified(own: Parameter, fits: Callable[[int, int], bool]) -> Test:
    bound = own.number()
    shapes = [own.nested(shape) for shape in own.others("qualifiedValueShape")]
    siblings = [own.nested(shape) for shape in _siblings(own)]

    def counts(facts: Facts, value: Term, shape: Nested) -> bool:
        return shape.conforms(facts, value) and not any(each.conforms(facts, value) for each in siblings)

    def test(facts: Facts, _focus: Term, values: Values) -> list[None]:
        return [None for shape in shapes if not fits(sum(counts(facts, v, shape) for v in values), bound)]

    return test


def _siblings(own: Parameter) -> list[Term]:
    """The other value shapes of the same parents, where ``sh:qualifiedValueShapesDisjoint`` asks for them."""
    if not any(value.value in {"true", "1"} for value in own.others("qualifiedValueShapesDisjoint")):
        return []
    key, mine = node(SH + "qualifiedValueShape"), own.others("qualifiedValueShape")
    parents = own.shapes.subjects(node(SH + "property"), own.shape)
    properties = [each for parent in parents for each in own.shapes.values(parent, node(SH + "property"))]
    return [shape for each in properties for shape in own.shapes.values(each, key) if shape not in mine]


def _closed(own: Parameter) -> Test:
    if own.value.value not in {"true", "1"}:
        return lambda _facts, _focus, _values: ()
    allowed = {item for head in own.others("ignoredProperties") for item in items(own.shapes, head)}
    allowed |= {path for each in own.others("property") for path in own.shapes.values(each, node(SH + "path"))}

    def test(facts: Facts, _focus: Term, values: Values) -> list[Located]:
        return [
            Located(predicate, found)
            for value in values
            for predicate, objects in facts.about(value).items()
            if predicate not in allowed
            for found in objects
        ]

    return test


COMPONENTS: Mapping[str, Callable[[Parameter], Test]] = {
    "and": _count(operator.eq),
    "class": _class,
    "closed": _closed,
    "datatype": _datatype,
    "disjoint": _disjoint,
    "equals": _equals,
    "hasValue": _has_value,
    "in": _in,
    "languageIn": _language_in,
    "lessThan": _less_than(included=False),
    "lessThanOrEquals": _less_than(included=True),
    "maxCount": _max_count,
    "maxExclusive": _bound(most=True, included=False),
    "maxInclusive": _bound(most=True, included=True),
    "maxLength": _length(operator.le),
    "minCount": _min_count,
    "minExclusive": _bound(most=False, included=False),
    "minInclusive": _bound(most=False, included=True),
    "minLength": _length(operator.ge),
    "node": _node,
    "nodeKind": _node_kind,
    "not": _not,
    "or": _count(lambda true, _all: true > 0),
    "pattern": _pattern,
    "qualifiedMaxCount": lambda own: _qualified(own, operator.le),
    "qualifiedMinCount": lambda own: _qualified(own, operator.ge),
    "uniqueLang": _unique_lang,
    "xone": _count(lambda true, _all: true == 1),
}

LACKING = frozenset({"equals", "hasValue", "minCount", "qualifiedMinCount"})  # what no value at all can violate
