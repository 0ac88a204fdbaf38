"""Rules as lookup tables: the rule base is run once over every evidence status that a required fact can have.

A control loop or a planner then diagnoses by lookup. The tables hold what the rules concluded and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import cast

from pyoxigraph import NamedNode, Quad, QuerySolutions, Store

from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, RDF, boolean, node, prologue
from onto_compiler.rules import Rule, apply_rules, read_rules
from onto_compiler.schema import Schema
from onto_compiler.shacl.graph import Graph

__all__ = [
    "ABSENT",
    "ATTEMPT_STATUSES",
    "EXHAUSTED",
    "EXPLICITLY_FALSE",
    "FIRST",
    "LEVELS",
    "MARGIN_VIOLATED",
    "REPEAT",
    "SATISFIED",
    "STATUSES",
    "DiagnosisEntry",
    "Disagreement",
    "RouteEntry",
    "RouteKey",
    "RuleTables",
    "compile_tables",
]

SATISFIED, ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED = STATUSES = tuple(
    CORE + name for name in ("Satisfied", "Absent", "ExplicitlyFalse", "MarginViolated")
)
FIRST, REPEAT, EXHAUSTED = ATTEMPT_STATUSES = tuple(
    CORE + name for name in ("FirstAttempt", "RepeatAttempt", "ExhaustedAttempt")
)
LEVELS = {
    word: CORE + name for word, name in (("plan", "PlanLevel"), ("state", "StateLevel"), ("action", "ActionLevel"))
}
_TYPE, _OBSERVED = node(RDF + "type"), node(CORE + "ObservedFact")
_FACT, _PREDICATE, _POLARITY, _STATUS, _FAILURE, _ATTEMPT, _LEVEL, _PREVIOUS = (
    node(CORE + name)
    for name in (
        *("fact", "predicate", "polarity", "status"),
        *("failureClass", "attemptStatus", "requestedLevel", "previousRoute"),
    )
)
_CASES = NamedNode("urn:onto-evwm:cases")
_DIAGNOSED = """
SELECT ?this ?failure ?rule ?priority WHERE {
    ?this core:failureClass ?failure ; core:diagnosedBy ?rule . OPTIONAL { ?this core:priority ?priority }
} ORDER BY ?this ?failure ?rule ?priority"""
_ROUTED = """
SELECT ?this ?route ?decision ?rule WHERE {
    ?this core:route ?route ; core:decision ?decision ; core:routedBy ?rule } ORDER BY ?this ?route ?decision ?rule"""

DiagnosisKey = tuple[str, bool, str]  # predicate, polarity, status
RouteKey = tuple[str, str, str, str | None, str]  # predicate, failure, attempt status, previous route, level


@dataclass(frozen=True, slots=True)
class DiagnosisEntry:
    """The conclusions of the diagnosis and priority rules for one combination."""

    failure: str
    rule: str
    priority: int


@dataclass(frozen=True, slots=True)
class RouteEntry:
    """The conclusions of the routing rules for one combination."""

    route: str
    decision: str
    rule: str


@dataclass(frozen=True, slots=True)
class RuleTables:
    """``diagnosis[predicate, polarity, status]`` and ``routing[predicate, failure, attempt status, previous, level]``.

    The previous route is one of the same level, whose word (``state``) ends the key. A combination that is missing is
    one that no rule covers.
    """

    diagnosis: Mapping[DiagnosisKey, DiagnosisEntry]
    routing: Mapping[RouteKey, RouteEntry]


@dataclass(frozen=True, slots=True)
class Disagreement:
    """Two conclusions of one combination; the table holds the first."""

    key: DiagnosisKey | RouteKey
    first: DiagnosisEntry | RouteEntry
    second: DiagnosisEntry | RouteEntry


def compile_tables(
    store: Store, schema: Schema, disagreements: list[Disagreement] | None = None, graph: Graph | None = None
) -> RuleTables:
    """Run the rules of ``store`` over every combination that ``schema`` allows; ``store`` itself stays as it is.

    Given a list, disagreements are added to it and do not raise. ``graph`` is as :func:`read_rules` has it.

    Raises:
        OntoError: RUN002 if two rules conclude different things of the same combination.
    """
    scratch = Store()
    scratch.extend(iter(store))
    rules = read_rules(store, graph)
    found: list[Disagreement] = []
    diagnosis = _diagnose(scratch, rules, schema, found)
    routing = _route(scratch, rules, schema, diagnosis, found)
    if disagreements is not None:
        disagreements += found
    elif found:
        first = found[0]
        raise OntoError.of(
            "RUN002",
            f"rules disagree on {first.key}: {first.first} and {first.second}",
            "let the two rules exclude each other",
        )
    return RuleTables(diagnosis=diagnosis, routing=routing)


def _diagnose(
    scratch: Store, rules: tuple[Rule, ...], schema: Schema, disagreements: list[Disagreement]
) -> dict[DiagnosisKey, DiagnosisEntry]:
    cases: dict[NamedNode, DiagnosisKey] = {}
    for number, key in enumerate(product(schema.predicates, (True, False), STATUSES)):
        cases[NamedNode(f"{_CASES.value}:observed:{number}")] = key
    scratch.extend(quad for case, key in cases.items() for quad in _observed(case, *key))
    apply_rules(scratch, rules, _CASES, cases)
    found: dict[DiagnosisKey, DiagnosisEntry] = {}
    for this, failure, rule, priority in _table(scratch, _DIAGNOSED, ("failure", "rule", "priority")):
        if this in cases:
            entry = DiagnosisEntry(failure, rule, int(priority or 1000))
            if (earlier := found.setdefault(cases[this], entry)) != entry:
                disagreements.append(Disagreement(cases[this], earlier, entry))
    return found


def _route(
    scratch: Store,
    rules: tuple[Rule, ...],
    schema: Schema,
    diagnosis: Mapping[DiagnosisKey, DiagnosisEntry],
    disagreements: list[Disagreement],
) -> dict[RouteKey, RouteEntry]:
    pairs = sorted({(predicate, entry.failure) for (predicate, _, _), entry in diagnosis.items()})
    cases: dict[NamedNode, RouteKey] = {}
    for level in LEVELS:
        routes = [iri for iri, route in schema.routes.items() if route.level == level]
        for number, (pair, status, previous) in enumerate(product(pairs, ATTEMPT_STATUSES, (None, *routes))):
            if routes and (status == FIRST) == (previous is None):
                cases[NamedNode(f"{_CASES.value}:{level}:{number}")] = (*pair, status, previous, level)
    scratch.extend(quad for case, key in cases.items() for quad in _failed(case, *key))
    apply_rules(scratch, rules, _CASES, cases)
    found: dict[RouteKey, RouteEntry] = {}
    for this, route, decision, rule in _table(scratch, _ROUTED, ("route", "decision", "rule")):
        if this in cases:
            chosen = RouteEntry(route, decision, rule)
            if (earlier := found.setdefault(cases[this], chosen)) != chosen:
                disagreements.append(Disagreement(cases[this], earlier, chosen))
    return found


def _observed(case: NamedNode, predicate: str, polarity: bool, status: str) -> Iterator[Quad]:  # noqa: FBT001
    fact = NamedNode(f"{case.value}:fact")
    yield Quad(fact, _PREDICATE, node(predicate), _CASES)
    yield Quad(fact, _POLARITY, boolean(polarity), _CASES)
    yield Quad(case, _TYPE, _OBSERVED, _CASES)
    yield Quad(case, _FACT, fact, _CASES)
    yield Quad(case, _STATUS, node(status), _CASES)


def _failed(
    case: NamedNode, predicate: str, failure: str, status: str, previous: str | None, level: str
) -> Iterator[Quad]:
    fact = NamedNode(f"{case.value}:fact")
    yield Quad(fact, _PREDICATE, node(predicate), _CASES)
    yield Quad(case, _TYPE, node(failure), _CASES)
    yield Quad(case, _FAILURE, node(failure), _CASES)
    yield Quad(case, _FACT, fact, _CASES)
    yield Quad(case, _ATTEMPT, node(status), _CASES)
    yield Quad(case, _LEVEL, node(LEVELS[level]), _CASES)
    if previous is not None:
        yield Quad(case, _PREVIOUS, node(previous), _CASES)


def _table(store: Store, query: str, names: Iterable[str]) -> Iterator[tuple[NamedNode, str, str, str]]:
    for row in cast("QuerySolutions", store.query(prologue() + query, use_default_graph_as_union=True)):
        values = tuple("" if row[name] is None else row[name].value for name in names)
        yield (cast("NamedNode", row["this"]), *values)  # type: ignore[misc]
