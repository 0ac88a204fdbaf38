"""Whether each scene matches its task: every official initial state of LIBERO's 130 tasks, set, settled and measured.

Nothing is judged against a baseline: what counts as a failure is declared in ``ontology/audit.ttl``.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict

from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.knowledge import load_knowledge
from runtime.worlds.libero.audit.command import LIBERO
from runtime.worlds.libero.audit.fan_out import kinds_of
from runtime.worlds.libero.audit.records import TaskAudit
from runtime.worlds.libero.audit.task import audit_task
from runtime.worlds.libero.simulator.assets import find_task, tasks

__all__ = ["AUDIT", "FALSE", "metrics", "rows_of"]

SEED = 0  # places the fixtures, which official initial states leave out
FALSE = "initial_fact_false"
SMALL = 2  # initial states of the first task of each suite


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Each task with all its initial states."""
    return [
        {"key": f"{suite}/{ref.index}", "suite": suite, "task": ref.index, "states": None if full else SMALL}
        for suite in LIBERO
        for ref in (tasks(suite) if full else tasks(suite)[:1])
    ]


def run(trial: Trial) -> list[Row]:
    """One row per initial state, and one for what kept the task from being audited."""
    ref = find_task(trial["suite"], trial["task"])
    return list(rows_of(audit_task(ref, load_knowledge(), kinds_of(()), trial["states"], SEED)))


def rows_of(task: TaskAudit) -> Iterator[Row]:
    """An audited task as rows; the readings stay behind."""
    seen = {"name": task.name, "mode": "none", "sees": "privileged-state", "official": task.official}
    if task.faults or not task.states:
        yield {**seen, "state": None, "faults": [asdict(fault) for fault in task.faults], "failures": []}
    for state in task.states:
        faults, failures = ([asdict(one) for one in some] for some in (state.faults, state.failures))
        yield {**seen, "state": state.state, "faults": faults, "failures": failures}


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Counts of tasks and states, and how many of either show each kind of failure."""
    whole = [row for row in rows if "crashed" not in row]
    states = [row for row in whole if row["state"] is not None]
    found: dict[str, float] = {
        "tasks": len({_task(row) for row in states}),
        "states": len(states),
        "crashed": len(rows) - len(whole),
        "faults": sum(len(row["faults"]) for row in whole),
        "premise_false_states": sum(_shows(row, FALSE) for row in states),
        "premise_false_tasks": len({_task(row) for row in states if _shows(row, FALSE)}),
        "sound_states": sum(not row["failures"] and not row["faults"] for row in states),
    }
    kinds = Counter(kind for row in states for kind in {failure["kind"] for failure in row["failures"]})
    in_tasks = Counter(kind for _, kind in {(_task(row), f["kind"]) for row in states for f in row["failures"]})
    for kind in sorted(kinds):
        found[f"{kind}.states"], found[f"{kind}.tasks"] = kinds[kind], in_tasks[kind]
    for suite in dict.fromkeys(row["suite"] for row in rows):
        found[f"{suite}.premise_false_states"] = sum(_shows(row, FALSE) for row in states if row["suite"] == suite)
    return found


def _task(row: Row) -> tuple[str, int]:
    return row["suite"], row["task"]


def _shows(row: Row, kind: str) -> bool:
    return any(failure["kind"] == kind for failure in row["failures"])


AUDIT = Protocol(
    name="audit",
    help="whether every official initial state of LIBERO's 130 tasks is what the task declares",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
)
