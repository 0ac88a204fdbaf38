"""Names that look like terms of a standard vocabulary and are none: RDF accepts them, and nothing reads them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.vocabularies import meant

__all__ = ["check_terms"]


def check_terms(model: Model) -> Iterator[Finding]:
    """Each term of the reported files that claims to be one of a standard vocabulary, and is none."""
    known: dict[str, str | None] = {}

    def unknown(term: Term) -> str | None:
        if not isinstance(term, NamedNode):
            return None
        if term.value not in known:
            known[term.value] = meant(term.value)
        return known[term.value]

    for quad in model.written:
        if quad.graph_name not in model.graphs:
            continue
        subject, predicate, value = cast("tuple[Term, Term, Term]", (quad.subject, quad.predicate, quad.object))
        if (hint := unknown(subject)) is not None:
            yield _finding(subject, hint, subject)
        if (hint := unknown(predicate)) is not None:
            yield _finding(predicate, hint, subject, predicate)
        named = value.datatype if isinstance(value, Literal) else value
        if (hint := unknown(named)) is not None:
            yield _finding(named, hint, subject, predicate, value)


def _finding(term: Term, hint: str, subject: Term, predicate: Term | None = None, value: Term | None = None) -> Finding:
    message = "`{term}` is no term of its vocabulary"
    return Finding("VOC011", "error", message, hint, subject, predicate, value, values={"term": term})
