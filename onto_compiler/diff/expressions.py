"""Values as text: in Turtle, blank nodes in brackets, and for people class expressions in Manchester syntax.

Source: OWL 2 Web Ontology Language, Manchester Syntax (Second Edition), section 2.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.diff.structure import Descriptions
from onto_compiler.rdf import OWL, RDF, RDFS, SH, XSD
from onto_compiler.terms import Namespaces, Term, show

__all__ = ["Texts"]

_TYPE: Final = RDF + "type"
_NIL: Final = NamedNode(RDF + "nil")
_DEEP: Final = 40  # brackets within brackets that are shown
_MANY: Final = 5_000  # blank nodes of one value that are shown
_ORDER: Final = {name: index for index, name in enumerate((_TYPE, SH + "path", OWL + "onProperty"))}
_KINDS: Final = frozenset((OWL + "Class", OWL + "Restriction", RDFS + "Datatype"))
_JOINED: Final = {OWL + "unionOf": " or ", OWL + "intersectionOf": " and "}
_QUANTIFIED: Final = {OWL + "someValuesFrom": "some", OWL + "allValuesFrom": "only", OWL + "hasValue": "value"}
_COUNTED: Final = {
    OWL + name: word
    for word, names in (
        ("min", ("minCardinality", "minQualifiedCardinality")),
        ("max", ("maxCardinality", "maxQualifiedCardinality")),
        ("exactly", ("cardinality", "qualifiedCardinality")),
    )
    for name in names
}
_FILLERS: Final = frozenset((OWL + "onClass", OWL + "onDataRange"))
_FACETS: Final = {
    XSD + "minInclusive": ">=", XSD + "minExclusive": ">", XSD + "maxInclusive": "<=", XSD + "maxExclusive": "<",
}  # fmt: skip
_Values = Mapping[str, Term]


@dataclass(slots=True)
class Texts:
    """Writes terms with ``namespaces``; what is nested too deep, or repeats itself, is ``[ ... ]``."""

    found: Descriptions
    namespaces: Namespaces
    _left: int = 0

    def turtle(self, term: Term) -> str:
        """A term as Turtle has it."""
        self._left = _MANY
        return self._turtle(term, 0)

    def legible(self, term: Term) -> str:
        """A term as people read it: a class expression in Manchester syntax, lines as lines, all else as Turtle."""
        if isinstance(term, Literal) and "\n" in term.value:
            suffix = show(term, self.namespaces, whole=True).rpartition('"')[2]
            return f'"""{term.value}"""{suffix}'
        self._left = _MANY
        return self._expression(term, 0) or self.turtle(term)

    def _spent(self, depth: int) -> bool:
        self._left -= 1
        return depth > _DEEP or self._left < 0

    def _turtle(self, term: Term, depth: int) -> str:
        if isinstance(term, Triple):
            triple = (self._turtle(part, depth + 1) for part in (term.subject, term.predicate, term.object))
            return f"<<( {' '.join(triple)} )>>"
        if term == _NIL:
            return "()"
        if not isinstance(term, BlankNode):
            return show(term, self.namespaces, whole=True)
        if self._spent(depth):
            return "[ ... ]"
        if term in self.found.lists:
            return f"( {' '.join(self._turtle(item, depth + 1) for item in self.found.lists[term])} )"
        said: dict[str, list[Term]] = {}
        for name, value in self.found.about.get(term, ()):
            said.setdefault(name, []).append(value)
        parts = []
        for name in sorted(said, key=lambda name: (_ORDER.get(name, len(_ORDER)), name)):
            verb = "a" if name == _TYPE else show(NamedNode(name), self.namespaces)
            parts.append(f"{verb} {' , '.join(sorted(self._turtle(value, depth + 1) for value in said[name]))}")
        return f"[ {' ; '.join(parts)} ]" if parts else "[]"

    def _expression(self, term: Term, depth: int, *, inner: bool = False) -> str:
        """A class expression; ``inner`` puts what has several words in parentheses. Nothing for what is none."""
        if isinstance(term, NamedNode):
            return show(term, self.namespaces)
        if not isinstance(term, BlankNode) or self._spent(depth):
            return ""
        said = [pair for pair in self.found.about.get(term, ()) if pair[0] != _TYPE or _value(pair[1]) not in _KINDS]
        values = dict(said)
        if len(values) < len(said):
            return ""
        inside = depth + 1
        text = self._joined(values, inside) or self._restricted(values, inside) or self._ranged(values, inside)
        single = text[:1] in {"{", ""} or text.endswith("]")
        return f"({text})" if inner and not single else text

    def _joined(self, values: _Values, depth: int) -> str:
        if len(values) != 1:
            return ""
        ((name, value),) = values.items()
        if name == OWL + "complementOf":
            part = self._expression(value, depth, inner=True)
            return part and f"not {part}"
        items = self.found.lists.get(value, ()) if isinstance(value, BlankNode) else ()
        if name == OWL + "oneOf" and items:
            return f"{{{', '.join(sorted(self._turtle(item, depth) for item in items))}}}"
        parts = [self._expression(item, depth, inner=True) for item in items]
        return _JOINED[name].join(parts) if name in _JOINED and parts and all(parts) else ""

    def _restricted(self, values: _Values, depth: int) -> str:
        role = self._role(values[OWL + "onProperty"]) if OWL + "onProperty" in values else ""
        others = [pair for pair in values.items() if pair[0] != OWL + "onProperty"]
        if not role or not others:
            return ""
        if len(others) > 1 or others[0][0] in _COUNTED:
            return self._counted(role, dict(others), depth)
        ((name, value),) = others
        if name == OWL + "hasSelf":
            return f"{role} Self"
        as_value = name == OWL + "hasValue"
        filler = self._turtle(value, depth) if as_value else self._expression(value, depth, inner=True)
        return f"{role} {_QUANTIFIED[name]} {filler}" if name in _QUANTIFIED and filler else ""

    def _counted(self, role: str, values: dict[str, Term], depth: int) -> str:
        names = [name for name in values if name in _COUNTED]
        number = values.pop(names[0]) if len(names) == 1 else None
        if not isinstance(number, Literal) or len(values) > 1 or not set(values) <= _FILLERS:
            return ""
        text = f"{role} {_COUNTED[names[0]]} {number.value}"
        fillers = [self._expression(value, depth, inner=True) for value in values.values()]
        return " ".join((text, *fillers)) if all(fillers) else ""

    def _role(self, term: Term) -> str:
        if isinstance(term, NamedNode):
            return show(term, self.namespaces)
        said = self.found.about.get(term, ()) if isinstance(term, BlankNode) else ()
        inverse = [value for name, value in said if name == OWL + "inverseOf"]
        named = len(said) == 1 and inverse and isinstance(inverse[0], NamedNode)
        return f"inverse {show(inverse[0], self.namespaces)}" if named else ""

    def _ranged(self, values: _Values, depth: int) -> str:
        if set(values) != {OWL + "onDatatype", OWL + "withRestrictions"}:
            return ""
        items = values[OWL + "withRestrictions"]
        parts = []
        for item in self.found.lists.get(items, ()) if isinstance(items, BlankNode) else ():
            for name, value in self.found.about.get(item, ()) if isinstance(item, BlankNode) else ():
                facet = _FACETS.get(name, name.removeprefix(XSD).removeprefix(RDF))
                parts.append(f"{facet} {self._turtle(value, depth)}")
        return f"{show(values[OWL + 'onDatatype'], self.namespaces)}[{', '.join(sorted(parts))}]" if parts else ""


def _value(term: Term) -> str:
    return term.value if isinstance(term, NamedNode) else ""
