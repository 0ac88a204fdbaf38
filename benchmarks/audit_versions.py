"""The premise of forty tasks under other versions of MuJoCo than the tested one, in the first initial states of each.

Each version runs in an environment of its own, which differs from this one in MuJoCo and in nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.audit import FALSE, rows_of
from benchmarks.overlay import overlay
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.cache import cache_folder
from onto_compiler.problems import OntoError
from onto_compiler.versions import version_of
from runtime.worlds.libero.audit.fan_out import AuditPlan, run_audit
from runtime.worlds.libero.audit.interpreter import run_elsewhere
from runtime.worlds.libero.audit.records import Audit, read_audit
from runtime.worlds.libero.simulator.assets import tasks

__all__ = ["AUDIT_VERSIONS"]

SEED = 0
OTHERS = ("3.4.0", "4.0.0")  # the first with other collisions between boxes, and the newest
STATES = {True: 5, False: 1}  # states of a task mostly agree: see the audit
SUITES = {True: ("libero_spatial", "libero_goal", "libero_object", "libero_10"), False: ("libero_spatial",)}


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each suite under each version, the installed one first."""
    return [
        {"key": f"{version or 'installed'}/{suite}", "other": version, "suite": suite, "states": STATES[full]}
        for suite in SUITES[full]
        for version in ("", *OTHERS)
    ]


def run(trial: Trial) -> list[Row]:
    """One row per task and initial state."""
    suite, states, version = trial["suite"], trial["states"], trial["other"]
    found = _elsewhere(suite, states, version) if version else _here(suite, states)
    mujoco = found.versions["mujoco"]
    return [{"task": task.index, "mujoco": mujoco, **row} for task in found.tasks for row in rows_of(task)]


def _here(suite: str, states: int) -> Audit:
    return run_audit(tasks(suite), AuditPlan(states, SEED, (), cache_folder()), 1, lambda _: None)


def _elsewhere(suite: str, states: int, version: str) -> Audit:
    folder = cache_folder()
    if folder is None:
        raise OntoError.of("BEN004", "there is no home folder to make an environment in", "set HOME")
    python = overlay("mujoco", version, folder / "environments")
    with TemporaryDirectory() as scratch:
        record = Path(scratch) / "audit.json"
        options = ["--states", str(states), "--seed", str(SEED), "--jobs", "1", "--out", str(record)]
        run_elsewhere(str(python), ["audit", suite, *options], quiet=True)
        return read_audit(record)


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """By version: states, those with a false initial fact, and those whose premise differs from the installed one's."""
    whole = [row for row in rows if "crashed" not in row]
    found: dict[str, float] = {"crashed": len(rows) - len(whole), "faults": sum(len(row["faults"]) for row in whole)}
    false = {
        (row["mujoco"], row["suite"], row["task"], row["state"]): {
            failure["subject"] for failure in row["failures"] if failure["kind"] == FALSE
        }
        for row in whole
        if row["state"] is not None
    }
    by_version = {
        version: {key[1:]: facts for key, facts in false.items() if key[0] == version}
        for version in dict.fromkeys(row["mujoco"] for row in whole)
    }
    tested = by_version.get(_tested(whole), {})
    for version, mine in by_version.items():
        found[f"{version}.states"] = len(mine)
        found[f"{version}.premise_false_states"] = sum(bool(facts) for facts in mine.values())
        found[f"{version}.changed_states"] = sum(facts != tested.get(where) for where, facts in mine.items())
    return found


def _tested(rows: Sequence[Row]) -> str:
    """The version that stands in the rows of the installed one."""
    return next((row["mujoco"] for row in rows if not row["other"]), version_of("mujoco") or "")


AUDIT_VERSIONS = Protocol(
    name="audit_versions",
    help="the premise of the forty tasks of four suites under other versions of MuJoCo than the tested one",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
)
