"""Predicates with their signatures: what they relate, how they are grounded, how they fail and where that is sent."""

from __future__ import annotations

from collections.abc import Iterator

from onto_compiler.html import Html, code, element, joined
from onto_compiler.rdf import RDFS
from onto_compiler.reference.model import Reference
from onto_compiler.reference.terms import about, named
from onto_compiler.schema import PredicateSignature
from onto_compiler.tables import FIRST

__all__ = ["predicates_section", "unit_name"]

_UNIT_SYMBOL = "http://qudt.org/schema/qudt/symbol"


def predicates_section(reference: Reference) -> Html:
    """Every predicate below its kind."""
    signatures = sorted(reference.schema.predicates.values(), key=lambda p: (p.kind, p.name.casefold(), p.iri))
    parts: list[Html] = []
    for kind in dict.fromkeys(signature.kind for signature in signatures):
        parts += [element("h3", reference.label(kind), " ", reference.link(kind))]
        parts += [element("p", reference.definition(kind), class_="quiet")]
        cards = [_card(reference, signature) for signature in signatures if signature.kind == kind]
        parts.append(element("div", *cards, class_="cards"))
    return joined(parts)


def unit_name(reference: Reference, unit: str | None) -> str:
    """A unit in words with its symbol."""
    if unit is None:
        return "none"
    symbol = next(iter(reference.texts(unit, _UNIT_SYMBOL)), "")
    label = reference.label(unit)
    return f"{label} ({symbol})" if symbol else label


def _card(reference: Reference, signature: PredicateSignature) -> Html:
    arguments = reference.links(signature.parameters)
    name = named(reference, signature.iri) if signature.iri in reference.anchors else code(signature.name)
    facts = [element("div", element("dt", term), element("dd", value)) for term, value in _facts(reference, signature)]
    return element(
        "article",
        element("h4", name, "(", arguments, ")", class_="signature"),
        element("div", about(reference, signature.iri), class_="said"),
        element("dl", *facts),
    )


def _facts(reference: Reference, signature: PredicateSignature) -> Iterator[tuple[str, object]]:
    schema, tables = reference.schema, reference.tables
    yield "in records", code(signature.name)
    bindings = [binding for binding in schema.bindings if binding.lifts == signature.iri]
    own = {signature.grounded_by} if signature.grounded_by else set()
    functions = sorted(own | {binding.grounded_by for binding in bindings if binding.grounded_by})
    yield "grounded by", joined(_commas([code(name) for name in functions])) or "no function yet"
    units = {signature.margin_unit} if signature.margin_unit else _threshold_units(reference, signature)
    yield "margin", ", ".join(unit_name(reference, unit) for unit in sorted(units)) or "no continuous margin"
    if signature.tolerance is not None:
        yield "tolerance", f"{signature.tolerance:g}"
    if bindings:
        yield "lifted by", reference.links(binding.iri for binding in bindings)
    failures = {entry.failure for (predicate, _, _), entry in tables.diagnosis.items() if predicate == signature.iri}
    yield "can fail as", reference.links(sorted(failures)) or "nothing that a rule names"
    routes = {
        entry.route
        for (predicate, _, status, _, _), entry in tables.routing.items()
        if predicate == signature.iri and status == FIRST
    }
    yield "first sent to", reference.links(sorted(routes)) or "no route"
    defined = reference.iris(signature.iri, RDFS + "isDefinedBy")
    if defined:
        yield "defined by", reference.links(defined)


def _threshold_units(reference: Reference, signature: PredicateSignature) -> set[str]:
    """The units of the thresholds that stand in the predicate's second place."""
    bound = {b.native for b in reference.schema.bindings if b.lifts == signature.iri and b.threshold}
    return {threshold.unit for threshold in reference.schema.thresholds.values() if threshold.native in bound}


def _commas(parts: list[Html]) -> list[object]:
    return [piece for number, part in enumerate(parts) for piece in ((", ", part) if number else (part,))]
