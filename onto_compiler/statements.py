"""Records as statements of RDF: one subject's values by keyword, and quads graph by graph.

What is not defined is None and left out, as RDF has no need of a word for nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from pyoxigraph import BlankNode, Literal, NamedNode, Quad

from onto_compiler.rdf import CORE, RDF, TRACE, boolean, double, integer, node

__all__ = ["Statement", "Term", "Value", "describe", "link", "quads_of"]

Term = NamedNode | Literal | BlankNode
Statement = tuple[str, str, Term]
Value = str | bool | int | float | Term | None

_TYPE = RDF + "type"


def describe(subject: str, types: Sequence[str], **values: Value) -> Iterator[Statement]:
    """Statements of one subject; keywords are local names of our vocabularies, ``None`` says nothing."""
    for cls in types:
        yield subject, _TYPE, node(cls)
    for key, value in values.items():
        space, _, local = key.partition("_")
        if value is not None:
            yield subject, {"core": CORE, "trace": TRACE}[space] + local, _term(value)


def link(subject: str, predicate: str, *objects: str) -> Iterator[Statement]:
    """One statement for each of ``objects``, which are IRIs."""
    for target in objects:
        yield subject, predicate, node(target)


def quads_of(graphs: Iterable[tuple[str, Iterable[Statement]]]) -> Iterator[Quad]:
    """The statements of each graph, by the graph's IRI."""
    for graph, statements in graphs:
        name = node(graph)
        for subject, predicate, term in statements:
            yield Quad(node(subject), node(predicate), term, name)


def _term(value: str | bool | float | Term) -> Term:  # noqa: FBT001 - the value is the whole argument
    if isinstance(value, bool):
        return boolean(value)
    if isinstance(value, int):
        return integer(value)
    if isinstance(value, float):
        return double(value)
    return Literal(value) if isinstance(value, str) else value
