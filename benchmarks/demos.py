"""Demonstrations: collected from the skills under disturbances, and every one executed again in LIBERO's environment.

What is replayed is what is in the files. They are kept below ``out/bench`` under a hash of the sources that decide
them, so that a run resumes, and never speaks of files that other sources made.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path
from statistics import median

from benchmarks.protocol import Protocol, Row, Trial
from runtime.worlds.libero.demos.collect import CollectionRequest, collect_task, count_for
from runtime.worlds.libero.demos.command import SUITES
from runtime.worlds.libero.demos.read import load
from runtime.worlds.libero.demos.replay import replay
from runtime.worlds.libero.simulator.assets import find_task, tasks

__all__ = ["DEMOS"]

SEED = 0
SMALL = 1  # demonstrations of the first task of each suite
FOLDER = Path("out/bench")
_PROJECT = Path(__file__).resolve().parent.parent
_SOURCES = ("grounding", "onto_compiler", "ontology", "runtime")


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each task, with as many demonstrations as ``onto demos collect --all`` makes; small: one of a task a suite."""
    return [
        {
            "key": f"{suite}/{ref.index}",
            "suite": suite,
            "task": ref.index,
            "wanted": count_for(suite) if full else SMALL,
        }
        for suite in SUITES
        for ref in (tasks(suite) if full else tasks(suite)[-2:-1])
    ]


def run(trial: Trial) -> list[Row]:
    """One row for each demonstration; one without a demonstration where a task has none."""
    ref, wanted = find_task(trial["suite"], trial["task"]), trial["wanted"]
    found = collect_task(CollectionRequest(ref, wanted, SEED, FOLDER / f"demos.{_sources()[:12]}"), wait=True)
    seen = {"name": ref.name, "mode": "controller", "sees": "privileged-state", "trials": found.trials}
    seen["rejected"] = dict(found.rejected)
    if not found.demos:
        return [{**seen, "demo": None}]
    origins = [demo.origin for demo in load(found.path).demos]
    rows = []
    for origin, one in list(zip(origins, replay(found.path), strict=True))[:wanted]:
        fields = {name: value for name, value in asdict(one).items() if name not in {"file", "suite", "task"}}
        made = origin and {
            "state": origin.state_index,
            "severity": origin.severity,
            "disturbed": sorted({event["kind"] for event in origin.disturbances}),
            "failed_tries": sum(each["outcome"] != "held" for each in origin.tries),
        }
        rows.append({**seen, **fields, "same": one.same, **(made or {})})
    return rows


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """How many demonstrations there are, and which share of them succeeds natively at its recorded step, for good."""
    whole = [row for row in rows if "crashed" not in row]
    demos = [row for row in whole if row["demo"] is not None]
    by_task = {(row["suite"], row["task"]): row for row in whole}
    found: dict[str, float] = {
        "demos": len(demos),
        "wanted": sum(row["wanted"] for row in by_task.values()),
        "replayed_share": _share(demos),
        "drift": max((row["drift"] for row in demos), default=0.0),
        "trials": sum(row["trials"] for row in by_task.values()),
        "recovered": sum(row["failed_tries"] > 0 for row in demos),
        "tasks": len(by_task),
        "crashed": len(rows) - len(whole),
    }
    for suite in dict.fromkeys(row["suite"] for row in rows):
        own = [row for row in demos if row["suite"] == suite]
        found[f"{suite}.demos"], found[f"{suite}.replayed_share"] = len(own), _share(own)
        found[f"{suite}.median_steps"] = median(row["steps"] for row in own) if own else 0.0
        found[f"{suite}.trials"] = sum(row["trials"] for (name, _), row in by_task.items() if name == suite)
    return found


def _share(rows: Sequence[Row]) -> float:
    return sum(row["same"] for row in rows) / len(rows) if rows else 0.0


@cache
def _sources() -> str:
    total = hashlib.sha256()
    for path in sorted(path for part in _SOURCES for path in (_PROJECT / part).rglob("*")):
        if path.suffix in {".py", ".ttl", ".lark"}:
            total.update(hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


DEMOS = Protocol(
    name="demos",
    help="demonstrations from the skills under disturbances, each executed again natively",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
)
