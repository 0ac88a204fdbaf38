"""The Core components that test value nodes one by one or together without other shapes (SHACL, 4.1-4.5, 4.8).

A builder takes one parameter and yields the checks that it stands for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.rdf import SH
from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Check, Custom, Hit, PerValue, Run, Whole
from onto_compiler.shacl.patterns import matcher
from onto_compiler.shacl.reader import Parameter
from onto_compiler.shacl.values import is_well_formed, less
from onto_compiler.terms import text_of
from onto_compiler.wording import plural

__all__ = ["COMPONENTS", "Builder"]

Builder = Callable[[Parameter], Iterator[Check]]

_KINDS: Mapping[str, tuple[type, ...]] = {
    "IRI": (NamedNode,),
    "BlankNode": (BlankNode,),
    "Literal": (Literal,),
    "BlankNodeOrIRI": (BlankNode, NamedNode),
    "BlankNodeOrLiteral": (BlankNode, Literal),
    "IRIOrLiteral": (NamedNode, Literal),
}


def _component(own: Parameter) -> str:
    return f"{own.name[:1].upper()}{own.name[1:]}ConstraintComponent"


def _no_blank(own: Parameter, terms: Iterable[Term]) -> None:
    if any(isinstance(term, BlankNode) for term in terms):
        raise own.fault(f"a blank node cannot be the value of sh:{own.name}")


def _class(own: Parameter) -> Iterator[Check]:
    wanted = own.iri()

    def test(run: Run, value: Term) -> bool:
        return run.data.is_a(value, wanted)

    yield PerValue(_component(own), test, ("must be an instance of ", wanted))


def _datatype(own: Parameter) -> Iterator[Check]:
    datatype = own.iri()

    def test(_: Run, value: Term) -> bool:
        return isinstance(value, Literal) and value.datatype == datatype and is_well_formed(value)

    yield PerValue(_component(own), test, ("must be a literal of the datatype ", datatype))


def _node_kind(own: Parameter) -> Iterator[Check]:
    kind = text_of(own.value).removeprefix(SH)
    if kind not in _KINDS:
        raise own.fault(f"`{kind}` is no node kind of SHACL")
    classes = _KINDS[kind]

    def test(_: Run, value: Term) -> bool:
        return isinstance(value, classes)

    yield PerValue(_component(own), test, f"must be of the node kind `sh:{kind}`")


def _count(*, least: bool) -> Builder:
    def build(own: Parameter) -> Iterator[Check]:
        limit = own.number()

        def find(_: Run, __: Term, values: Sequence[Term]) -> Iterable[Term | None]:
            found = len(values)
            return (None,) if (found < limit if least else found > limit) else ()

        noun = plural(limit, "value")
        yield Whole(_component(own), find, f"must have at {'least' if least else 'most'} {limit} {noun}")

    return build


def _range(sign: str) -> Builder:
    def build(own: Parameter) -> Iterator[Check]:
        bound = own.literal()
        or_equal = "=" in sign

        def test(_: Run, value: Term) -> bool:
            if not isinstance(value, Literal):
                return False
            pair = (bound, value) if sign[0] == ">" else (value, bound)
            return less(*pair, or_equal=or_equal)

        yield PerValue(_component(own), test, (f"must be {sign} ", bound))

    return build


def _length(*, least: bool) -> Builder:
    def build(own: Parameter) -> Iterator[Check]:
        limit = own.number()

        def test(_: Run, value: Term) -> bool:
            if isinstance(value, (BlankNode, Triple)):
                return False
            return len(value.value) >= limit if least else len(value.value) <= limit

        yield PerValue(_component(own), test, f"must have at {'least' if least else 'most'} {limit} characters")

    return build


def _pattern(own: Parameter) -> Iterator[Check]:
    pattern = own.literal().value
    flags = "".join(text_of(flag) for flag in own.others("flags")[:1])
    try:
        match = matcher(pattern, flags)
    except ValueError as error:
        raise own.fault(str(error)) from error

    def test(_: Run, value: Term) -> bool:
        return not isinstance(value, (BlankNode, Triple)) and match(value.value)

    yield PerValue(_component(own), test, f"must match the pattern `{pattern}`")


def _language_in(own: Parameter) -> Iterator[Check]:
    ranges = [text_of(item).lower() for item in own.items()]

    def test(_: Run, value: Term) -> bool:
        language = value.language.lower() if isinstance(value, Literal) and value.language else ""
        return bool(language) and any(one in {"*", language} or language.startswith(one + "-") for one in ranges)

    yield PerValue(_component(own), test, f"must be in one of the languages {', '.join(ranges)}")


def _unique_lang(own: Parameter) -> Iterator[Check]:
    if text_of(own.value) != "true":  # of "1" the specification does not speak
        return

    def find(_: Run, __: Term, values: Sequence[Term]) -> Iterable[Term | None]:
        languages = [value.language.lower() for value in values if isinstance(value, Literal) and value.language]
        return [None for one in dict.fromkeys(languages) if languages.count(one) > 1]

    yield Whole(_component(own), find, "must not have two values in one language")


def _equals(own: Parameter) -> Iterator[Check]:
    other = own.iri()

    def find(run: Run, focus: Term, values: Sequence[Term]) -> Iterable[Term | None]:
        compared = run.data.objects(focus, other)
        mine = set(values)
        return [*(v for v in values if v not in compared), *(v for v in compared if v not in mine)]

    yield Whole(_component(own), find, ("must have the same values as ", other))


def _disjoint(own: Parameter) -> Iterator[Check]:
    other = own.iri()

    def find(run: Run, focus: Term, values: Sequence[Term]) -> Iterable[Term | None]:
        compared = run.data.objects(focus, other)
        return [value for value in values if value in compared]

    yield Whole(_component(own), find, ("must not have a value that ", other, " has"))


def _less_than(*, or_equal: bool) -> Builder:
    def build(own: Parameter) -> Iterator[Check]:
        other = own.iri()

        def find(run: Run, focus: Term, values: Sequence[Term]) -> Iterable[Term | None]:
            compared = run.data.objects(focus, other)
            return [value for value in values for bound in compared if not _before(value, bound, or_equal=or_equal)]

        yield Whole(_component(own), find, (f"must be {'<=' if or_equal else '<'} each value of ", other))

    return build


def _before(value: Term, bound: Term, *, or_equal: bool) -> bool:
    return isinstance(value, Literal) and isinstance(bound, Literal) and less(value, bound, or_equal=or_equal)


def _has_value(own: Parameter) -> Iterator[Check]:
    wanted = own.value
    _no_blank(own, [wanted])

    def find(_: Run, __: Term, values: Sequence[Term]) -> Iterable[Term | None]:
        return () if wanted in values else (None,)

    yield Whole(_component(own), find, ("must have the value ", wanted))


def _in(own: Parameter) -> Iterator[Check]:
    members = own.items()
    _no_blank(own, members)
    allowed = frozenset(members)

    def test(_: Run, value: Term) -> bool:
        return value in allowed

    yield PerValue(_component(own), test, ("must be one of ", *_listed(members)))


def _listed(members: Sequence[Term]) -> Iterator[str | Term]:
    for number, member in enumerate(members):
        yield from (", ", member) if number else (member,)


def _closed(own: Parameter) -> Iterator[Check]:
    if not own.reader.is_true(own.shape, "closed"):
        return
    allowed = {path for one in own.others("property") for path in own.reader.values(one, "path")}
    for head in own.others("ignoredProperties"):
        members = own.reader.graph.items(head)
        if members is None:
            raise own.fault("the list of ignored properties does not end")
        allowed.update(members)

    def find(run: Run, _: Term, values: Sequence[Term]) -> Iterable[Hit]:
        for node in values:
            for predicate in run.data.predicates(node):
                if predicate not in allowed:
                    yield from (Hit(value, predicate) for value in run.data.objects(node, predicate))

    yield Custom(_component(own), find, "must have no property that the shape does not name")


COMPONENTS: Mapping[str, Builder] = {
    "class": _class,
    "closed": _closed,
    "datatype": _datatype,
    "disjoint": _disjoint,
    "equals": _equals,
    "hasValue": _has_value,
    "in": _in,
    "languageIn": _language_in,
    "lessThan": _less_than(or_equal=False),
    "lessThanOrEquals": _less_than(or_equal=True),
    "maxCount": _count(least=False),
    "maxExclusive": _range("<"),
    "maxInclusive": _range("<="),
    "maxLength": _length(least=False),
    "minCount": _count(least=True),
    "minExclusive": _range(">"),
    "minInclusive": _range(">="),
    "minLength": _length(least=True),
    "nodeKind": _node_kind,
    "pattern": _pattern,
    "uniqueLang": _unique_lang,
}
