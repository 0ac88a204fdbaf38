"""The shipped ontology: Turtle files, and where to find them."""

from __future__ import annotations

from pathlib import Path

__all__ = ["ROOT", "query_files", "turtle_files"]

ROOT = Path(__file__).resolve().parent


def turtle_files() -> tuple[Path, ...]:
    """Every shipped Turtle file, in a fixed order."""
    return tuple(sorted(ROOT.rglob("*.ttl")))


def query_files(group: str) -> tuple[Path, ...]:
    """The SPARQL queries of one folder below ``queries``, e.g. ``competency``."""
    return tuple(sorted((ROOT / "queries" / group).glob("*.rq")))
