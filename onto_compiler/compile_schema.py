"""TBox in, :class:`Schema` out: one SPARQL query per table, run by Oxigraph."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import cast

from pyoxigraph import Literal, NamedNode, QuerySolutions, Store

from onto_compiler.hierarchy import Hierarchy
from onto_compiler.problems import OntoError
from onto_compiler.rdf import CORE, OWL, RDF, RDFS, node, prologue
from onto_compiler.schema import (
    Binding,
    JointThreshold,
    PreconditionRule,
    PredicateSignature,
    Route,
    Schema,
    Score,
    ScoreTerm,
    local_name,
)
from onto_compiler.sources import load_store

__all__ = ["compile_schema", "load_schema", "read_hierarchy"]

_PREDICATES = """
SELECT ?this ?kind ?name ?domain ?range ?unit ?grounded ?definition ?tolerance ?moves ?acyclic WHERE {
    ?this a ?kind . ?kind rdfs:subClassOf* core:Predicate .
    OPTIONAL { ?this skos:notation ?name } OPTIONAL { ?this skos:definition ?definition }
    OPTIONAL { ?this core:domain ?domain } OPTIONAL { ?this core:range ?range }
    OPTIONAL { ?this core:marginUnit ?unit } OPTIONAL { ?this core:groundedBy ?grounded }
    OPTIONAL { ?this core:tolerance ?tolerance }
    OPTIONAL { ?kind rdfs:subClassOf*/core:movesArgument ?moves }
    BIND (EXISTS { ?this core:characteristic core:Acyclic } AS ?acyclic)
} ORDER BY ?this ?kind"""
_BINDINGS = """
SELECT ?this ?native ?first ?second ?lifts ?grounded ?order ?pattern ?threshold ?tolerance ?premise ?domain ?margin
WHERE {
    ?this a core:Binding ; core:native ?native ; core:lifts ?lifts ; core:groundedBy ?grounded .
    OPTIONAL { ?this core:nativeArgument1 ?first } OPTIONAL { ?this core:nativeArgument2 ?second }
    OPTIONAL { ?this core:order ?order } OPTIONAL { ?this core:landmarkPattern ?pattern }
    OPTIONAL { ?this core:bindsThreshold ?threshold } OPTIONAL { ?this core:premiseTolerance ?tolerance }
    OPTIONAL { ?this core:premiseGroundedBy ?premise } OPTIONAL { ?this core:nativeDomain ?domain }
    OPTIONAL { ?this core:goalMargin ?margin }
} ORDER BY ?order ?this"""
_THRESHOLDS = """
SELECT ?this ?category ?native ?above ?bound ?inclusive ?every ?unit WHERE {
    ?this a/rdfs:subClassOf* core:Threshold ; core:category ?category ; core:native ?native ; core:above ?above ;
        core:bound ?bound ; core:inclusive ?inclusive ; core:everyJoint ?every ; core:unit ?unit .
} ORDER BY ?this"""
_ROUTES = """
SELECT ?this ?name ?level ?admits ?supports ?next WHERE {
    ?this a/rdfs:subClassOf* core:CorrectionRoute ; core:level/skos:notation ?level .
    OPTIONAL { ?this skos:notation ?name } OPTIONAL { ?this core:admits ?admits }
    OPTIONAL { ?this core:supports ?supports } OPTIONAL { ?this core:onRejection ?next }
} ORDER BY ?this"""
_PRECONDITIONS = """
SELECT ?this ?precedes ?argument ?class ?native ?holds ?others ?extends WHERE {
    ?this a core:Precondition ; core:precedes ?precedes ; core:ofArgument ?argument ; core:argumentClass ?class ;
        core:native ?native .
    OPTIONAL { ?this core:mustHold ?holds } OPTIONAL { ?this core:othersOf ?others }
    OPTIONAL { ?this core:extendsTo ?extends }
} ORDER BY ?this ?precedes"""
_FAILURES = """
SELECT ?this ?priority WHERE {
    ?this rdfs:subClassOf+ core:Failure . OPTIONAL { ?this core:priority ?priority } } ORDER BY ?this"""
_CATEGORIES = """
SELECT ?this ?type ?category ?region ?class WHERE {
    VALUES ?type { core:Category core:RegionCategory core:Default }
    ?this a ?type ; core:category ?category ; core:instanceClass ?class . OPTIONAL { ?this core:region ?region }
} ORDER BY ?this"""
_SCORES = """
SELECT ?this ?name ?term ?field ?weight ?predicate WHERE {
    ?this a plan:Score ; plan:term ?term . ?term plan:field ?field ; plan:weight ?weight .
    OPTIONAL { ?this skos:notation ?name } OPTIONAL { ?term plan:ofPredicate ?predicate }
} ORDER BY ?this ?field ?predicate"""
_LABELS = "SELECT ?this ?label WHERE { ?this rdfs:label ?label }"
_SYMBOLS = "SELECT ?this ?symbol WHERE { ?this qudt:symbol ?symbol }"
_NOTATIONS = "SELECT ?this ?notation WHERE { ?this skos:notation ?notation }"

Row = Mapping[str, str]


@lru_cache(maxsize=4)
def load_schema(*extra: str | Path) -> Schema:
    """The shipped TBox and bindings, with the user's own Turtle on top, as a :class:`Schema`."""
    return compile_schema(load_store(extra))


def compile_schema(store: Store) -> Schema:
    """Read every table of the schema out of ``store`` (all its graphs).

    Raises:
        OntoError: SCH001 if a declaration lacks what its table needs; `onto check` reports the line.

    """
    closure = read_hierarchy(store)
    categories, regions, defaults = _categories(store)
    return Schema(
        classes=closure,
        predicates=_predicates(store, closure),
        failures={row["this"]: int(row.get("priority", 1000)) for row in _rows(store, _FAILURES)},
        routes=_routes(store),
        bindings=_bindings(store),
        thresholds=_thresholds(store),
        categories=categories,
        regions=regions,
        defaults=defaults,
        labels={row["this"]: row["label"] for row in _rows(store, _LABELS)},
        preconditions=_preconditions(store),
        notations={row["this"]: row["notation"] for row in _rows(store, _NOTATIONS)},
        scores=_scores(store),
        symbols={row["this"]: row["symbol"] for row in _rows(store, _SYMBOLS)},
    )


def read_hierarchy(store: Store) -> Hierarchy:
    """The classes of ``store`` with what is above each, by ``rdfs:subClassOf``."""
    above: dict[str, list[str]] = {}
    for quad in store.quads_for_pattern(None, node(RDFS + "subClassOf"), None, None):
        if not isinstance(quad.object, Literal):
            above.setdefault(_name(quad.subject), []).append(_name(quad.object))
    declared = store.quads_for_pattern(None, node(RDF + "type"), node(OWL + "Class"), None)
    return Hierarchy([quad.subject.value for quad in declared if isinstance(quad.subject, NamedNode)], above)


def _name(term: object) -> str:
    return term.value if isinstance(term, NamedNode) else str(term)


def _rows(store: Store, query: str) -> Iterator[Row]:
    solutions = cast("QuerySolutions", store.query(prologue() + query, use_default_graph_as_union=True))
    names = [variable.value for variable in solutions.variables]
    for solution in solutions:
        yield {name: solution[name].value for name in names if solution[name] is not None}


def _predicates(store: Store, classes: Mapping[str, frozenset[str]]) -> dict[str, PredicateSignature]:
    found: dict[str, PredicateSignature] = {}
    for row in _rows(store, _PREDICATES):
        earlier = found.get(row["this"])
        # A predicate typed with a kind and with one of its superclasses keeps the narrower kind.
        if earlier is not None and row["kind"] in classes.get(earlier.kind, ()):
            continue
        parameters = tuple(row[key] for key in ("domain", "range") if key in row)
        moves = int(row.get("moves", 0)) - 1
        found[row["this"]] = PredicateSignature(
            iri=row["this"],
            name=row.get("name", local_name(row["this"])),
            kind=row["kind"],
            parameters=parameters,
            margin_unit=row.get("unit"),
            grounded_by=row.get("grounded"),
            definition=row.get("definition", ""),
            acyclic=row["acyclic"] == "true",
            tolerance=float(row["tolerance"]) if "tolerance" in row else None,
            moves=moves if 0 <= moves < len(parameters) else None,
        )
    return found


def _bindings(store: Store) -> tuple[Binding, ...]:
    return tuple(
        Binding(
            iri=row["this"],
            native=row["native"],
            arguments=tuple(row[key] for key in ("first", "second") if key in row),
            lifts=row["lifts"],
            grounded_by=row["grounded"],
            order=int(row.get("order", 1000)),
            landmark=_pattern(row["this"], row["pattern"]) if "pattern" in row else None,
            threshold=row.get("threshold") == "true",
            premise_grounded_by=row.get("premise"),
            domain=row.get("domain", ""),
            premise_tolerance=float(row.get("tolerance", 0)),
            goal_margin=float(row.get("margin", 0)),
        )
        for row in sorted(_rows(store, _BINDINGS), key=lambda row: (int(row.get("order", 1000)), row["this"]))
    )


def _pattern(iri: str, text: str) -> re.Pattern[str]:
    """A ``core:landmarkPattern``: named groups are written ``(?<name>...)``, as JavaScript has them."""
    try:
        pattern = re.compile(re.sub(r"\(\?<(?=\w)", "(?P<", text))
    except re.error as error:
        raise OntoError.of("SCH001", f"the landmark pattern of {iri} is not a regular expression: {error}") from error
    if "landmark" not in pattern.groupindex:
        raise OntoError.of("SCH001", f"the landmark pattern of {iri} has no group `(?<landmark>...)`")
    return pattern


def _thresholds(store: Store) -> dict[tuple[str, str], JointThreshold]:
    return {
        (row["category"], row["native"]): JointThreshold(
            iri=row["this"],
            category=row["category"],
            native=row["native"],
            above=row["above"] == "true",
            bound=float(row["bound"]),
            inclusive=row["inclusive"] == "true",
            every_joint=row["every"] == "true",
            unit=row["unit"],
        )
        for row in _rows(store, _THRESHOLDS)
    }


def _routes(store: Store) -> dict[str, Route]:
    gathered: dict[str, dict[str, set[str]]] = {}
    for row in _rows(store, _ROUTES):
        fields = gathered.setdefault(row["this"], {})
        for key, value in row.items():
            fields.setdefault(key, set()).add(value)
    return {
        iri: Route(
            iri=iri,
            name=_one(fields, "name") or local_name(iri),
            level=_one(fields, "level") or "",
            admits=frozenset(fields.get("admits", ())),
            supports=frozenset(fields.get("supports", ())),
            on_rejection=_one(fields, "next"),
        )
        for iri, fields in gathered.items()
    }


def _preconditions(store: Store) -> tuple[PreconditionRule, ...]:
    rows: dict[str, list[Row]] = {}
    for row in _rows(store, _PRECONDITIONS):
        rows.setdefault(row["this"], []).append(row)
    return tuple(
        PreconditionRule(
            iri=iri,
            precedes=frozenset(row["precedes"] for row in each),
            argument=int(each[0]["argument"]) - 1,
            argument_class=each[0]["class"],
            native=each[0]["native"],
            must_hold=each[0].get("holds") != "false",
            others=each[0].get("others"),
            extends=frozenset(row["extends"] for row in each if "extends" in row),
        )
        for iri, each in rows.items()
    )


def _scores(store: Store) -> dict[str, Score]:
    found: dict[str, Score] = {}
    for row in _rows(store, _SCORES):
        name = row.get("name", local_name(row["this"]))
        term = ScoreTerm(row["field"], _weight(row), row.get("predicate"))
        known = found.get(name)
        found[name] = Score(row["this"], name, (*(known.terms if known else ()), term))
    return found


def _weight(row: Row) -> float:
    try:
        weight = float(row["weight"])
    except ValueError:
        weight = math.nan
    if not (math.isfinite(weight) and weight >= 0):
        message = (
            f"the weight {row['weight']} of {local_name(row['field'])} in {row['this']} is not a number of 0 or more"
        )
        raise OntoError.of("SCH001", message, "write a decimal number; see `onto explain SCR002`")
    return weight


def _one(fields: Mapping[str, set[str]], key: str) -> str | None:
    return min(fields[key]) if key in fields else None


def _categories(store: Store) -> tuple[dict[str, str], dict[tuple[str, str], str], dict[str, str]]:
    categories: dict[str, str] = {}
    regions: dict[tuple[str, str], str] = {}
    defaults: dict[str, str] = {}
    for row in _rows(store, _CATEGORIES):
        match row["type"].removeprefix(CORE):
            case "Category":
                categories[row["category"]] = row["class"]
            case "RegionCategory":
                regions[row["category"], row.get("region", "")] = row["class"]
            case _:
                defaults[row["category"]] = row["class"]
    return categories, regions, defaults
