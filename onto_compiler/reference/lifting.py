"""How task files are read: bindings per native predicate, joint thresholds, and the categories of assets."""

from __future__ import annotations

from collections.abc import Iterator

from onto_compiler.html import Html, code, element, joined, table
from onto_compiler.rdf import CORE
from onto_compiler.reference.model import Reference
from onto_compiler.reference.predicates import unit_name
from onto_compiler.reference.terms import named
from onto_compiler.schema import Binding, local_name

__all__ = ["bindings_section", "categories_section", "thresholds_section"]


def bindings_section(reference: Reference) -> Html:
    """One table per native predicate and domain, in the order in which bindings are tried."""
    groups: dict[tuple[str, str], list[Binding]] = {}
    for binding in reference.schema.bindings:
        groups.setdefault((binding.domain, binding.native), []).append(binding)
    parts = []
    for (domain, native), bindings in sorted(groups.items(), key=lambda item: (item[0][0], item[0][1].casefold())):
        where = f" of {domain}" if domain else ""
        caption = f"{native}{where}: the first binding that fits the arguments decides"
        columns = ("binding", "order", "arguments", "lifts to", "grounded by", "besides")
        rows = [
            (
                _name(reference, binding.iri),
                str(binding.order),
                reference.links(binding.arguments),
                reference.link(binding.lifts),
                code(binding.grounded_by) if binding.grounded_by else "",
                joined(_besides(binding)),
            )
            for binding in bindings
        ]
        parts.append(table(caption, columns, rows, {1}))
    return element("div", *parts, class_="stack")


def _besides(binding: Binding) -> Iterator[Html]:
    if binding.landmark is not None:
        yield element("p", "second argument named by ", code(binding.landmark.pattern))
    if binding.threshold:
        yield element("p", "second argument: the threshold of the category")
    if binding.premise_grounded_by:
        yield element("p", "as an initial fact grounded by ", code(binding.premise_grounded_by))
    if binding.premise_tolerance:
        yield element("p", f"initial margin down to -{binding.premise_tolerance:g}")
    if binding.goal_margin:
        yield element("p", f"margin in a goal from {binding.goal_margin:g}")


def thresholds_section(reference: Reference) -> Html:
    """When a joint counts as open, closed, on or off."""
    rows = []
    for threshold in sorted(reference.schema.thresholds.values(), key=lambda t: (t.category, t.native, t.iri)):
        sign = (">" if threshold.above else "<") + ("=" if threshold.inclusive else "")
        asked = "every joint" if threshold.every_joint else "any joint"
        words = (code(threshold.category), code(threshold.native), asked, f"{sign} {threshold.bound:g}")
        rows.append((_name(reference, threshold.iri), *words, unit_name(reference, threshold.unit)))
    return table("Joint positions that count", ("threshold", "category", "native", "of", "position", "unit"), rows, {4})


def categories_section(reference: Reference) -> Html:
    """Asset categories, their regions, and the classes of what the ontology does not name."""
    parts = []
    for name, title in (("Default", "defaults"), ("Category", "asset categories"), ("RegionCategory", "regions")):
        rows = [
            (
                named(reference, iri),
                joined(code(text) for text in reference.texts(iri, CORE + "category")),
                joined(code(text) for text in reference.texts(iri, CORE + "region")),
                reference.links(reference.iris(iri, CORE + "instanceClass")),
            )
            for iri in reference.of_type(CORE + name)
        ]
        inner = table(f"{len(rows)} {title}", ("term", "category", "region", "class"), rows)
        parts.append(element("details", element("summary", f"{len(rows)} {title}"), element("div", inner)))
    return joined(parts)


def _name(reference: Reference, iri: str) -> Html:
    return named(reference, iri) if iri in reference.anchors else code(local_name(iri))
