"""The short words that records write in the place of IRIs, and the IRIs that they stand for."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from onto_compiler.emit.tbox import TBox
from onto_compiler.rdf import CORE, PREFIXES, TRACE
from onto_compiler.schema import local_name

__all__ = ["KINDS", "words"]

_QUDT = PREFIXES["qudt"]
_ENTITY, _THRESHOLD = CORE + "Entity", CORE + "Threshold"


def words(tbox: TBox, kind: str) -> dict[str, str]:
    """For one of :data:`KINDS` each word with its IRI, in alphabetical order; the first IRI keeps a word."""
    found: dict[str, str] = {}
    for iri, word in KINDS[kind](tbox):
        found.setdefault(word, iri)
    return dict(sorted(found.items()))


def _members(cls: str, word: Callable[[TBox, str], str]) -> Callable[[TBox], list[tuple[str, str]]]:
    return lambda tbox: [(iri, word(tbox, iri)) for iri in tbox.individuals(cls)]


def _entities(tbox: TBox) -> list[tuple[str, str]]:
    return [(iri, local_name(iri)) for iri in (*tbox.below(_ENTITY), *tbox.individuals(_THRESHOLD))]


def _failures(tbox: TBox) -> list[tuple[str, str]]:
    return [(iri, tbox.name(iri)) for iri in sorted(tbox.schema.failures)]


KINDS: Mapping[str, Callable[[TBox], list[tuple[str, str]]]] = {
    "decision": _members(CORE + "Decision", lambda tbox, iri: tbox.name(iri).lower()),
    "end": _members(TRACE + "ExecutionEnd", TBox.name),
    "entity": _entities,
    "failure": _failures,
    "level": _members(CORE + "Level", TBox.name),
    "mode": _members(TRACE + "Mode", TBox.name),
    "outcome": _members(TRACE + "Outcome", TBox.name),
    "predicate": lambda tbox: [(iri, tbox.name(iri)) for iri in sorted(tbox.schema.predicates)],
    "predicate_local": lambda tbox: [(iri, local_name(iri)) for iri in sorted(tbox.schema.predicates)],
    "route": lambda tbox: [(iri, tbox.name(iri)) for iri in sorted(tbox.schema.routes)],
    "source": _members(CORE + "Source", TBox.name),
    "status": _members(CORE + "Status", TBox.label),
    "unit": _members(_QUDT + "Unit", lambda tbox, iri: tbox.schema.symbol(iri)),
}
