"""What pySHACL, the oracle of our own engine, is given and says: tests and measurements compare with it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, RdfFormat, Store, serialize
from rdflib import Graph, URIRef
from rdflib.namespace import SH

from onto_compiler.rdf import SH as SHACL
from onto_compiler.shacl.graph import Term

__all__ = ["as_graph", "read_report"]

Row = tuple[Term, Term | None, Term | None, str, Term, str, str]


def as_graph(store: Store) -> Graph:
    """All graphs of ``store`` as one rdflib graph."""
    text = serialize((quad.triple for quad in store), format=RdfFormat.N_TRIPLES)
    return Graph().parse(data=(text or b"").decode(), format="nt")


def read_report(report: Graph) -> Iterator[Row]:
    """The results of a pySHACL report; what it gives as the detail of a result is left out."""
    for result in report.objects(None, SH.result):
        yield (
            _required(report.value(result, SH.focusNode)),
            _term(report.value(result, SH.resultPath)),
            _term(report.value(result, SH.value)),
            _local(report.value(result, SH.sourceConstraintComponent)),
            _required(report.value(result, SH.sourceShape)),
            str(report.value(result, SH.resultMessage) or ""),
            _local(report.value(result, SH.resultSeverity)),
        )


def _local(term: Any) -> str:  # noqa: ANN401 - rdflib's terms have no types here
    return str(term).removeprefix(SHACL)


def _required(term: Any) -> Term:  # noqa: ANN401
    found = _term(term)
    assert found is not None  # noqa: S101 - SHACL requires it of every result
    return found


def _term(term: Any) -> Term | None:  # noqa: ANN401
    if term is None:
        return None
    if isinstance(term, URIRef):
        return NamedNode(str(term))
    if not hasattr(term, "datatype"):
        return BlankNode(str(term))
    if term.language:
        return Literal(str(term), language=term.language)
    return Literal(str(term), datatype=NamedNode(str(term.datatype)) if term.datatype else None)
