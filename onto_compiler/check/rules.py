"""Checks on the text of rules (``sh:SPARQLRule``), which SPARQL over the ontology cannot look into.

Source: SHACL Advanced Features, section 8 (rules); the project's own restrictions are that a rule reads finite statuses
only, writes about its focus node only, and never reads what it or a later rule writes, so that one pass is enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from pyoxigraph import Literal, NamedNode, QueryTriples, Store

from onto_compiler.check.agreement import check_agreement
from onto_compiler.check.finding import Finding, Term
from onto_compiler.check.model import Model
from onto_compiler.check.order import check_order
from onto_compiler.check.patterns import Construct, Name, Step, read_construct
from onto_compiler.compile_schema import read_hierarchy
from onto_compiler.rdf import CORE, PREFIXES, SH
from onto_compiler.sparql_faults.explain import query_fault
from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["check_rules"]

_CONSTRUCT = NamedNode(SH + "construct")
_PREDICATE = CORE + "Predicate"
_FAILURE_CLASS = CORE + "failureClass"
_RULES = """
SELECT ?rule ?text ?order WHERE { ?rule a sh:SPARQLRule ; sh:construct ?text . OPTIONAL { ?rule sh:order ?order } }"""
_PREFIXES = """
SELECT ?rule ?prefix ?namespace WHERE {
    ?rule a sh:SPARQLRule ; sh:prefixes/owl:imports*/sh:declare ?declaration .
    ?declaration sh:prefix ?prefix ; sh:namespace ?namespace }"""
_DECLARED = "SELECT DISTINCT ?term WHERE { ?term a ?any FILTER isIRI(?term) }"
_NAMESPACES = """
SELECT DISTINCT ?namespace WHERE {
    ?term rdfs:isDefinedBy ?any FILTER isIRI(?term)
    BIND (REPLACE(STR(?term), "[^#/]*$", "") AS ?namespace) }"""
_CONTINUOUS = """
SELECT ?property WHERE { ?property rdfs:range ?range VALUES ?range { xsd:double xsd:decimal xsd:float } }"""
_RANGES = """
SELECT ?property ?range ?instance WHERE {
    ?property rdfs:range ?range . FILTER STRSTARTS(STR(?property), STR(core:)) ?instance a/rdfs:subClassOf* ?range }"""
_FAILURES = "SELECT ?class WHERE { ?class rdfs:subClassOf* core:Failure }"
_LEAVES = """
SELECT ?class ?priority WHERE {
    ?class rdfs:subClassOf+ core:PredicateFailure FILTER NOT EXISTS { ?narrower rdfs:subClassOf ?class }
    OPTIONAL { ?class core:priority ?priority } }"""
_ROUTES = """
SELECT ?failure ?kind ?residual WHERE {
    ?route core:admits ?failure ; core:supports ?kind
    BIND (EXISTS { ?route a core:ResidualRoute } AS ?residual) }"""
_USED_KINDS = "SELECT DISTINCT ?kind WHERE { ?predicate a ?kind . ?kind rdfs:subClassOf+ core:Predicate }"


@dataclass(frozen=True, slots=True)
class _Rule:
    iri: Term
    text: Literal
    order: float
    query: Construct
    prefixes: Mapping[str, str]

    def finding(self, code: str, message: str, hint: str, at: Token | tuple[int, int], near: str = "") -> Finding:
        """A fault at a token of the rule's text, or at (index, length)."""
        index, length = (at.start, at.end - at.start) if isinstance(at, Token) else at
        values: dict[str, Term | str] = {"name": at.text} if isinstance(at, Token) else {}
        if near:
            values["term"] = NamedNode(near)
        return Finding(
            code,
            "error",
            message,
            hint,
            self.iri,
            _CONSTRUCT,
            self.text,
            values=values,
            inside=(index, length),
            near="term" if near else "",
        )


def check_rules(model: Model) -> Iterator[Finding]:
    """The problems in the text of every rule."""
    rules = list(_rules(model))
    sound = []
    for rule in rules:
        faults = [*_prefix_faults(rule)] or [*_parse_faults(rule)]
        yield from faults
        if not faults:
            sound.append(rule)
    if not sound:
        return
    if len(sound) == len(rules):
        yield from check_agreement(model, {name.iri for rule in rules for name in rule.query.names})
    yield from check_order([(rule.iri, rule.order, rule.query) for rule in sound], read_hierarchy(model.store))
    yield from _undeclared(model, sound)
    yield from _conclusions(model, sound)
    yield from _restrictions(model, sound)
    yield from _unrouted(model, sound)
    yield from _never_concluded(model, rules)


def _rules(model: Model) -> Iterator[_Rule]:
    prefixes: dict[Term, dict[str, str]] = {}
    for row in model.rows(_PREFIXES):
        prefixes.setdefault(row["rule"], {})[_text(row["prefix"])] = _text(row["namespace"])
    for row in model.rows(_RULES):
        text = row["text"]
        if isinstance(text, Literal):
            own = prefixes.get(row["rule"], {})
            try:
                order = float(_text(row["order"])) if "order" in row else 0.0
            except ValueError:
                order = 0.0
            yield _Rule(row["rule"], text, order, read_construct(text.value, own), own)


def _text(term: Term) -> str:
    return term.value


def _prefix_faults(rule: _Rule) -> Iterator[Finding]:
    for token in rule.query.undeclared:
        prefix = token.text.partition(":")[0]
        yield rule.finding(
            "RUL002",
            f"`{{subject}}` uses the prefix `{prefix}:`, which its sh:prefixes does not declare",
            f'add `[ sh:prefix "{prefix}" ; sh:namespace "{PREFIXES.get(prefix, "...")}"^^xsd:anyURI ]` '
            "to the sh:declare of the ontology header",
            token,
        )


def _parse_faults(rule: _Rule) -> Iterator[Finding]:
    query = rule.text.value
    wrong = query_fault(query, rule.prefixes)
    if wrong is not None:
        message = wrong.message if wrong.code else f"the query of `{{subject}}` is no SPARQL: {wrong.message}"
        hint = wrong.hint or "a rule is one CONSTRUCT query; `onto explain RUL001` says more"
        yield rule.finding(wrong.code or "RUL001", message, hint, (wrong.start, wrong.length))
        return
    try:
        result = Store().query(query, prefixes=dict(rule.prefixes))
    except ValueError as error:  # Oxigraph's word for a query that parses and means nothing
        yield rule.finding(
            "RUL001", f"the query of `{{subject}}` is no SPARQL: {error}", "rewrite the query", _start(rule)
        )
        return
    if not isinstance(result, QueryTriples):
        yield rule.finding(
            "RUL012",
            "the query of `{subject}` constructs nothing",
            "write `CONSTRUCT { ... } WHERE { ... }`",
            _start(rule),
        )


def _start(rule: _Rule) -> tuple[int, int]:
    """The first token of a rule's text."""
    first = next(tokens(rule.text.value), None)
    return (first.start, first.end - first.start) if first else (0, 1)


def _undeclared(model: Model, rules: list[_Rule]) -> Iterator[Finding]:
    declared = {_text(row["term"]) for row in model.rows(_DECLARED)}
    namespaces = tuple(_text(row["namespace"]) for row in model.rows(_NAMESPACES))
    for rule in rules:
        seen = set()
        for name in rule.query.names:
            if name.iri.startswith(namespaces) and name.iri not in declared and name.iri not in seen:
                seen.add(name.iri)
                yield rule.finding(
                    "RUL005",
                    "`{subject}` names `{term}`, which nothing declares",
                    "declare the term",
                    name.token,
                    name.iri,
                )


def _conclusions(model: Model, rules: list[_Rule]) -> Iterator[Finding]:
    declared = {_text(row["term"]) for row in model.rows(_DECLARED)}
    failures = {_text(row["class"]) for row in model.rows(_FAILURES)}
    ranges: dict[str, tuple[Term, set[str]]] = {}
    for row in model.rows(_RANGES):
        ranges.setdefault(_text(row["property"]), (row["range"], set()))[1].add(_text(row["instance"]))
    for rule in rules:
        for step in rule.query.writes:
            if step.object not in declared:
                continue
            if step.predicate.iri == _FAILURE_CLASS and step.object not in failures:
                yield rule.finding(
                    "RUL006",
                    "`{subject}` concludes `{name}`, which is no failure class",
                    "conclude a subclass of core:PredicateFailure",
                    step.at_object,
                )
            elif step.predicate.iri in ranges and step.object not in ranges[step.predicate.iri][1]:
                kind = ranges[step.predicate.iri][0]
                yield rule.finding(
                    "RUL006",
                    f"`{{subject}}` concludes `{{name}}`, which is no instance of {_short(kind)}",
                    f"conclude an instance of {_short(kind)}, or change the property",
                    step.at_object,
                )


def _short(term: Term) -> str:
    return f"`{term.value.rpartition('#')[2] or term.value}`"


def _restrictions(model: Model, rules: list[_Rule]) -> Iterator[Finding]:
    continuous = {_text(row["property"]) for row in model.rows(_CONTINUOUS)}
    classes = {_text(row["class"]) for row in model.rows("SELECT ?class WHERE { ?class a owl:Class }")}
    for rule in rules:
        for step in rule.query.writes:
            if step.subject != "this":
                yield rule.finding(
                    "RUL013",
                    "`{subject}` concludes something of another node than its focus node",
                    "write `$this` as the subject of everything that the rule concludes",
                    step.predicate.token,
                )
        for step in rule.query.reads:
            if step.predicate.iri in continuous:
                yield rule.finding(
                    "RUL007",
                    "`{subject}` reads `{name}`, a number without a finite set of values",
                    "read core:status, which says what the number means for the required fact",
                    step.predicate.token,
                )
        later = [other for other in rules if other.order >= rule.order]
        written = {step.predicate.iri for other in later for step in other.query.writes}
        known = _class_valued(rules, classes)
        for step in rule.query.reads:
            if step.predicate.iri in written and not _is_class(step, rule.query, known):
                yield rule.finding(
                    "RUL008",
                    "`{subject}` reads `{name}`, which this rule or one behind it in sh:order concludes",
                    "give the rule a larger sh:order than those that conclude it, or read something else",
                    step.predicate.token,
                )


def _class_valued(rules: list[_Rule], classes: set[str]) -> set[str]:
    """The properties whose concluded values are all classes: what they point at is never a focus node."""
    values: dict[str, set[str]] = {}
    for rule in rules:
        for step in rule.query.writes:
            values.setdefault(step.predicate.iri, set()).add(step.object)
    return {iri for iri, found in values.items() if found <= classes}


def _is_class(step: Step, query: Construct, class_valued: set[str]) -> bool:
    return any(other.object == step.subject and other.predicate.iri in class_valued for other in query.reads)


def _unrouted(model: Model, rules: list[_Rule]) -> Iterator[Finding]:
    above = read_hierarchy(model.store)
    failures = {_text(row["class"]) for row in model.rows(_FAILURES)}
    routes = [(_text(row["failure"]), _text(row["kind"]), _text(row["residual"])) for row in model.rows(_ROUTES)]
    admitted = {failure for failure, _, _ in routes}
    routed = {(failure, kind) for failure, kind, residual in routes if residual == "false"}
    used = sorted(_text(row["kind"]) for row in model.rows(_USED_KINDS))
    for rule in rules:
        kinds = {name.iri: name for name in rule.query.names if name.iri in above and _PREDICATE in above[name.iri]}
        for step in rule.query.writes:
            if step.predicate.iri != _FAILURE_CLASS or step.object not in failures:
                continue
            if step.object not in admitted:
                yield _no_route(rule, step, None)
                continue
            for kind in kinds or used:  # a rule that names no kind concludes its failure of all
                if not any((step.object, wider) in routed for wider in above.get(kind, ())):
                    yield _no_route(rule, step, kind, kinds.get(kind))


def _never_concluded(model: Model, rules: list[_Rule]) -> Iterator[Finding]:
    concluded = {name.iri for rule in rules for name in rule.query.names}
    for row in model.rows(_LEAVES):
        if "priority" in row and row["class"].value not in concluded:
            yield Finding(
                "RTE009",
                "warning",
                "no rule concludes the failure class `{subject}`",
                "write a diagnosis rule that concludes it, or remove the class",
                row["class"],
            )


def _no_route(rule: _Rule, step: Step, kind: str | None, named: Name | None = None) -> Finding:
    found = rule.finding(
        "RTE006",
        f"no first route takes the failure `{step.at_object.text}`{' of a `{kind}`' if kind else ''} "
        "that `{subject}` concludes",
        "let a route that is no core:ResidualRoute admit the failure class (core:admits) and support the kind of "
        "predicate (core:supports)",
        named.token if named else step.at_object,
    )
    return replace(found, values={**found.values, "kind": NamedNode(kind)}) if kind else found
