"""The tables of docs/skills.md: suites by way of playing, tasks with their steps, failures with their typed records."""

from __future__ import annotations

import math
import statistics
from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Any

from benchmarks.markdown import rate, table
from benchmarks.skills import FIRST_TRY, PLAYS, SUITES, succeeded
from runtime.wording import amount

__all__ = ["skills_table"]

Row = dict[str, Any]
SHOWN = {FIRST_TRY: "first try", "reactive": "reactive", "lookahead": "look-ahead"}
OUTCOMES = {
    "unmet": "goal false at the end",
    "unsettled": "false 20 steps later",
    "held": "not let go",
    "diverged": "the state diverged",
}


def skills_table(result: dict[str, Any]) -> str:
    """One line per suite; one per task; one per episode that failed."""
    rows, m = result["rows"], result["metrics"]
    suites = [suite for suite in SUITES if any(row["suite"] == suite for row in rows)]
    total = (
        f"{m['trials']:,} episodes of {m['tasks']} tasks, {m['states_per_task']} initial states of each; "
        f"{m['crashed']} crashed. {m['replayed_same']:,} replays end where the exact simulation did, to the last bit, "
        f"and in {m['disagreements']} the goal as grounded and the native predicate disagree at the end. "
        f"The premise (the declared `:init`, after settling) was false in {m['premise_false']} of the initial states, "
        f"and the goal already true in {m['initially_true']}."
    )
    return "\n\n".join((_by_suite(suites, m), total, _by_task(rows), _failures(rows)))


def _by_suite(suites: Sequence[str], m: dict[str, float]) -> str:
    lines = []
    for suite in suites:
        for play, shown in SHOWN.items():
            name = f"{play}_{suite}"
            if name in m:
                steps = f"{m[f'{name}.steps']:.0f}" if f"{name}.steps" in m else "—"
                lines.append((f"`{suite}`", shown, str(m[f"{name}.n"]), rate(m, name), steps))
    return table(("suite", "", "episodes", "success [95 %]", "median steps"), lines)


def _by_task(rows: Sequence[Row]) -> str:
    """Successes of each way, and the steps of the successful episodes: median and largest."""
    tasks: dict[tuple[str, int], list[Row]] = defaultdict(list)
    for row in rows:
        tasks[row["suite"], row["task"]].append(row)
    heads = ("task", "", *SHOWN.values(), "steps, reactive", "steps, look-ahead", "rehearsed")
    lines = []
    for (suite, index), some in tasks.items():
        name = next((row["name"] for row in some if "name" in row), "").replace("_", " ")
        counts, steps, rehearsed = [], [], "—"
        for play in SHOWN:
            of_play = [row for row in some if row["play"] == ("reactive" if play == FIRST_TRY else play)]
            done = [row for row in of_play if succeeded(row, play)]
            counts.append(f"{len(done)}/{len(of_play)}" if of_play else "—")
            if play in PLAYS:
                used = [row["steps"] for row in done]
                steps.append(f"{statistics.median(used):.0f}, {max(used)}" if used else "—")
            if play == "lookahead" and (whole := [row["rehearsed"] for row in of_play if "crashed" not in row]):
                rehearsed = f"{statistics.median(whole):.0f}"
        lines.append((f"`{suite}` {index}", name, *counts, *steps, rehearsed))
    note = "Steps are control steps of successful episodes, median and largest; *rehearsed* those in forks, median."
    return f"{table(heads, lines)}\n\n{note}"


def _failures(rows: Sequence[Row]) -> str:
    failed = [row for row in rows if not row.get("success")]
    if not failed:
        return "No episode failed."
    lines = []
    for row in failed:
        what = "crashed" if "crashed" in row else OUTCOMES[row["outcome"]]
        if not row.get("premise_holds", True):
            what += ", premise false"
        record = "; ".join(map(_typed, row.get("failures", ()))) or row.get("crashed", "").replace("|", "\\|") or "—"
        tries = ", ".join(f"{each['outcome']} ({each['steps']})" for each in row.get("tries", ())) or "none"
        lines.append((f"`{row['suite']}` {row['task']}", str(row["state"]), SHOWN[row["play"]], what, record, tries))
    kinds = Counter(
        (each["failure"], each["fact"].partition("(")[0]) for row in failed for each in row.get("failures", ())
    )
    sums = ", ".join(f"{count} `{failure}` of `{predicate}`" for (failure, predicate), count in kinds.most_common())
    note = f"{len(failed)} of {len(rows):,} episodes failed" + (f"; unmet facts by kind: {sums}." if sums else ".")
    return f"{note}\n\n{table(('task', 'state', '', 'what failed', 'typed record', 'tries'), lines)}"


def _typed(failure: Row) -> str:
    margin = math.nan if failure["margin"] is None else failure["margin"]
    limit = f" ({failure['limit']})" if failure["limit"] else ""
    return f"`{failure['failure']}` `{failure['fact']}` {amount(margin, failure['unit'])}{limit}"
