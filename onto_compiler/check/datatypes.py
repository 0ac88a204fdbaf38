"""Literals whose datatype is none of those that the range of their property allows (VOC007).

What a range allows is found from below: XML Schema's own datatypes by derivation, others by ``rdfs:subClassOf`` and
``owl:onDatatype``. Where a datatype, or what a range consists of, is not told, nothing is asked.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, RDF, RDFS, XSD
from onto_compiler.reasoning.axioms import TYPE, owl
from onto_compiler.shacl.graph import Graph
from onto_compiler.terms import Term

__all__ = ["check_datatypes"]

_DERIVED = """
decimal integer ; integer nonPositiveInteger long nonNegativeInteger ; nonPositiveInteger negativeInteger ; long int ;
int short ; short byte ; nonNegativeInteger unsignedLong positiveInteger ; unsignedLong unsignedInt ;
unsignedInt unsignedShort ; unsignedShort unsignedByte ; string normalizedString ; normalizedString token ;
token language NMTOKEN Name ; Name NCName ; dateTime dateTimeStamp ; duration dayTimeDuration yearMonthDuration
"""
_WIDER: Mapping[str, str] = {
    XSD + narrow: XSD + base for base, *narrower in map(str.split, _DERIVED.split(";")) for narrow in narrower
}
"""XML Schema 1.1, part 2, section 3: the datatype that each is derived from, primitive ones apart."""
_BUILT_IN = (XSD, RDF, RDFS, OWL)
_PLAIN = NamedNode(RDF + "PlainLiteral")
_OF_PLAIN = {NamedNode(XSD + "string"), NamedNode(RDF + "langString")}
_RANGE, _LITERAL = NamedNode(RDFS + "range"), NamedNode(RDFS + "Literal")
_ABOVE = (NamedNode(RDFS + "subClassOf"), owl("onDatatype"), owl("equivalentClass"))
_DEFINING = (owl("equivalentClass"), owl("onDatatype"), owl("unionOf"), owl("oneOf"), owl("intersectionOf"))


def check_datatypes(model: Model) -> Iterator[Finding]:
    """VOC007 for each literal that is of another datatype than its property asks for."""
    graph = model.graph
    datatypes = _Datatypes(graph)
    for predicate, ranges in graph.holders(_RANGE).items():
        if not isinstance(predicate, NamedNode) or owl("DatatypeProperty") not in graph.objects(predicate, TYPE):
            continue
        for wanted in filter(datatypes.is_told, ranges):
            for value, subjects in graph.values(predicate).items():
                if isinstance(value, Literal) and not datatypes.allows(wanted, value.datatype):
                    yield from (_finding(subject, predicate, value, wanted) for subject in subjects)


def _finding(subject: Term, predicate: NamedNode, value: Literal, wanted: Term) -> Finding:
    return Finding(
        "VOC007",
        "error",
        "`{object}` is not of the datatype `{wanted}`, which `{predicate}` asks for",
        "write a value of `{wanted}`",
        subject,
        predicate,
        value,
        values={"wanted": wanted},
    )


@dataclass(eq=False)
class _Datatypes:
    graph: Graph

    def __post_init__(self) -> None:
        self.allows = cache(self._allows)

    def is_told(self, wanted: Term) -> bool:
        """Whether a range is a datatype of which a name alone says what belongs to it."""
        if not isinstance(wanted, NamedNode) or wanted in {_LITERAL, owl("rational"), owl("real")}:
            return False
        if wanted.value.startswith(_BUILT_IN):
            return True
        graph = self.graph
        return bool(graph.objects(wanted, TYPE)) and not any(graph.objects(wanted, one) for one in _DEFINING)

    def _allows(self, wanted: Term, datatype: NamedNode) -> bool:
        """Whether a literal of ``datatype`` is one of ``wanted``, or nobody can say that it is not."""
        seen: set[Term] = set()
        waiting: list[Term] = [datatype]
        while waiting:
            one = waiting.pop()
            if one == wanted or (wanted == _PLAIN and one in _OF_PLAIN):
                return True
            if one in seen:
                continue
            seen.add(one)
            if isinstance(one, NamedNode) and one.value.startswith(_BUILT_IN):
                base = _WIDER.get(one.value)
                waiting += [] if base is None else [NamedNode(base)]
                continue
            above = [wider for axiom in _ABOVE for wider in self.graph.objects(one, axiom)]
            if not above and (isinstance(one, BlankNode) or not self.graph.objects(one, TYPE)):
                return True  # it is not told what it is derived from, or only as a data range
            waiting += above
        return False
