"""Failures, routes and the rules that lead from one to the other, in words and as what they conclude."""

from __future__ import annotations

from collections.abc import Iterator

from onto_compiler.html import Html, code, element, joined, table
from onto_compiler.rdf import CORE, SH
from onto_compiler.reference.diagram import route_diagram
from onto_compiler.reference.model import Reference
from onto_compiler.reference.terms import about, named
from onto_compiler.schema import local_name
from onto_compiler.tables import EXHAUSTED, FIRST, LEVELS, REPEAT, SATISFIED, STATUSES

__all__ = ["routes_section", "rules_section"]

_UNSATISFIED = tuple(status for status in STATUSES if status != SATISFIED)


def routes_section(reference: Reference) -> Html:
    """The diagram, then the same as two tables."""
    schema = reference.schema
    produced = {entry.failure for entry in reference.tables.diagnosis.values()}
    failures = [
        (
            reference.link(iri),
            str(priority),
            reference.definition(iri),
            reference.links(sorted(name for name, route in schema.routes.items() if iri in route.admits)) or "no route",
        )
        for iri, priority in sorted(schema.failures.items(), key=lambda item: (item[1], local_name(item[0])))
        if iri in produced
    ]
    routes = [
        (
            named(reference, iri) if iri in reference.anchors else code(route.name),
            code(route.level),
            reference.links(sorted(route.admits)),
            reference.links(sorted(route.supports)),
            reference.link(route.on_rejection) if route.on_rejection else "the same route again",
            about(reference, iri),
        )
        for iri, route in sorted(schema.routes.items())
    ]
    columns = ("route", "level", "admits", "supports", "on rejection", "meaning")
    caption = "Failures that a rule names, the most urgent first"
    return joined(
        [
            route_diagram(reference),
            element("h3", "Failures"),
            table(caption, ("failure", "priority", "meaning", "admitted by"), failures, {1}),
            element("h3", "Routes"),
            table("Routes: dispatch labels, not robot actions", columns, routes),
        ]
    )


def rules_section(reference: Reference) -> Html:
    """Every rule in the order in which it runs, and the tables that all of them together come to."""
    # A rule that fires for two target classes is listed once.
    rules = {rule.iri: rule for rule in reference.rules}
    entries = []
    for iri, rule in rules.items():
        title = named(reference, iri) if iri in reference.anchors else code(local_name(iri))
        targets = sorted({other.target for other in reference.rules if other.iri == iri})
        place = ["order ", element("b", f"{rule.order:g}"), ", fires for each ", reference.links(targets)]
        query = "".join(reference.texts(iri, SH + "construct")).strip()
        entries.append(
            element(
                "li",
                element("h4", reference.label(iri), " ", title),
                element("div", about(reference, iri), class_="said"),
                element("p", *place, class_="quiet"),
                element("details", element("summary", "The query"), element("div", element("pre", query))),
            )
        )
    diagnosis = ("kind", "must", *(reference.label(status) for status in _UNSATISFIED))
    routing = ("kind", "failure", "level", "at first", "after a rejection", "when exhausted")
    return joined(
        [
            element("h3", "The rules in words"),
            element("ol", *entries, class_="rules"),
            element("h3", "What the diagnosis rules conclude"),
            element("p", "A satisfied fact has no failure.", class_="quiet"),
            table("Failure by kind of predicate, polarity and status", diagnosis, _diagnoses(reference)),
            element("h3", "What the routing rules conclude"),
            element(
                "p",
                "After a rejection, “route → next” reads: where that route was rejected, the next one is asked.",
                class_="quiet",
            ),
            table(
                "Route by kind of predicate, failure, level of the run, and how the last attempt ended",
                routing,
                _routings(reference),
            ),
        ]
    )


def _kinds(reference: Reference) -> dict[str, list[str]]:
    kinds: dict[str, list[str]] = {}
    for iri, signature in sorted(reference.schema.predicates.items(), key=lambda item: (item[1].kind, item[0])):
        kinds.setdefault(signature.kind, []).append(iri)
    return kinds


def _diagnoses(reference: Reference) -> Iterator[tuple[object, ...]]:
    for kind, predicates in _kinds(reference).items():
        for polarity in (True, False):
            cells = []
            for status in _UNSATISFIED:
                entries = (reference.tables.diagnosis.get((one, polarity, status)) for one in predicates)
                found = dict.fromkeys((e.failure, e.rule) for e in entries if e is not None)
                cells.append(joined(_concluded(reference, failure, rule) for failure, rule in found) or "—")
            yield (reference.link(kind), "hold" if polarity else "not hold", *cells)


def _concluded(reference: Reference, conclusion: str, rule: str) -> Html:
    return element("p", reference.link(conclusion), element("span", " by ", reference.link(rule), class_="quiet"))


def _routings(reference: Reference) -> Iterator[tuple[object, ...]]:
    routing = reference.tables.routing
    for kind, predicates in _kinds(reference).items():
        asked = _reached(reference, predicates)
        for failure in sorted({key[1] for key in routing if key[0] in predicates}):
            for level in LEVELS:
                cells = []
                for status in (FIRST, REPEAT, EXHAUSTED):
                    found = {
                        (previous, entry.route, entry.decision)
                        for (one, *case, previous, at), entry in routing.items()
                        if one in predicates and case == [failure, status] and previous in asked and at == level
                    }
                    steps = sorted(found, key=lambda step: tuple(map(str, step)))
                    cells.append(joined(_step(reference, *step) for step in steps))
                if any(cells):
                    yield (reference.link(kind), reference.link(failure), level, *(cell or "—" for cell in cells))


def _reached(reference: Reference, predicates: list[str]) -> set[str | None]:
    """The routes that a failure of one of ``predicates`` can have been sent to before, and none for the first time."""
    steps = [(key[3], entry.route) for key, entry in reference.tables.routing.items() if key[0] in predicates]
    reached: set[str | None] = {None}
    while more := {route for previous, route in steps if previous in reached} - reached:
        reached |= more
    return reached


def _step(reference: Reference, previous: str | None, route: str, decision: str) -> Html:
    before = joined([reference.link(previous), " → "]) if previous else ""
    word = "" if decision == CORE + "Dispatch" else element("span", f" ({reference.label(decision)})", class_="quiet")
    return element("p", before, reference.link(route), word)
