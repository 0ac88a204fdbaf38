"""The main job as a person runs it: ``onto demo`` in a fresh process, timed from outside.

What LIBERO accepts before a correction is the baseline of the same run (``initially_true``).
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Mapping, Sequence

from benchmarks.program import onto
from benchmarks.protocol import Protocol, Row, Trial

__all__ = ["DEMO"]


def trials(full: bool) -> list[Trial]:  # noqa: ARG001, FBT001 - the protocol's signature; there is one size
    """The command once."""
    return [{"key": "demo"}]


def run(trial: Trial) -> list[Row]:  # noqa: ARG001 - the protocol's signature
    """One row per task.

    Raises:
        RuntimeError: where the command broke off, with what it said.
    """
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        done = onto("demo", "--json", "--out", folder)
        wall = time.perf_counter() - started
    if done.returncode not in {0, 1}:
        raise RuntimeError(done.stderr.strip())
    return [
        {
            "task": task["task"],
            "mode": "state",
            "sees": "privileged-state",
            "initially_true": task["outcome"] == "verified",
            "accepted": task["accepted"],
            "settled": bool(task["accepted"] and task["settled"]),
            "attempts": task["attempts"],
            "premise_holds": task["premise_holds"],
            "diagnoses": task["diagnoses"],
            "wall_s": round(wall, 2),
        }
        for task in json.loads(done.stdout)["tasks"]
    ]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Counts over the tasks, and the seconds of the whole command."""
    whole = [row for row in rows if "crashed" not in row]
    return {
        "tasks": len(whole),
        "initially_true": sum(row["initially_true"] for row in whole),
        "accepted": sum(row["accepted"] for row in whole),
        "settled": sum(row["settled"] for row in whole),
        "attempts": sum(row["attempts"] for row in whole),
        "wall_s": max((row["wall_s"] for row in whole), default=0.0),
        "crashed": len(rows) - len(whole),
    }


DEMO = Protocol(
    name="demo",
    help="`onto demo`: ten LIBERO-Goal tasks, repaired by writing the state",
    seeds=(0,),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"wall_s"}),
)
