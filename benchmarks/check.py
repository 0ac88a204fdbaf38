"""What ``onto check`` and ``onto --help`` cost in a fresh process, and how precisely broken files are reported.

The broken files are those of the tests: each is broken in one way and says in its first line which code belongs where.
"""

from __future__ import annotations

import json
import re
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from benchmarks.program import onto
from benchmarks.protocol import Protocol, Row, Trial

__all__ = ["CHECK"]

BROKEN = Path(__file__).resolve().parent.parent / "tests" / "onto_compiler" / "check" / "broken"
RUNS = {True: 15, False: 3}
_EXPECT = re.compile(r"(\w+) (\d+):(\d+)")


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Timed runs of both commands, then one run per broken file."""
    timed = [
        {"key": f"{name}/{number}", "arguments": arguments}
        for name, arguments in (("check", ["check", "--json"]), ("help", ["--help"]))
        for number in range(RUNS[full])
    ]
    files = sorted(BROKEN.glob("*.ttl"))
    return [*timed, *({"key": f"broken/{file.name}", "file": file.name} for file in files)]


def run(trial: Trial) -> list[Row]:
    """A timed command, or what is said of a broken file."""
    common = {"mode": "none", "sees": "none"}
    if "arguments" in trial:
        started = time.perf_counter()
        done = onto(*trial["arguments"])
        wall = time.perf_counter() - started
        problems = len(json.loads(done.stdout)["problems"]) if trial["arguments"][0] == "check" else 0
        return [{**common, "wall_s": round(wall, 4), "exit": done.returncode, "problems": problems}]
    file = BROKEN / trial["file"]
    first = file.read_bytes().partition(b"\n")[0].decode()
    expected = sorted([code, int(line), int(column)] for code, line, column in _EXPECT.findall(first))
    done = onto("check", str(file), "--json", "--fail-on", "warning")
    found = sorted([p["code"], p["line"], p["column"]] for p in json.loads(done.stdout)["problems"])
    return [{**common, "expected": expected, "found": found, "exact": expected == found and done.returncode == 1}]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Medians and maxima of the timed runs, and how many broken files are reported exactly."""
    found: dict[str, float] = {"crashed": sum("crashed" in row for row in rows)}
    for name in ("check", "help"):
        walls = [row["wall_s"] for row in rows if row["key"].startswith(f"{name}/") and "wall_s" in row]
        found[f"{name}_runs"] = len(walls)
        found[f"{name}_median_s"], found[f"{name}_max_s"] = median(walls), max(walls)
    checked = [row for row in rows if row["key"].startswith("check/")]
    broken = [row for row in rows if row["key"].startswith("broken/")]
    found["shipped_problems"] = max(row.get("problems", 0) for row in checked)
    found["broken_files"] = len(broken)
    found["broken_exact"] = sum(bool(row.get("exact")) for row in broken)
    return found


CHECK = Protocol(
    name="check",
    help="seconds of `onto check` and `onto --help`, and the precision of what is said of broken files",
    seeds=(),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"wall_s"}),
)
