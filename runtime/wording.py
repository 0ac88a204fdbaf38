"""How a fact, a margin and its unit are written for a person, and how lines are wrapped."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator
from math import isnan

from onto_compiler.required import Fact
from onto_compiler.schema import Schema, local_name

__all__ = ["amount", "atom", "short_name", "unit_of", "wrapped"]


def short_name(iri: str, schema: Schema) -> str:
    """The notation of a term, or its local name."""
    return schema.notations.get(iri, local_name(iri))


def atom(fact: Fact, schema: Schema) -> str:
    """``on(akita_black_bowl_1, plate_1)``, with ``not`` before it where the fact must not hold."""
    text = f"{short_name(fact.predicate, schema)}({', '.join(argument.name for argument in fact.arguments)})"
    return text if fact.polarity else f"not {text}"


def unit_of(fact: Fact, schema: Schema) -> str:
    """The symbol of the unit of the fact's margin (its threshold's, where the predicate has none), or nothing."""
    signature = schema.predicates.get(fact.predicate)
    unit = signature.margin_unit if signature else None
    if unit is None:
        thresholds = (schema.threshold(argument.type) for argument in fact.arguments)
        unit = next((threshold.unit for threshold in thresholds if threshold is not None), None)
    return "" if unit is None else schema.symbol(unit)


def amount(margin: float, unit: str) -> str:
    """A margin with its sign and unit: small lengths in millimetres, everything to three significant digits."""
    if isnan(margin):
        return "no margin"
    if unit == "m":
        return f"{margin * 1000:+.3g} mm" if abs(margin) < 1 else f"{margin:+.3g} m"
    return f"{margin:+.3g} {unit}".rstrip()


def wrapped(lines: Iterable[str], width: int = 80) -> Iterator[str]:
    """``lines`` for a terminal of ``width`` columns; what continues a line is indented by two more than it."""
    for line in lines:
        indent = " " * (len(line) - len(line.lstrip()) + 2)
        yield from textwrap.wrap(
            line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
        ) or [""]
