"""The place of a shape's fault, where its store holds a named graph for each file."""

from __future__ import annotations

from dataclasses import replace

from pyoxigraph import Literal, NamedNode, Store

from onto_compiler.problems import OntoError, Problem
from onto_compiler.shacl.model import ShapeFault

__all__ = ["placed"]


def placed(store: Store, fault: ShapeFault) -> OntoError:
    """``fault`` at the literal that it speaks of; as it is where that stands in no file."""
    code, message, hint = fault.fields
    parameter = fault.predicate
    if parameter is None or not isinstance(fault.value, Literal):
        return fault
    for quad in store.quads_for_pattern(None, parameter, fault.value, None):
        graph = quad.graph_name
        if isinstance(graph, NamedNode) and graph.value.startswith("file:"):
            return OntoError(_at(graph, parameter, fault, Problem("", 0, 0, code, "error", message, hint)))
    return fault


def _at(graph: NamedNode, parameter: NamedNode, fault: ShapeFault, problem: Problem) -> Problem:
    from pathlib import Path  # noqa: PLC0415 - these three are for a fault alone
    from urllib.parse import urlsplit  # noqa: PLC0415
    from urllib.request import url2pathname  # noqa: PLC0415

    from onto_compiler.turtle.source_map import read_map  # noqa: PLC0415 - as above

    path = Path(url2pathname(urlsplit(graph.value).path))
    try:
        source_map = read_map(path)
    except (OSError, UnicodeDecodeError):
        return replace(problem, file=str(path))
    for located in source_map.find(None, parameter, fault.value):
        token = located.at_object
        inside = fault.inside is not None and token.kind == "string"
        span = source_map.inside(token, *fault.inside) if inside and fault.inside else source_map.span(token)
        return Problem.at(span, problem.code, problem.message, problem.hint)
    return replace(problem, file=str(path))
