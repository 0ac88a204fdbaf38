"""How grave a result is: SHACL's own severities, and those of a person by what they are subclasses of."""

from __future__ import annotations

from pyoxigraph import NamedNode

from onto_compiler.rdf import RDFS, SH
from onto_compiler.shacl.graph import Graph

__all__ = ["level", "severity_iri"]

_LEVELS = {SH + "Violation": "error", SH + "Warning": "warning"} | dict.fromkeys(
    (SH + name for name in ("Info", "Debug", "Trace")), "info"
)
_SUBCLASS = NamedNode(RDFS + "subClassOf")


def severity_iri(severity: str) -> str:
    """The IRI of a severity that a result names by its local name or by its IRI."""
    return severity if ":" in severity else SH + severity


def level(severity: str, graph: Graph | None = None) -> str:
    """``error``, ``warning`` or ``info``: as SHACL has it, or as ``rdfs:subClassOf`` in ``graph`` says, or an error."""
    todo, seen = [NamedNode(severity_iri(severity))], set[NamedNode]()
    while todo:
        one = todo.pop(0)
        if one.value in _LEVELS:
            return _LEVELS[one.value]
        if graph is not None and one not in seen:
            todo += (above for above in graph.objects(one, _SUBCLASS) if isinstance(above, NamedNode))
        seen.add(one)
    return "error"
