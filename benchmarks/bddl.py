"""Every published task file of LIBERO, LIBERO-Plus, LIBERO-PRO and BEHAVIOR: read, printed and read back, and lifted.

What does not lift says why: for each predicate that nothing binds there is a count. A goal is *written out* where its
quantifiers come to an end and its alternatives stay below the bound, whether or not its predicates are bound.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.bddl_corpora import BEHAVIOR, FILES, corpus
from benchmarks.protocol import Protocol, Row, Trial

__all__ = ["BDDL", "CORPORA"]

CORPORA = tuple(FILES)
_UNBOUND = frozenset({"BDDL003", "BDDL020"})
_SAMPLED = 40


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """One trial per folder of a corpus; of BEHAVIOR, which has a folder for each activity, per first letter."""
    keys: dict[str, Trial] = {}
    for name in CORPORA:
        root, files = corpus(name)
        for file in files:
            part = _part(name, root, file)
            keys.setdefault(f"{name}/{part}", {"key": f"{name}/{part}", "corpus": name, "part": part, "full": full})
    return list(keys.values())


def _part(name: str, root: Path, file: Path) -> str:
    top = file.relative_to(root).parts[0]
    return top[0].lower() if name == BEHAVIOR else top


def run(trial: Trial) -> list[Row]:
    """One row per file of the folder; a small run takes every fortieth."""
    from onto_compiler.compile_schema import load_schema  # noqa: PLC0415 - heavy imports wait for the worker

    name = trial["corpus"]
    root, files = corpus(name)
    chosen = [file for file in files if _part(name, root, file) == trial["part"]]
    schema = load_schema()
    return [
        {"mode": "none", "sees": "task-file", "file": str(file.relative_to(root)), **_file(file, schema)}
        for file in (chosen if trial["full"] else chosen[::_SAMPLED])
    ]


def _file(file: Path, schema: Any) -> Row:  # noqa: ANN401 - a Schema, whose module is imported late
    from onto_compiler.bddl import format_task, lift, parse, parse_file  # noqa: PLC0415 - as above
    from onto_compiler.bddl.literals import goal_of  # noqa: PLC0415
    from onto_compiler.bddl.parse import parse_domain  # noqa: PLC0415
    from onto_compiler.problems import OntoError  # noqa: PLC0415

    if file.name.startswith("domain_"):
        try:
            domain = parse_domain(file)
        except OntoError as error:
            return {"kind": "domain", "parsed": False, "errors": _codes(error.problems, "error")}
        return {"kind": "domain", "parsed": True, "predicates": len(domain.predicates)}
    try:
        spec = parse_file(file)
    except OntoError as error:
        return {"kind": "task", "parsed": False, "errors": _codes(error.problems, "error")}
    goal, problems = goal_of(spec)
    row: Row = {
        "kind": "task",
        "parsed": True,
        "round_trip": parse(format_task(spec)) == spec,
        "written_out": not problems,
        "alternatives": len(goal.alternatives),
        "lifted": True,
    }
    try:
        found = lift(spec, schema, file.stem)[1]
    except OntoError as error:
        found = error.problems
        named = (re.search("`([^`]+)`", p.message) for p in found if p.code in _UNBOUND and p.severity == "error")
        row |= {
            "lifted": False,
            "errors": _codes(found, "error"),
            "unbound": sorted({match.group(1) for match in named if match is not None}),
        }
    return {**row, "warnings": [code for code in _codes(found, "warning") if code not in _UNBOUND]}


def _codes(problems: Iterable[Any], severity: str) -> list[str]:
    return sorted({problem.code for problem in problems if problem.severity == severity})


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Counts by corpus; ``unbound.NAME`` counts the activities whose goal uses a predicate that nothing binds."""
    whole = [row for row in rows if "crashed" not in row]
    found: dict[str, float] = {}
    for name in CORPORA:
        mine = [row for row in whole if row["corpus"] == name]
        tasks = [row for row in mine if row["kind"] == "task"]
        found |= {
            f"{name}_files": len(mine),
            f"{name}_tasks": len(tasks),
            f"{name}_parsed": sum(row["parsed"] for row in mine),
            f"{name}_failed": sum(not row["parsed"] for row in mine),
            f"{name}_round_trip_failed": sum(not row.get("round_trip", False) for row in tasks),
            f"{name}_written_out": sum(row.get("written_out", False) for row in tasks),
            f"{name}_with_alternatives": sum(row.get("alternatives", 0) > 0 for row in tasks),
            f"{name}_lifted": sum(row.get("lifted", False) for row in tasks),
        }
        for code, count in sorted(Counter(code for row in tasks for code in row.get("warnings", ())).items()):
            found[f"{name}.{code}"] = count
    unbound = Counter(predicate for row in whole for predicate in row.get("unbound", ()))
    found |= {f"unbound.{predicate}": count for predicate, count in sorted(unbound.items())}
    return {**found, "crashed": len(rows) - len(whole)}


BDDL = Protocol(
    name="bddl",
    help="every published BDDL file of LIBERO, LIBERO-Plus, LIBERO-PRO and BEHAVIOR: read, printed, lifted",
    seeds=(),
    trials=trials,
    run=run,
    metrics=metrics,
)
