"""The scores of predicted plans: each score's terms with their weights."""

from __future__ import annotations

from onto_compiler.html import Html, element, joined, table
from onto_compiler.rdf import PREFIXES
from onto_compiler.reference.model import Reference
from onto_compiler.reference.terms import about, named
from onto_compiler.schema import Score

__all__ = ["scores_section"]

_WORTH = PREFIXES["plan"] + "Worth"


def scores_section(reference: Reference) -> Html:
    """One row for each score; worth is taken off what costs add up to."""
    rows = [
        (named(reference, score.iri), _terms(reference, score), about(reference, score.iri))
        for score in sorted(reference.schema.scores.values(), key=lambda score: score.name)
    ]
    return table("What a plan costs, each field by its weight", ("score", "terms", "meaning"), rows)


def _terms(reference: Reference, score: Score) -> Html:
    worth = set(reference.instances(_WORTH))
    parts = []
    for term in score.terms:
        sign = "\N{MINUS SIGN}" if term.field in worth else "+"
        of = ["(", reference.link(term.predicate), ")"] if term.predicate else []
        parts.append(element("p", f"{sign} {term.weight:g} ", reference.link(term.field), *of))
    return joined(parts)
