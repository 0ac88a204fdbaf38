"""The checks that are one SPARQL query each: ``ontology/queries/checks/*.rq``.

A query's header says its code, its severity, the problem and the solution; it selects ``?subject`` and, where they
narrow the place, ``?predicate``, ``?object`` and ``?graph``. A new check is a new file, a page and an example.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from pyoxigraph import NamedNode

import ontology
from onto_compiler.check.finding import Finding
from onto_compiler.check.model import Model

__all__ = ["QueryCheck", "query_checks", "read_check", "run_query"]

_HEADER = re.compile(r"(?m)^# (\w+): (.*(?:\n#   .*)*)")


@dataclass(frozen=True, slots=True)
class QueryCheck:
    """One query and its header; ``near`` names the variable that a declared name may be meant for."""

    code: str
    severity: str
    problem: str
    solution: str
    query: str
    near: str = ""
    general: bool = False


@lru_cache(maxsize=1)
def query_checks() -> tuple[QueryCheck, ...]:
    """Every shipped check, in the order of its file's name."""
    return tuple(read_check(path) for path in ontology.query_files("checks"))


def read_check(path: Path) -> QueryCheck:
    """Read one query with its header.

    Raises:
        ValueError: the header lacks ``code``, ``severity``, ``Problem`` or ``Solution``.

    """
    text = path.read_text(encoding="utf-8")
    header = {name: re.sub(r"\n#   ", " ", value) for name, value in _HEADER.findall(text)}
    missing = {"code", "severity", "Problem", "Solution"} - header.keys()
    if missing:
        raise ValueError(f"{path.name}: the header lacks {', '.join(sorted(missing))}")
    return QueryCheck(
        code=header["code"],
        severity=header["severity"],
        problem=header["Problem"],
        solution=header["Solution"],
        query=text,
        near=header.get("near", ""),
        general=header.get("general") == "yes",
    )


def run_query(model: Model, check: QueryCheck) -> Iterator[Finding]:
    """What one check finds in all files, background included."""
    for row in model.rows(check.query):
        graph = row.get("graph")
        yield Finding(
            code=check.code,
            severity=check.severity,
            message=check.problem,
            hint=check.solution,
            subject=row["subject"],
            predicate=row.get("predicate"),
            object=row.get("object"),
            graph=graph if isinstance(graph, NamedNode) else None,
            values=row,
            near=check.near,
            general=check.general,
        )
