"""Property paths (SHACL, section 2.3.1): read from a shapes graph, followed in a data graph, written as SPARQL."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.rdf import RDF, SH
from onto_compiler.shacl.graph import Graph, Subject, Term

__all__ = ["Path", "describe", "follow", "read_path", "sparql_path"]

_FORMS = {
    NamedNode(SH + "inversePath"): ("inverse", "^{}"),
    NamedNode(SH + "zeroOrMorePath"): ("star", "{}*"),
    NamedNode(SH + "oneOrMorePath"): ("plus", "{}+"),
    NamedNode(SH + "zeroOrOnePath"): ("optional", "{}?"),
}
_TEXTS = dict(_FORMS.values())
_ALTERNATIVE, _FIRST, _REST = NamedNode(SH + "alternativePath"), NamedNode(RDF + "first"), NamedNode(RDF + "rest")
_NIL = NamedNode(RDF + "nil")
_PREDICATES = {kind: predicate for predicate, (kind, _) in _FORMS.items()} | {"alternative": _ALTERNATIVE}
_DEPTH = 16  # a path that is nested deeper contains itself


@dataclass(frozen=True, slots=True)
class Path:
    """``kind`` is ``predicate``, ``inverse``, ``star``, ``plus``, ``optional``, ``sequence`` or ``alternative``."""

    kind: str
    iri: NamedNode | None = None
    parts: tuple[Path, ...] = ()


def read_path(graph: Graph, node: Term, depth: int = _DEPTH) -> Path | None:
    """The path that ``node`` describes, or None if that is none. A list goes before any other form."""
    if isinstance(node, Literal) or node == _NIL or depth == 0:  # `()` is an IRI, and no property either
        return None
    if isinstance(node, NamedNode):
        return Path("predicate", node)
    if graph.objects(node, _FIRST):
        return _several(graph, "sequence", node, depth)
    for head in graph.objects(node, _ALTERNATIVE):
        return _several(graph, "alternative", head, depth)
    for predicate, (kind, _) in _FORMS.items():
        for inner in graph.objects(node, predicate):
            path = read_path(graph, inner, depth - 1)
            return None if path is None else Path(kind, parts=(path,))
    return None


def _several(graph: Graph, kind: str, head: Term, depth: int) -> Path | None:
    members = graph.items(head)
    parts = [read_path(graph, member, depth - 1) for member in members or ()]
    if not parts or None in parts:
        return None
    return Path(kind, parts=tuple(part for part in parts if part is not None))


def follow(graph: Graph, node: Term, path: Path) -> Iterable[Term]:
    """The value nodes of ``path`` from ``node``, each once."""
    if path.kind == "predicate" and path.iri is not None:
        return graph.objects(node, path.iri)
    return _reach(graph, {node: None}, path, back=False)


def _reach(graph: Graph, nodes: Iterable[Term], path: Path, *, back: bool) -> dict[Term, None]:
    match path.kind:
        case "predicate":
            assert path.iri is not None  # noqa: S101 - what the kind says
            step = graph.sources if back else graph.objects
            return {one: None for node in nodes for one in step(node, path.iri)}
        case "inverse":
            return _reach(graph, nodes, path.parts[0], back=not back)
        case "sequence":
            found = dict.fromkeys(nodes)
            for part in reversed(path.parts) if back else path.parts:
                found = _reach(graph, found, part, back=back)
            return found
        case "alternative":
            again = list(nodes)
            return {one: None for part in path.parts for one in _reach(graph, again, part, back=back)}
        case _:
            return _repeated(graph, dict.fromkeys(nodes), path, back=back)


def _repeated(graph: Graph, start: dict[Term, None], path: Path, *, back: bool) -> dict[Term, None]:
    """What ``*``, ``+`` and ``?`` reach."""
    if path.kind == "optional":
        return start | _reach(graph, start, path.parts[0], back=back)
    found = dict(start) if path.kind == "star" else {}
    frontier: Iterable[Term] = start
    while frontier:
        reached = _reach(graph, frontier, path.parts[0], back=back)
        frontier = [node for node in reached if node not in found]
        found |= dict.fromkeys(frontier)
    return found


def sparql_path(path: Path, name: Callable[[Term], str] = str) -> str:
    """The path as SPARQL writes it; ``name`` is how its properties are called."""
    match path.kind:
        case "predicate":
            return name(path.iri) if path.iri is not None else ""
        case "sequence" | "alternative":
            sign = "/" if path.kind == "sequence" else "|"
            return f"({sign.join(sparql_path(part, name) for part in path.parts)})"
        case _:
            return f"({_TEXTS[path.kind].format(sparql_path(path.parts[0], name))})"


def describe(path: Path) -> tuple[Subject, list[Triple]]:
    """A path as a report writes it: its node, and the triples of fresh blank nodes that describe it."""
    if path.iri is not None:
        return path.iri, []
    described = [describe(part) for part in path.parts]
    triples = [triple for _, below in described for triple in below]
    node = described[0][0]
    if path.kind in {"sequence", "alternative"}:
        node = NamedNode(RDF + "nil")
        for member, _ in reversed(described):
            cell = BlankNode()
            triples += [Triple(cell, _FIRST, member), Triple(cell, _REST, node)]
            node = cell
    predicate = _PREDICATES.get(path.kind)
    if predicate is None:
        return node, triples
    outer = BlankNode()
    return outer, [*triples, Triple(outer, predicate, node)]
