"""How the tree is built: what a new field or a new world touches, imports, one meaning, and what a clone costs.

Each trial measures one thing about the checkout that it runs in; the suite and the core environment are measured in a
copy of the commit, as a person would have it.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from benchmarks.protocol import Protocol, Row, Trial, alone

__all__ = ["HOUSE"]

ROOT = Path(__file__).resolve().parent.parent
CASES, SEED = 2000, 20261130
"""How many random facts and observations each part is asked about."""
_DURATION = re.compile(r"\s*\d+\.\d+s (?:call|setup|teardown)\s")


def _field() -> Row:
    from benchmarks.house_field import add_a_field  # noqa: PLC0415 - each measure imports what it needs

    files = sorted(add_a_field())
    return {"files_for_a_field": len(files), "files": files}


def _world() -> Row:
    from benchmarks.house_imports import naming_tasks_of  # noqa: PLC0415

    files = sorted(naming_tasks_of("robosuite"))
    return {"files_for_a_world": len(files), "files": files}


def _imports() -> Row:
    from benchmarks.house_imports import import_circles, upward_imports, world_leaks  # noqa: PLC0415

    found = {"import_circles": import_circles(), "upward_imports": upward_imports(), "world_leaks": world_leaks()}
    return {name: len(each) for name, each in found.items()} | {"found": {n: list(e) for n, e in found.items()}}


def _satisfied() -> Row:
    from benchmarks.house_satisfied import PARTS, differing  # noqa: PLC0415

    found = differing(CASES, SEED)
    return {
        "duplicate_definitions_of_satisfied": len(found),
        "cases": CASES,
        "parts": sorted(PARTS),
        "differences": found,
    }


def _environment() -> Row:
    from benchmarks.house_env import core_env_mib  # noqa: PLC0415

    return {"core_env_mib": round(core_env_mib(), 1)}


def _demo() -> Row:
    from benchmarks.house_demo import demo_seconds  # noqa: PLC0415

    return {name: round(seconds, 1) for name, seconds in demo_seconds().items()}


def _suite() -> Row:
    """Minutes of the whole suite on two processes, in a clone of the commit that has this environment's packages."""
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / "clone"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)  # noqa: S603, S607
        command = [sys.executable, "-m", "pytest", "-n", "2", "--dist", "loadfile", "-q", "--durations=40"]
        command += ["--hypothesis-profile=ci", "-p", "no:cacheprovider"]
        started = time.perf_counter()
        done = subprocess.run(  # noqa: S603
            command,
            cwd=clone,
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, "PYTHONPATH": str(clone)},
        )
        minutes = (time.perf_counter() - started) / 60
    lines = done.stdout.strip().splitlines()
    return {
        "suite_min": round(minutes, 2),
        "exit": done.returncode,
        "result": lines[-1].strip("= "),
        "failed": [line for line in lines if line.startswith(("FAILED", "ERROR "))],
        "slowest": [" ".join(line.split()) for line in lines if _DURATION.match(line)],
    }


MEASURES: Mapping[str, Callable[[], Row]] = {
    "field": _field,
    "world": _world,
    "imports": _imports,
    "satisfied": _satisfied,
    "environment": _environment,
    "demo": _demo,
    "suite": _suite,
}
QUICK = ("field", "world", "imports", "satisfied")
"""Those that take seconds."""


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """One trial per measure; without ``full`` those that take seconds."""
    return [{"key": name} for name in (MEASURES if full else QUICK)]


def run(trial: Trial) -> list[Row]:
    """Take one measure."""
    return [{"mode": "none", "sees": "none", **MEASURES[trial["key"]]()}]


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """The numbers of every row, by their names."""
    names = (
        *("files_for_a_field", "files_for_a_world", "import_circles", "upward_imports", "world_leaks"),
        *("duplicate_definitions_of_satisfied", "suite_min", "core_env_mib", "demo_first_s", "demo_warm_s"),
    )
    found = {name: row[name] for row in rows for name in names if name in row}
    return {**{name: found[name] for name in names if name in found}, "crashed": sum("crashed" in row for row in rows)}


HOUSE = Protocol(
    name="house",
    help="files that a new field or world touches, imports, one meaning of satisfied, the suite's and the demo's time",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    alone=alone,
)
