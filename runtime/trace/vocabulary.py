"""The ontology as quads in a trace's store, so that queries can follow superclasses, units and labels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pyoxigraph import NamedNode, Quad, Store

from onto_compiler.rdf import OWL, RDF, node
from onto_compiler.sources import load_store

__all__ = ["holds_vocabulary", "refresh", "vocabulary"]


def vocabulary(extra: Sequence[Path | str] = ()) -> list[Quad]:
    """The shipped ontology and the user's own Turtle, each file in the graph named by its ontology's IRI."""
    source = load_store(extra)
    names = {
        quad.graph_name: quad.subject
        for quad in source.quads_for_pattern(None, node(RDF + "type"), node(OWL + "Ontology"), None)
    }
    quads = []
    for quad in source:
        name = names.get(quad.graph_name)
        if isinstance(name, NamedNode):
            quads.append(Quad(quad.subject, quad.predicate, quad.object, name))
    return quads


def holds_vocabulary(store: Store) -> bool:
    """Whether ``store`` holds an ontology already."""
    pattern = store.quads_for_pattern(None, node(RDF + "type"), node(OWL + "Ontology"), None)
    return next(pattern, None) is not None


def refresh(store: Store, extra: Sequence[Path | str] = ()) -> None:
    """Replace the ontology in ``store`` by the present one."""
    fresh = vocabulary(extra)
    headers = store.quads_for_pattern(None, node(RDF + "type"), node(OWL + "Ontology"), None)
    for graph in {quad.graph_name for quad in headers}:
        store.remove_graph(graph)
    store.extend(fresh)
