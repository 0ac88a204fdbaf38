"""Names that look like terms of a standard vocabulary and are none: RDF accepts them, and nothing reads them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.check.vocabularies import TERMS
from onto_compiler.problems import near
from onto_compiler.rdf import RDF, shorten

__all__ = ["check_terms", "meant"]

_LOCAL = re.compile(r"[^#/]*$")
_ITEM = re.compile(r"_[1-9][0-9]*")  # rdf:_1, rdf:_2 and so on are terms without end


def check_terms(model: Model) -> Iterator[Finding]:
    """Each term of the reported files that lies in a namespace of :data:`TERMS` and is none of its names."""
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


def meant(iri: str) -> str | None:
    """What to write instead of ``iri``, where it claims to be a term of :data:`TERMS`; None for any other."""
    local = _LOCAL.search(iri)
    namespace = iri[: local.start()] if local else iri
    names = TERMS.get(namespace)
    name = iri[len(namespace) :]
    if names is None or not name or name in names or (namespace == RDF and _ITEM.fullmatch(name)):
        return None
    same = next((one for one in names if one.lower() == name.lower()), None)
    question = f"did you mean `{same}`?" if same else near(name, sorted(names))
    whole = question.replace("`", f"`{shorten(namespace + 'x')[:-1]}", 1)
    return whole or "look the name up in that vocabulary, or mint a term in a namespace of your own"


def _finding(term: Term, hint: str, subject: Term, predicate: Term | None = None, value: Term | None = None) -> Finding:
    message = "`{term}` is no term of its vocabulary"
    return Finding("VOC011", "error", message, hint, subject, predicate, value, values={"term": term})
