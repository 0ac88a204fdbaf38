"""Which records there are: what the packages of a program describe, found by the entry points ``onto_evwm.records``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.metadata import entry_points

from onto_compiler.record.rows import Row
from onto_compiler.record.table import Record

__all__ = ["Described", "described"]

GROUP = "onto_evwm.records"


@dataclass(frozen=True, slots=True)
class Described:
    """``records`` stand in RDF, ``rows`` in the JSON of commands by name, of which ``documents`` are printed whole."""

    records: tuple[Record, ...] = ()
    rows: Mapping[str, Row] = field(default_factory=dict)
    documents: tuple[str, ...] = ()


@lru_cache(maxsize=1)
def described() -> Described:
    """Everything that is described, in the order of the entry points' names."""
    found = [entry.load() for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)]
    return Described(
        tuple(record for each in found for record in each.records),
        {name: row for each in found for name, row in each.rows.items()},
        tuple(name for each in found for name in each.documents),
    )
