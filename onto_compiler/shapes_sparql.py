"""One SPARQL SELECT per SHACL constraint: ``?this`` is a focus node that violates it, ``?value`` the value that does.

Source: SHACL (W3C, 2017), section 4, whose definitions of the Core components are given as SPARQL there too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.problems import OntoError, Problem
from onto_compiler.rdf import RDF, SH, XSD

__all__ = ["CONSTRAINTS", "Constraint", "ShapeFault", "Term", "path_text", "term_text"]

Term = NamedNode | BlankNode | Literal
_CASTS = {XSD + name for name in ("boolean", "integer", "decimal", "double", "float", "dateTime", "date")}
_KINDS = {
    "IRI": "isIRI(?value)",
    "BlankNode": "isBlank(?value)",
    "Literal": "isLiteral(?value)",
    "BlankNodeOrIRI": "(isBlank(?value) || isIRI(?value))",
    "BlankNodeOrLiteral": "(isBlank(?value) || isLiteral(?value))",
    "IRIOrLiteral": "(isIRI(?value) || isLiteral(?value))",
}


class ShapeFault(OntoError):  # noqa: N818 - a fault in a shape, as OntoError one in any input
    """A shape that cannot run (SHP002): ``shape``, and the parameter and value of it that are at fault."""

    def __init__(self, message: str, shape: Term, parameter: str = "", value: Term | None = None) -> None:
        super().__init__(Problem("", 0, 0, "SHP002", "error", message, "see `onto explain SHP002`"))
        self.shape, self.parameter, self.value = shape, parameter, value

    def __reduce__(self) -> tuple[type[OntoError], tuple[Problem, ...]]:
        """Pickle as the plain error: RDF terms stay in their process."""
        return (OntoError, self.problems)


@dataclass(frozen=True, slots=True)
class Constraint:
    """A parameter of a shape: ``name`` and value. ``targets`` binds ``?this``; ``path`` is empty for a node shape."""

    shape: Term
    name: str
    targets: str
    path: str
    parameter: Term
    items: tuple[Term, ...] = ()
    flags: str = ""

    @property
    def values(self) -> str:
        """A group that binds ``?value`` to each value node of ``?this``."""
        return f"?this {self.path} ?value ." if self.path else "BIND (?this AS ?value)"

    def where(self, condition: str) -> str:
        """A query for the value nodes that meet ``condition``, a violation."""
        return f"SELECT DISTINCT ?this ?value WHERE {{ {self.targets} {self.values} {condition} }}"

    def number(self) -> int:
        """The parameter as a whole number.

        Raises:
            ShapeFault: where it is none.

        """
        try:
            return int(self.parameter.value)
        except ValueError:
            raise self.fault(f"`{self.parameter.value}` stands where a whole number belongs") from None

    def fault(self, message: str) -> ShapeFault:
        """What is wrong with this parameter's value."""
        return ShapeFault(message, self.shape, self.name, self.parameter)


def term_text(term: Term) -> str:
    """A term as SPARQL writes it; blank nodes have no such form and are given as a note."""
    return str(term) if not isinstance(term, BlankNode) else "a shape without an IRI"


def path_text(
    path: Term, values: Callable[[Term, str], list[Term]], items: Callable[[Term], list[Term]], depth: int = 8
) -> str:
    """A SHACL property path as a SPARQL one; empty where it has no form that SHACL knows, or is nested without end."""
    if isinstance(path, NamedNode):
        return str(path)
    if isinstance(path, Literal) or depth == 0:
        return ""
    forms = {
        "inversePath": "^{}",
        "zeroOrMorePath": "{}*",
        "oneOrMorePath": "{}+",
        "zeroOrOnePath": "{}?",
    }
    for name, form in forms.items():
        for inner in values(path, name):
            text = path_text(inner, values, items, depth - 1)
            return f"({form.format(text)})" if text else ""
    alternatives = values(path, "alternativePath")
    if not alternatives and not values(path, RDF + "first"):
        return ""
    members = [path_text(item, values, items, depth - 1) for item in items(alternatives[0] if alternatives else path)]
    if not members or not all(members):
        return ""
    return f"({('|' if alternatives else '/').join(members)})"


def _min_count(own: Constraint) -> Iterator[str]:
    least = own.number()
    if least == 1:
        yield f"SELECT DISTINCT ?this WHERE {{ {own.targets} FILTER NOT EXISTS {{ {own.values} }} }}"
    elif least > 1:
        yield (
            f"SELECT ?this WHERE {{ {own.targets} OPTIONAL {{ {own.values} }} }} "
            f"GROUP BY ?this HAVING (COUNT(DISTINCT ?value) < {least})"
        )


def _max_count(own: Constraint) -> Iterator[str]:
    yield (
        f"SELECT ?this WHERE {{ {own.targets} {own.values} }} "
        f"GROUP BY ?this HAVING (COUNT(DISTINCT ?value) > {own.number()})"
    )


def _datatype(own: Constraint) -> Iterator[str]:
    datatype = term_text(own.parameter)
    bad = f"!isLiteral(?value) || DATATYPE(?value) != {datatype}"
    if own.parameter.value in _CASTS:
        bad += f" || !COALESCE(isLiteral({datatype}(STR(?value))), false)"
    yield own.where(f"FILTER ({bad})")


def _class(own: Constraint) -> Iterator[str]:
    yield own.where(f"FILTER NOT EXISTS {{ ?value a/rdfs:subClassOf* {term_text(own.parameter)} }}")


def _node_kind(own: Constraint) -> Iterator[str]:
    kind = own.parameter.value.removeprefix(SH)
    if kind not in _KINDS:
        raise own.fault(f"`{kind}` is no node kind of SHACL")
    yield own.where(f"FILTER (!{_KINDS[kind]})")


def _in(own: Constraint) -> Iterator[str]:
    allowed = " || ".join(f"sameTerm(?value, {term_text(item)})" for item in own.items) or "false"
    yield own.where(f"FILTER (!({allowed}))")


def _has_value(own: Constraint) -> Iterator[str]:
    value = term_text(own.parameter)
    inside = f"?this {own.path} {value}" if own.path else f"FILTER (sameTerm(?this, {value}))"
    yield f"SELECT DISTINCT ?this WHERE {{ {own.targets} FILTER NOT EXISTS {{ {inside} }} }}"


def _pattern(own: Constraint) -> Iterator[str]:
    try:
        re.compile(own.parameter.value)
    except re.error as error:
        raise own.fault(f"the pattern is no regular expression: {error.msg}") from error
    pattern, flags = str(Literal(own.parameter.value)), str(Literal(own.flags))
    yield own.where(f"FILTER (isBlank(?value) || !COALESCE(REGEX(STR(?value), {pattern}, {flags}), false))")


def _length(sign: str) -> Callable[[Constraint], Iterator[str]]:
    def build(own: Constraint) -> Iterator[str]:
        yield own.where(f"FILTER (isBlank(?value) || STRLEN(STR(?value)) {sign} {own.number()})")

    return build


def _compare(sign: str) -> Callable[[Constraint], Iterator[str]]:
    def build(own: Constraint) -> Iterator[str]:
        yield own.where(f"FILTER (!COALESCE(?value {sign} {term_text(own.parameter)}, false))")

    return build


def _unique_lang(own: Constraint) -> Iterator[str]:
    if own.parameter.value == "true":
        yield (
            f"SELECT ?this ?language WHERE {{ {own.targets} {own.values} "
            "FILTER (isLiteral(?value) && LANG(?value) != '') } "
            "GROUP BY ?this (LANG(?value) AS ?language) HAVING (COUNT(DISTINCT ?value) > 1)"
        )


CONSTRAINTS: Mapping[str, Callable[[Constraint], Iterator[str]]] = {
    "class": _class,
    "datatype": _datatype,
    "hasValue": _has_value,
    "in": _in,
    "maxCount": _max_count,
    "maxExclusive": _compare("<"),
    "maxInclusive": _compare("<="),
    "maxLength": _length(">"),
    "minCount": _min_count,
    "minExclusive": _compare(">"),
    "minInclusive": _compare(">="),
    "minLength": _length("<"),
    "nodeKind": _node_kind,
    "pattern": _pattern,
    "uniqueLang": _unique_lang,
}
