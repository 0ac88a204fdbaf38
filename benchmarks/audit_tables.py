"""The tables of docs/audit.md: what is false at the start, every task by kind of failure, other versions of MuJoCo."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from statistics import median
from typing import Any

from benchmarks.audit import FALSE
from benchmarks.markdown import table

__all__ = ["audit_table", "suites_table", "versions_table"]

KINDS = {
    FALSE: "fact false",
    "goal_true": "goal true",
    "displaced": "displaced",
    "tipped": "tipped",
    "turned": "turned",
    "fell": "fell",
    "hinge_moved": "hinge",
    "slide_moved": "slide",
    "interpenetrating": "in each other",
    "overlapping_at_start": "overlap at start",
    "sunk_at_start": "sunk at start",
}
SUNK = "sunk_at_start"  # common and harmless: only counted
Task = tuple[str, int, str]
Row = dict[str, Any]


def audit_table(result: dict[str, Any]) -> str:
    """The false initial facts, then one line per task with the states that show each kind of failure."""
    m = result["metrics"]
    states = [row for row in result["rows"] if "crashed" not in row and row["state"] is not None]
    tasks: dict[Task, list[Row]] = defaultdict(list)
    for row in states:
        tasks[row["suite"], row["task"], row["name"]].append(row)
    false = []
    for (suite, index, _), rows in tasks.items():
        for subject, failures in sorted(_by_subject(rows, FALSE).items()):
            margins = [failure["margin"] for failure in failures if failure["margin"] is not None]
            margin = f"{median(margins) * 1000:+.0f} mm" if margins and failures[0]["unit"] == "m" else "—"
            limits = ", ".join(sorted({failure["limit"] for failure in failures}))
            false.append((f"`{suite}` {index}", f"`{subject}`", f"{len(failures)} of {len(rows)}", margin, limits))
    total = (
        f"{m['tasks']} tasks, {m['states']:,} initial states: in {m['premise_false_states']} states of "
        f"{m['premise_false_tasks']} tasks an initial fact is false; {m['sound_states']:,} states show no failure of "
        f"any kind; {m['faults']} facts, states or tasks could not be audited and {m['crashed']} trials crashed."
    )
    shown = [kind for kind in KINDS if m.get(f"{kind}.states")]
    kinds = []
    for (suite, index, name), rows in tasks.items():
        counts = (sum(any(f["kind"] == kind for f in row["failures"]) for row in rows) for kind in shown)
        kinds.append((f"`{suite}` {index}", name.replace("_", " "), *(str(n) if n else "" for n in counts)))
    kinds.append(("all", "", *(f"{m[f'{kind}.states']} in {m[f'{kind}.tasks']} tasks" for kind in shown)))
    parts = (
        table(("task", "initial fact that is false", "states", "median margin", "decided by"), false),
        total,
        "States of each task that show a failure, by kind; kinds that no state shows are left out:",
        table(("task", "", *(KINDS[kind] for kind in shown)), kinds),
    )
    return "\n\n".join(parts)


def suites_table(result: dict[str, Any]) -> str:
    """The suites whose task could not be audited, then those with a failure."""
    m = result["metrics"]
    rows = [row for row in result["rows"] if "crashed" not in row]
    faults = [(f"`{row['suite']}`", f"{fault['code']}: {fault['message']}") for row in rows for fault in row["faults"]]
    failures = []
    for row in rows:
        phrases = [f"{KINDS[f['kind']]} `{f['subject']}`" for f in row["failures"] if f["kind"] != SUNK]
        sunk = sum(f["kind"] == SUNK for f in row["failures"])
        phrases += [f"{sunk} {KINDS[SUNK]}"] if sunk else []
        failures += [(f"`{row['suite']}`", "; ".join(phrases))] if phrases else []
    total = (
        f"{m['audited_suites']} of {m['suites']} suites were audited. {m['official_suites']} ship initial states; for "
        f"the others a seeded reset stands. {m['crashed']} trials crashed."
    )
    parts = (
        table(("suite", "what could not be audited, in its first task"), faults),
        table(("suite", "failure in the first initial state of its first task"), failures),
        total,
    )
    return "\n\n".join(parts)


def versions_table(result: dict[str, Any]) -> str:
    """The initial facts whose truth depends on the version of MuJoCo: false states under each."""
    rows = [row for row in result["rows"] if "crashed" not in row and row["state"] is not None]
    versions = list(dict.fromkeys(row["mujoco"] for row in rows))
    counts: dict[tuple[Task, str], dict[str, set[int]]] = defaultdict(lambda: defaultdict(set))
    margins: dict[tuple[Task, str, str], list[float]] = defaultdict(list)
    for row in rows:
        task = (row["suite"], row["task"], row["name"])
        for failure in row["failures"]:
            if failure["kind"] == FALSE:
                counts[task, failure["subject"]][row["mujoco"]].add(row["state"])
                margins[task, failure["subject"], row["mujoco"]].append(failure["margin"] or 0.0)
    lines = []
    differing = [(key, found) for key, found in counts.items() if len({frozenset(found[v]) for v in versions}) > 1]
    for (task, subject), found in sorted(differing):
        cells = (
            f"{len(found[v])} ({median(margins[task, subject, v]) * 1000:+.0f} mm)" if found[v] else "0"
            for v in versions
        )
        lines.append((f"`{task[0]}` {task[1]}", f"`{subject}`", *cells))
    m = result["metrics"]
    each = "; ".join(f"{m[f'{v}.premise_false_states']} of {m[f'{v}.states']:,} under {v}" for v in versions)
    heads = ("task", "initial fact", *(f"false under {v}" for v in versions))
    return f"{table(heads, lines)}\n\nStates with a false initial fact: {each}."


def _by_subject(rows: Iterable[Row], kind: str) -> dict[str, list[dict[str, Any]]]:
    found: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for row in rows:
        for failure in row["failures"]:
            if failure["kind"] == kind:
                found[failure["subject"]].append(failure)
    return found
