"""``onto check --shapes SHAPES --report FILE``: the W3C's validation report as a file."""

from __future__ import annotations

import io
from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path

from pyoxigraph import BlankNode, NamedNode, RdfFormat, Triple, serialize

from onto_compiler.atomic import replacing
from onto_compiler.check.run import Validated
from onto_compiler.problems import OntoError
from onto_compiler.rdf import OWL, PREFIXES, RDF, RDFS, SH, XSD
from onto_compiler.shacl.report import report

__all__ = ["ENDINGS", "write_report"]

ENDINGS = {".ttl": RdfFormat.TURTLE, ".jsonld": RdfFormat.JSON_LD}
_PREFIXES = {"sh": SH, "rdf": RDF, "rdfs": RDFS, "xsd": XSD, "owl": OWL, "skos": PREFIXES["skos"]}


def write_report(path: Path, validation: Validated) -> None:
    """Write the report of ``validation`` to ``path``, whose ending is one of ``ENDINGS``.

    Raises:
        OntoError: CLI009, where the file cannot be written.

    """
    rdf_format = ENDINGS[path.suffix.lower()]
    triples = report(validation.results, validation.shapes, complete=validation.complete)
    buffer = io.BytesIO()
    if rdf_format == RdfFormat.JSON_LD:
        serialize(_without_triple_terms(triples), buffer, format=rdf_format, prefixes=_PREFIXES)
    else:
        serialize(triples, buffer, format=rdf_format, prefixes=_PREFIXES)
    try:
        with replacing(path) as whole:
            whole.write_bytes(buffer.getvalue())
    except OSError as error:
        message = f"cannot write `{path}`: {error.strerror or error}"
        raise OntoError.of("CLI009", message, "name a file that can be written", str(path)) from error


def _without_triple_terms(triples: Iterable[Triple]) -> Iterator[Triple]:
    """JSON-LD 1.1 has no triple terms: each becomes an ``rdf:Statement``, as RDF 1.1 speaks of triples."""
    nodes: dict[Triple, BlankNode] = {}
    todo = deque(triples)
    while todo:
        one = todo.popleft()
        if not isinstance(one.object, Triple):
            yield one
            continue
        inner = one.object
        if inner not in nodes:
            nodes[inner] = BlankNode()
            parts = (("subject", inner.subject), ("predicate", inner.predicate), ("object", inner.object))
            todo += [Triple(nodes[inner], NamedNode(RDF + "type"), NamedNode(RDF + "Statement"))]
            todo += [Triple(nodes[inner], NamedNode(RDF + name), part) for name, part in parts]
        yield Triple(one.subject, one.predicate, nodes[inner])
