"""Compare two audits: which initial states gained or lost a premise failure, and by how much."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

from runtime.worlds.libero.audit.records import Audit, StateAudit, TaskAudit

__all__ = ["AuditChange", "compare"]


@dataclass(frozen=True, slots=True)
class AuditChange:
    """One kind of failure of one subject, in the states that both audits have of a task.

    ``new`` and ``gone`` are the states in which only the second, or only the first, has the failure. ``before`` and
    ``after`` are the median margins over those states, in ``unit``; None if one of the two does not define it.
    """

    task: str
    kind: str
    subject: str
    unit: str
    states: int
    new: tuple[int, ...]
    gone: tuple[int, ...]
    before: float | None
    after: float | None


def compare(first: Audit, second: Audit) -> tuple[AuditChange, ...]:
    """What changed from ``first`` to ``second``, task by task; faults count as failures without a margin."""
    others = {(task.suite, task.name): task for task in second.tasks}
    found: list[AuditChange] = []
    for task in first.tasks:
        other = others.get((task.suite, task.name))
        if other is not None:
            found += _changes(task, other, first, second)
    return tuple(found)


Key = tuple[str, str]


def _changes(task: TaskAudit, other: TaskAudit, first: Audit, second: Audit) -> Iterator[AuditChange]:
    yield from _task_faults(task, other)
    later = {state.state: state for state in other.states}
    pairs = [(state, later[state.state]) for state in task.states if state.state in later]
    new: dict[Key, list[int]] = defaultdict(list)
    gone: dict[Key, list[int]] = defaultdict(list)
    units: dict[Key, str] = {}
    for a, b in pairs:
        before, after = _found(a), _found(b)
        units |= before | after
        for key in after.keys() - before.keys():
            new[key].append(a.state)
        for key in before.keys() - after.keys():
            gone[key].append(a.state)
    for key in sorted(new.keys() | gone.keys()):
        kind, subject = key
        changed = {*new[key], *gone[key]}
        some = [(a, b) for a, b in pairs if a.state in changed]
        yield AuditChange(
            task=task.label,
            kind=kind,
            subject=subject,
            unit=units[key],
            states=len(pairs),
            new=tuple(new[key]),
            gone=tuple(gone[key]),
            before=_margin([a for a, _ in some], kind, subject, first),
            after=_margin([b for _, b in some], kind, subject, second),
        )


def _task_faults(task: TaskAudit, other: TaskAudit) -> Iterator[AuditChange]:
    """A task that only one of the two could build or ground."""
    before, after = ({(fault.code, fault.message) for fault in one.faults} for one in (task, other))
    for code, message in sorted(before ^ after):
        which = ((), (0,)) if (code, message) in before else ((0,), ())
        yield AuditChange(task.label, code, message, "", 0, which[0], which[1], None, None)


def _found(state: StateAudit) -> dict[Key, str]:
    """The unit of each failure."""
    failures = {(failure.kind, failure.subject): failure.unit for failure in state.failures}
    return failures | {(fault.code, fault.message): "" for fault in state.faults}


def _margin(states: list[StateAudit], kind: str, subject: str, audit: Audit) -> float | None:
    """The median margin of a kind and subject, from the readings: they are there whether it failed or not."""
    declared = audit.kinds.get(kind)
    if declared is None:
        return None
    most = declared["most"]
    found = []
    for state in states:
        some = state.readings.get(str(declared["measure"]), {})
        value = some.get(subject, None if most is None else 0.0)
        if value is not None:
            found.append(value if most is None else most - value)
    return round(median(found), 6) if found else None
