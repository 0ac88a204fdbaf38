"""Tables in README.md and pages of docs/, made from ``results/*.json``; with ``--check`` they are only compared.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``; NAME is a key of :data:`TABLES`.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks import compiler_tables, runtime_tables
from benchmarks.audit_tables import audit_table, suites_table, versions_table
from benchmarks.house_table import house_table
from benchmarks.markdown import origin
from benchmarks.pointmaze_tables import pointmaze_table
from benchmarks.replay_table import replayed_table
from benchmarks.results import RESULTS, read_result
from benchmarks.skills_tables import skills_table
from benchmarks.wild_tables import corpora_table, wild_table
from benchmarks.world_model_tables import world_model_libero_table

__all__ = ["TABLES", "fill", "main"]

ROOT = Path(__file__).resolve().parent.parent
_DOCS = ("audit", "demos", "pointmaze", "results", "skills", "world_models")
PAGES = ("README.md", *(f"docs/{name}.md" for name in _DOCS))
_BLOCK = re.compile(r"(<!-- table: (?P<name>[\w.-]+) -->\n).*?(<!-- end -->)", re.DOTALL)

TABLES: dict[str, Callable[[dict[str, Any]], str]] = {
    "audit": audit_table,
    "audit_versions": versions_table,
    "audit_suites": suites_table,
    "bddl": compiler_tables.bddl_table,
    "check": compiler_tables.check_table,
    "compiler": compiler_tables.compiler_table,
    "conformance": compiler_tables.conformance_table,
    "corpora": corpora_table,
    "demo": runtime_tables.demo_table,
    "demos": runtime_tables.demos_table,
    "fuzz": compiler_tables.fuzz_table,
    "grounding": runtime_tables.grounding_table,
    "house": house_table,
    "lsp": compiler_tables.lsp_table,
    "pointmaze": pointmaze_table,
    "replayed": replayed_table,
    "robosuite": runtime_tables.robosuite_table,
    "simulator": runtime_tables.simulator_table,
    "skills": skills_table,
    "state_repair": runtime_tables.state_repair_table,
    "validator": compiler_tables.validator_table,
    "wild": wild_table,
    "world_model_libero": world_model_libero_table,
}
"""What makes each table and its notes of a result; the line that says where the result comes from is put below."""


def fill(text: str) -> str:
    """``text`` with every table that has a result made again."""

    def block(match: re.Match[str]) -> str:
        path = RESULTS / f"{match['name']}.json"
        body = "Not measured yet."
        if path.exists():
            result = read_result(path)
            body = f"{TABLES[match['name']](result)}\n\n{origin(result)}"
        return f"{match[1]}{body}\n{match[3]}"

    return _BLOCK.sub(block, text)


def main(arguments: Sequence[str]) -> int:
    """Rewrite the pages, or with ``--check`` say which are stale."""
    stale = []
    for name in PAGES:
        path = ROOT / name
        before = path.read_text(encoding="utf-8")
        after = fill(before)
        if after != before:
            stale.append(name)
            if "--check" not in arguments:
                path.write_text(after, encoding="utf-8")
    if "--check" in arguments and stale:
        sys.stderr.write(f"stale: {', '.join(stale)}; run `make docs`\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
