"""Whether every way in which a required fact can be unmet has a failure class, before a task is diagnosed (RUN003)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pyoxigraph import NamedNode

from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.rdf import RDF, SH
from onto_compiler.schema import PredicateSignature, Schema, local_name
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED, RuleTables

__all__ = ["check_coverage", "undiagnosed"]

_TYPE = NamedNode(RDF + "type")
_RULE = NamedNode(SH + "rule")
_HINT = "give the predicate a kind that the rules speak of, or write a rule of kind, polarity and status"
_SHAPES = """
SELECT DISTINCT ?shape WHERE {
    ?shape sh:rule/sh:construct ?text
    FILTER CONTAINS(STRBEFORE(UCASE(STR(?text)), "WHERE"), "FAILURECLASS") }"""

Cases = tuple[tuple[bool, tuple[str, ...]], ...]  # (polarity, statuses)


def undiagnosed(predicate: PredicateSignature, tables: RuleTables) -> Cases:
    """The polarities and statuses that no rule diagnoses; without a margin, none can be violated."""
    statuses = (ABSENT, EXPLICITLY_FALSE, *((MARGIN_VIOLATED,) if predicate.margin_unit else ()))
    found = []
    for polarity in (True, False):
        missing = tuple(one for one in statuses if (predicate.iri, polarity, one) not in tables.diagnosis)
        if missing:
            found.append((polarity, missing))
    return tuple(found)


def check_coverage(model: Model, schema: Schema, tables: RuleTables) -> Iterator[Finding]:
    """One finding for each predicate with such cases, or at the rules, for each kind, where only those are reported."""
    elsewhere: dict[tuple[str, Cases], list[str]] = {}
    for iri, predicate in schema.predicates.items():
        cases = undiagnosed(predicate, tables)
        if cases and _is_reported(model, iri):
            yield _finding(cases, {"fact": NamedNode(iri)}, "", NamedNode(iri), _TYPE, NamedNode(predicate.kind))
        elif cases:
            elsewhere.setdefault((predicate.kind, cases), []).append(iri)
    if not elsewhere:
        return
    shapes = [row["shape"] for row in model.rows(_SHAPES)]
    for (kind, cases), predicates in elsewhere.items():
        values = {"fact": NamedNode(min(predicates)), "kind": NamedNode(kind)}
        for shape in shapes:
            yield _finding(cases, values, ", and so of any `{kind}`" if len(predicates) > 1 else "", shape, _RULE, None)


def _is_reported(model: Model, iri: str) -> bool:
    quads = model.store.quads_for_pattern(NamedNode(iri), _TYPE, None, None)
    return any(quad.graph_name in model.graphs for quad in quads)


def _finding(
    cases: Cases, values: Mapping[str, Term], more: str, subject: Term, predicate: NamedNode, value: Term | None
) -> Finding:
    reasons = ", nor ".join(
        f"{'required to hold' if polarity else 'required not to hold'} and {' or '.join(map(local_name, statuses))}"
        for polarity, statuses in cases
    )
    message = f"no rule names the failure of `{{fact}}`{more}: {reasons}"
    # Few goals are negated: a rule for those is advice, until a task needs it.
    severity = "error" if any(polarity for polarity, _ in cases) else "warning"
    return Finding("RUL016", severity, message, _HINT, subject, predicate, value, values=values, general=True)
