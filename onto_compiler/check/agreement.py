"""Whether the rules agree: run over every case that a required fact can be in, two of them may not conclude otherwise.

The cases are those of :mod:`onto_compiler.tables`, which refuses such rules when a task is diagnosed; here each rule is
named, with the case.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import replace

from pyoxigraph import NamedNode

from onto_compiler.check.coverage import check_coverage
from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.compile_schema import compile_schema
from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, RDF, RDFS, SH, shorten
from onto_compiler.schema import Schema, local_name
from onto_compiler.tables import DiagnosisEntry, DiagnosisKey, Disagreement, RouteEntry, RuleTables, compile_tables

__all__ = ["check_agreement"]

_TYPE = RDF + "type"
_TEXT, _CONDITION, _RULE = (NamedNode(SH + name) for name in ("construct", "condition", "rule"))
_MAY_DISTURB = tuple(
    NamedNode(iri)
    for iri in (SH + "construct", CORE + "admits", CORE + "onRejection", CORE + "arity", RDFS + "subClassOf")
)


def check_agreement(model: Model, named: AbstractSet[str] | None = None) -> Iterator[Finding]:
    """Rules with different conclusions, and cases without one; nothing runs where no reported file can matter.

    ``named`` are the IRIs in the texts of the rules, which then run on one of all predicates that differ in none of
    these; without it they run on every predicate.
    """
    if not any(
        next(model.store.quads_for_pattern(None, predicate, None, graph), None) is not None
        for graph in model.graphs
        for predicate in _MAY_DISTURB
    ):
        return
    disagreements: list[Disagreement] = []
    try:
        schema = compile_schema(model.store)
        likes = _likes(model, schema, named)
        chosen = {iri: schema.predicates[iri] for iri in likes.values()}
        tables = compile_tables(model.store, replace(schema, predicates=chosen), disagreements, model.graph)
    except (OntoError, ValueError):  # a declaration that does not compile is a finding of another check
        return
    yield from check_coverage(model, schema, _expanded(tables, likes))
    cases: dict[tuple[object, ...], list[Disagreement]] = {}
    for one in disagreements:
        cases.setdefault(one.key, []).append(one)
    seen = set()
    for together in cases.values():
        # Conclusions meet at one node, so that each rule seems to have concluded what any of them did.
        entries = [entry for one in together for entry in (one.first, one.second)]
        rules = tuple(sorted({entry.rule for entry in entries}))
        if rules not in seen:
            seen.add(rules)
            yield from _findings(together[0], rules, sorted({_conclusion(entry) for entry in entries}))


def _likes(model: Model, schema: Schema, named: AbstractSet[str] | None) -> Mapping[str, str]:
    """Each predicate with the first one of which the rules know the same."""
    graph = model.graph
    texts = graph.holders(_TEXT)
    if named is None or graph.holders(_CONDITION) or any(rule not in texts for rule in graph.values(_RULE)):
        return {iri: iri for iri in schema.predicates}  # what rules without a text read, is in no text
    read = [prop for iri in sorted({*named, _TYPE}) if graph.holders(prop := NamedNode(iri))]
    first: dict[object, str] = {}
    likes = {}
    for iri in schema.predicates:
        term = NamedNode(iri)
        known = tuple(frozenset(graph.objects(term, prop)) for prop in read)
        of_it = tuple(frozenset(graph.subjects(prop, term)) for prop in read)
        likes[iri] = first.setdefault((known, of_it, iri if iri in named else ""), iri)
    return likes


def _expanded(tables: RuleTables, likes: Mapping[str, str]) -> RuleTables:
    """The diagnosis table of all predicates, from that of the few that the rules ran on."""
    of: dict[str, list[tuple[DiagnosisKey, DiagnosisEntry]]] = {}
    for key, entry in tables.diagnosis.items():
        of.setdefault(key[0], []).append((key, entry))
    diagnosis = {(iri, *key[1:]): entry for iri, like in likes.items() for key, entry in of.get(like, ())}
    return replace(tables, diagnosis=diagnosis)


def _findings(one: Disagreement, rules: tuple[str, ...], conclusions: list[str]) -> Iterator[Finding]:
    for rule in rules:
        others = [other for other in rules if other != rule]
        values: dict[str, Term | str] = {
            "others": " and ".join(f"`{shorten(other)}`" for other in others),
            "conclusions": " and ".join(f"`{shorten(each)}`" for each in conclusions),
            "fact": NamedNode(one.key[0]),
        }
        beside = " and {others} conclude" if others else " concludes"
        yield Finding(
            "RUL015",
            "error",
            f"`{{subject}}`{beside} {{conclusions}} of one `{{fact}}` {_case(one)}",
            "let the rules exclude each other by kind, polarity or status",
            NamedNode(rule),
            NamedNode(SH + "construct"),
            values=values,
        )


def _conclusion(entry: DiagnosisEntry | RouteEntry) -> str:
    return entry.route if isinstance(entry, RouteEntry) else entry.failure


def _case(one: Disagreement) -> str:
    key = one.key
    if isinstance(key[1], bool):
        return f"{'required to hold' if key[1] else 'required not to hold'}, with status {local_name(str(key[2]))}"
    return f"with failure {local_name(key[1])}, at {local_name(str(key[2]))}"
