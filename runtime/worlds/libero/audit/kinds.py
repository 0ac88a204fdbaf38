"""The kinds of premise failure, as declared in the ontology: the measure of each, and its tolerance."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

from pyoxigraph import QuerySolutions

from onto_compiler.problems import OntoError, near
from onto_compiler.rdf import prologue
from onto_compiler.schema import local_name
from onto_compiler.sources import load_store

__all__ = ["Kind", "load_kinds"]

_QUERY = """
SELECT ?kind ?name ?measure ?most ?unit ?symbol WHERE {
    ?kind rdfs:subClassOf+ audit:PremiseFailure ; audit:measuredBy ?measure .
    OPTIONAL { ?kind skos:notation ?name } OPTIONAL { ?kind audit:tolerates ?most }
    OPTIONAL { ?kind core:unit ?unit . OPTIONAL { ?unit qudt:symbol ?symbol } }
}
"""


@dataclass(frozen=True, slots=True)
class Kind:
    """A class below ``audit:PremiseFailure``. ``most`` is in ``unit``; None if the measure itself decides."""

    iri: str
    name: str
    measure: str
    most: float | None
    unit: str


def load_kinds(
    extra: Sequence[str | Path] = (), *, measures: Collection[str], deciding: Collection[str]
) -> tuple[Kind, ...]:
    """The kinds of the shipped ontology and of ``extra``, by name.

    Raises:
        OntoError: ``RUN020`` if a kind names none of ``measures``, or does not say how much it tolerates of one
            that is not among the ``deciding``; TTL as ``load_store``.
    """
    store = load_store(extra)
    rows = store.query(prologue() + _QUERY, use_default_graph_as_union=True)
    if not isinstance(rows, QuerySolutions):
        raise TypeError("a SELECT query gives solutions")
    found = {}
    for row in rows:
        iri, name, measure, most, unit, symbol = (None if term is None else term.value for term in row)
        if iri is None or measure is None:
            continue
        if measure not in measures:
            raise OntoError.of(
                "RUN020",
                f"`{local_name(iri)}` is measured by `{measure}`, and no measure is called so",
                near(measure, measures) or f"one of: {', '.join(sorted(measures))}",
            )
        if (most is None) is not (measure in deciding):
            what = "is decided by its measure, and tolerates" if most else "does not say how much it tolerates of"
            raise OntoError.of(
                "RUN020",
                f"`{local_name(iri)}` {what} `{most or measure}`",
                f"only {', '.join(f'`{each}`' for each in sorted(deciding))} go without `audit:tolerates`",
            )
        shown = symbol or ("" if unit is None else local_name(unit))
        found[iri] = Kind(iri, name or local_name(iri), measure, None if most is None else float(most), shown)
    return tuple(sorted(found.values(), key=lambda kind: kind.name))
