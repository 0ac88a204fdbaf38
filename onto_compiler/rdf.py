"""Namespaces, and the few conversions between RDF terms and Python that several modules need."""

from __future__ import annotations

from pyoxigraph import Literal, NamedNode

__all__ = [
    "ALIGNED",
    "AUDIT",
    "BASE",
    "CORE",
    "MAN",
    "NAV",
    "OWL",
    "PREFIXES",
    "PROV",
    "RDF",
    "RDFS",
    "SH",
    "SKOS",
    "TRACE",
    "XSD",
    "boolean",
    "double",
    "integer",
    "namespace_of",
    "node",
    "prologue",
    "shorten",
]

BASE = "https://w3id.org/onto-evwm/"
AUDIT = BASE + "audit#"
CORE = BASE + "core#"
MAN = BASE + "manipulation#"
NAV = BASE + "navigation#"
TRACE = BASE + "trace#"
OWL = "http://www.w3.org/2002/07/owl#"
PROV = "http://www.w3.org/ns/prov#"
RDF = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
RDFS = "http://www.w3.org/2000/01/rdf-schema#"
SH = "http://www.w3.org/ns/shacl#"
SKOS = "http://www.w3.org/2004/02/skos/core#"
XSD = "http://www.w3.org/2001/XMLSchema#"

PREFIXES = {
    "audit": AUDIT,
    "cora": "http://purl.org/ieee1872-owl/cora-bare#",
    "corax": "http://purl.org/ieee1872-owl/corax#",
    "core": CORE,
    "dcterms": "http://purl.org/dc/terms/",
    "dul": "http://www.ontologydesignpatterns.org/ont/dul/DUL.owl#",
    "fail": "http://www.ease-crc.org/ont/failure_and_recovery.owl#",
    "lib": BASE + "libero#",
    "man": MAN,
    "maze": BASE + "pointmaze#",
    "nav": NAV,
    "owl": OWL,
    "plan": BASE + "planning#",
    "pos": "http://purl.org/ieee1872-owl/pos#",
    "prov": PROV,
    "qudt": "http://qudt.org/schema/qudt/",
    "rdf": RDF,
    "rdfs": RDFS,
    "rule": BASE + "rules#",
    "score": BASE + "scores#",
    "sh": SH,
    "shape": BASE + "shapes#",
    "skos": SKOS,
    "soma": "http://www.ease-crc.org/ont/SOMA.owl#",
    "sosa": "http://www.w3.org/ns/sosa/",
    "ssn": "http://www.w3.org/ns/ssn/",
    "trace": TRACE,
    "unit": "http://qudt.org/vocab/unit/",
    "xsd": XSD,
}

# Vocabularies that the alignments speak of, and no record does.
ALIGNED = frozenset(("cora", "corax", "dul", "fail", "pos", "soma", "sosa", "ssn"))

_NOT_FINITE = {"inf": "INF", "-inf": "-INF", "nan": "NaN"}  # XSD's spelling


def node(iri: str) -> NamedNode:
    """An IRI as an RDF term."""
    return NamedNode(iri)


def boolean(value: bool) -> Literal:  # noqa: FBT001 - the value is the whole argument
    """An ``xsd:boolean`` literal."""
    return Literal("true" if value else "false", datatype=NamedNode(XSD + "boolean"))


def integer(value: int) -> Literal:
    """An ``xsd:integer`` literal."""
    return Literal(str(int(value)), datatype=NamedNode(XSD + "integer"))


def double(value: float) -> Literal:
    """An ``xsd:double`` literal whose lexical form reads back to the same number."""
    text = repr(float(value))
    return Literal(_NOT_FINITE.get(text, text), datatype=NamedNode(XSD + "double"))


def prologue() -> str:
    """SPARQL ``PREFIX`` lines for every namespace that the project uses."""
    return "".join(f"PREFIX {prefix}: <{iri}>\n" for prefix, iri in PREFIXES.items())


def namespace_of(iri: str) -> str:
    """An IRI up to its last ``#`` or ``/``."""
    return iri[: max(iri.rfind("#"), iri.rfind("/")) + 1]


def shorten(iri: str) -> str:
    """``prefix:local`` where one of our prefixes fits, else the IRI itself."""
    for prefix, namespace in PREFIXES.items():
        if iri.startswith(namespace) and len(iri) > len(namespace):
            return f"{prefix}:{iri[len(namespace) :]}"
    return iri
