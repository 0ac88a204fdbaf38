"""The terms that a Turtle file can use, with their documentation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast
from urllib.parse import unquote, urlparse

from pyoxigraph import NamedNode, QuerySolutions, Store

from onto_compiler.rdf import prologue
from onto_compiler.schema import local_name

__all__ = ["VocabularyTerm", "read_vocabulary"]

_TERMS = """
SELECT ?term (MIN(?g) AS ?graph) (MIN(STR(?class)) AS ?type) (MIN(STR(?l)) AS ?label) (MIN(STR(?d)) AS ?definition)
    (MIN(STR(?one)) AS ?domain) (MIN(STR(?two)) AS ?range) (MIN(STR(?from)) AS ?of) (MIN(STR(?into)) AS ?to)
    (MIN(STR(?u)) AS ?unit) (MIN(STR(?up)) AS ?above)
WHERE {
    GRAPH ?g { ?term a ?class . FILTER (isIRI(?term) && ?class NOT IN (owl:NamedIndividual, owl:FunctionalProperty)) }
    OPTIONAL { GRAPH ?g1 { ?term rdfs:label ?l } } OPTIONAL { GRAPH ?g2 { ?term skos:definition ?d } }
    OPTIONAL { GRAPH ?g3 { ?term core:domain ?one } } OPTIONAL { GRAPH ?g4 { ?term core:range ?two } }
    OPTIONAL { GRAPH ?g5 { ?term rdfs:domain ?from } } OPTIONAL { GRAPH ?g6 { ?term rdfs:range ?into } }
    OPTIONAL { GRAPH ?g7 { ?term core:marginUnit ?u } } OPTIONAL { GRAPH ?g8 { ?term rdfs:subClassOf ?up } }
} GROUP BY ?term ORDER BY ?term"""


@dataclass(frozen=True, slots=True)
class VocabularyTerm:
    """``kind`` is the local name of its type; ``signature`` is what it relates, where it relates something."""

    iri: str
    kind: str
    label: str
    definition: str
    signature: str
    file: Path | None

    @property
    def markdown(self) -> str:
        """Name, kind, signature and definition, for a hover."""
        head = f"**{local_name(self.iri)}** ({self.kind})"
        parts = [head, f"`{self.signature}`" if self.signature else "", self.definition, f"<{self.iri}>"]
        return "\n\n".join(part for part in parts if part)


def read_vocabulary(store: Store) -> Mapping[str, VocabularyTerm]:
    """Every typed IRI of ``store`` (one named graph per file), by IRI."""
    rows = cast("QuerySolutions", store.query(prologue() + _TERMS))
    terms = {}
    for row in rows:
        values = {name: row[name].value for name in _NAMES if row[name] is not None}
        iri = row["term"].value
        graph = row["graph"]
        terms[iri] = VocabularyTerm(
            iri=iri,
            kind=local_name(values.get("type", "")),
            label=values.get("label", ""),
            definition=values.get("definition", ""),
            signature=_signature(local_name(iri), values),
            file=_path(graph) if isinstance(graph, NamedNode) else None,
        )
    return terms


_NAMES = ("type", "label", "definition", "domain", "range", "of", "to", "unit", "above")


def _signature(name: str, values: Mapping[str, str]) -> str:
    short = {key: local_name(value) for key, value in values.items() if key not in {"label", "definition"}}
    if "domain" in short:
        arguments = ", ".join(short[key] for key in ("domain", "range") if key in short)
        return f"{name}({arguments})" + (f", margin in {short['unit']}" if "unit" in short else "")
    if "of" in short or "to" in short:
        return f"{short.get('of', 'anything')} {name} {short.get('to', 'anything')}"
    return f"{name} is a special {short['above']}" if "above" in short else ""


def _path(graph: NamedNode) -> Path | None:
    address = urlparse(graph.value)
    return Path(unquote(address.path)) if address.scheme == "file" else None
