"""Shapes in words: by their name, or else by what they are and where they stand."""

from __future__ import annotations

from collections.abc import Callable

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.rdf import PREFIXES, RDFS, SH
from onto_compiler.shacl.graph import Graph
from onto_compiler.shacl.paths import read_path, sparql_path
from onto_compiler.terms import Term, text_of

__all__ = ["path_text", "shape_id", "shape_label", "shape_name"]

_PATH = NamedNode(SH + "path")
_LABELS = tuple(NamedNode(iri) for iri in (SH + "name", RDFS + "label", PREFIXES["skos"] + "prefLabel"))
_ABOVE = 64  # nodes that a shape is looked for in, one within the other


def shape_name(graph: Graph, node: Term, name: Callable[[Term], str], at: str = "") -> str:
    """``the shape `ex:S```, or ``the property shape of `ex:p` at 12:5``; ``at`` is the place, where it is known."""
    if isinstance(node, NamedNode):
        return f"the shape `{name(node)}`"
    place = f" at {at}" if at else ""
    for path in graph.objects(node, _PATH):
        return f"the property shape of `{path_text(graph, path, name)}`{place}"
    if place:
        return f"the node shape{place}"
    owner = _owner(graph, node)
    return f"a node shape within `{name(owner)}`" if owner is not None else "a node shape without a name"


def shape_id(graph: Graph, node: Term, name: Callable[[Term], str]) -> str:
    """A short name of a shape that stays the same from run to run: ``ex:Person``, or ``ex:Person/ex:age`` within it."""
    if isinstance(node, NamedNode):
        return name(node)
    owner = _owner(graph, node)
    own = [name(owner)] if owner is not None else []
    own += [path_text(graph, path, name) for path in graph.objects(node, _PATH)]
    return "/".join(own) or "shape"


def path_text(graph: Graph, node: Term, name: Callable[[Term], str]) -> str:
    """A property path as SPARQL writes it, with names."""
    if isinstance(node, NamedNode):
        return name(node)
    path = read_path(graph, node)
    return name(node) if path is None else sparql_path(path, name)


def shape_label(graph: Graph, node: Term) -> str:
    """What a shape calls itself, in English where it can be; empty where it has no name."""
    for predicate in _LABELS:
        found = [value for value in graph.objects(node, predicate) if isinstance(value, Literal)]
        found.sort(key=lambda value: {None: 0, "en": 1}.get(value.language, 2))
        if found:
            return text_of(found[0])
    return ""


def _owner(graph: Graph, node: Term) -> Term | None:
    """The nearest named node that a blank one belongs to."""
    todo, seen = [node], {node}
    while todo and len(seen) < _ABOVE:
        one = todo.pop(0)
        for predicate in graph.pointing(one):
            for above in graph.subjects(predicate, one):
                if isinstance(above, NamedNode):
                    return above
                if isinstance(above, BlankNode) and above not in seen:
                    seen.add(above)
                    todo.append(above)
    return None
