"""The compiled ontology: the schema, and the rules as tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from onto_compiler.compile_schema import compile_schema
from onto_compiler.schema import Schema
from onto_compiler.sources import load_store
from onto_compiler.tables import RuleTables, compile_tables

__all__ = ["Knowledge", "load_knowledge"]


@dataclass(frozen=True, slots=True)
class Knowledge:
    """A schema and the tables of its rules."""

    schema: Schema
    tables: RuleTables

    @classmethod
    def load(cls, *extra: str | Path) -> Knowledge:
        """As :func:`load_knowledge`."""
        return load_knowledge(*extra)


@lru_cache(maxsize=4)
def load_knowledge(*extra: str | Path) -> Knowledge:
    """The shipped ontology, with the user's own Turtle on top.

    Raises:
        OntoError: as :func:`onto_compiler.sources.load_store`, ``compile_schema`` and ``compile_tables``.
    """
    store = load_store(extra)
    schema = compile_schema(store)
    return Knowledge(schema=schema, tables=compile_tables(store, schema))
