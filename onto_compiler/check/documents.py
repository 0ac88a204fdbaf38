"""A file of data or shapes as it was read, and which formats there are."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pyoxigraph import Quad, RdfFormat, Triple

__all__ = ["ENDINGS", "Document"]

ENDINGS = {
    ".ttl": RdfFormat.TURTLE,
    ".nt": RdfFormat.N_TRIPLES,
    ".trig": RdfFormat.TRIG,
    ".nq": RdfFormat.N_QUADS,
    ".rdf": RdfFormat.RDF_XML,
    ".owl": RdfFormat.RDF_XML,
    ".xml": RdfFormat.RDF_XML,
    ".jsonld": RdfFormat.JSON_LD,
    ".json": RdfFormat.JSON_LD,
}
WITH_PLACES = {RdfFormat.TURTLE, RdfFormat.N_TRIPLES, RdfFormat.TRIG, RdfFormat.N_QUADS}


@dataclass(frozen=True, slots=True)
class Document:
    """A file as Oxigraph read it. The graphs of a dataset count together."""

    path: Path
    format: RdfFormat
    statements: tuple[Quad | Triple, ...]

    @property
    def has_places(self) -> bool:
        """Whether lines and columns are known."""
        return self.format in WITH_PLACES
