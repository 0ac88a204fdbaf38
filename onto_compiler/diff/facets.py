"""What a property of a term is about, and which change of its values breaks what was written with the old version.

Data, records and programs that were right under the old version and would be wrong, or mean something else, under the
new one are broken by a change. An order of correction, a rule's text or a definition may change without that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from onto_compiler.rdf import CORE, OWL, PREFIXES, RDF, RDFS, SH, SKOS

__all__ = ["FACETS", "HEADER", "OTHER", "WORDING", "Facet"]


@dataclass(frozen=True, slots=True)
class Facet:
    """``breaks``: "never", "always" (any change), "less" (a value that goes), "more" (a value that comes),
    "class" (unless the new class holds all members of the old), "taken" (as "class", and also where it goes or comes),
    "super" (a superclass that goes, a restriction that comes), "type" (a type that goes, an axiom that comes).
    """  # noqa: D205 - one field, whose values are the summary

    name: str
    breaks: str


_DCTERMS = PREFIXES["dcterms"]
_NOTES = (
    *("altLabel", "changeNote", "definition", "editorialNote", "example", "hiddenLabel", "historyNote", "note"),
    *("prefLabel", "scopeNote"),
)
OTHER = Facet("other", "never")
WORDING = Facet("wording", "never")  # of a shape's message, or the same number in other digits
HEADER = frozenset({OWL + "versionInfo", OWL + "versionIRI", OWL + "priorVersion"})
_DOCUMENTATION = Facet("documentation", "never")
_BINDING = Facet("binding", "always")
_THRESHOLD = Facet("threshold", "always")

FACETS: Mapping[str, Facet] = {
    RDF + "type": Facet("type", "type"),
    RDFS + "subClassOf": Facet("superclass", "super"),
    RDFS + "subPropertyOf": Facet("superproperty", "less"),
    OWL + "equivalentClass": Facet("equivalence", "always"),
    OWL + "inverseOf": Facet("inverse", "always"),
    OWL + "imports": Facet("imports", "less"),
    OWL + "deprecated": Facet("deprecation", "never"),
    _DCTERMS + "isReplacedBy": Facet("deprecation", "never"),
    RDFS + "domain": Facet("domain", "class"),
    RDFS + "range": Facet("range", "class"),
    CORE + "arity": Facet("signature", "always"),
    CORE + "domain": Facet("signature", "taken"),
    CORE + "range": Facet("signature", "taken"),
    CORE + "marginUnit": Facet("unit", "always"),
    CORE + "unit": Facet("unit", "always"),
    CORE + "priority": Facet("priority", "never"),
    CORE + "admits": Facet("route", "less"),
    CORE + "supports": Facet("route", "less"),
    CORE + "level": Facet("route", "always"),
    CORE + "onRejection": Facet("route", "never"),
    SKOS + "notation": Facet("name", "always"),
    CORE + "groundedBy": Facet("grounding", "never"),
    CORE + "premiseGroundedBy": Facet("grounding", "never"),
    CORE + "premiseTolerance": Facet("grounding", "never"),
    CORE + "order": Facet("binding", "never"),
    **{CORE + name: _BINDING for name in ("lifts", "native", "landmarkPattern", "bindsThreshold", "goalMargin")},
    **{CORE + name: Facet("binding", "taken") for name in ("nativeArgument1", "nativeArgument2")},
    **{CORE + name: _BINDING for name in ("category", "region", "instanceClass")},
    **{CORE + name: _THRESHOLD for name in ("above", "bound", "inclusive", "everyJoint", "tolerance")},
    **{SH + name: Facet("rule", "never") for name in ("construct", "condition", "order", "rule")},
    **{SH + name: Facet("shape", "more") for name in ("property", "sparql", "class", "datatype", "nodeKind", "not")},
    **{SH + name: Facet("shape", "more") for name in ("and", "or", "xone", "node", "in", "hasValue", "pattern")},
    **{SH + name: Facet("shape", "more") for name in ("targetClass", "targetNode", "targetSubjectsOf")},
    **{SKOS + name: _DOCUMENTATION for name in _NOTES},
    **{RDFS + name: _DOCUMENTATION for name in ("label", "comment", "seeAlso", "isDefinedBy")},
    **{_DCTERMS + name: _DOCUMENTATION for name in ("title", "description", "creator", "license", "modified")},
}
