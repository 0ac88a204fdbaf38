"""An audit and a comparison as text for people."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from math import nan

from onto_compiler.wording import counted
from runtime.wording import amount
from runtime.worlds.libero.audit.compare import AuditChange
from runtime.worlds.libero.audit.records import Audit, Failure, TaskAudit

__all__ = ["audit_text", "changes_text", "ranges"]


def audit_text(audit: Audit) -> str:
    """Each task with a finding, its findings by kind and subject, and a summary; tasks with the same fault together."""
    lines = [line for tasks in _alike(audit.tasks) for line in _lines(tasks)]
    states = sum(len(task.states) for task in audit.tasks)
    odd = sum(bool(state.failures) for task in audit.tasks for state in task.states)
    broken = sum(bool(task.faults) or any(s.faults for s in task.states) for task in audit.tasks)
    total = f"{counted(len(audit.tasks), 'task')}, {counted(states, 'initial state')}: {odd} with a premise failure"
    total += f"; {counted(broken, 'task')} with something that could not be audited" if broken else ""
    return "\n".join([*lines, f"{total} (MuJoCo {audit.versions.get('mujoco', 'unknown')}, seed {audit.seed})"]) + "\n"


def _alike(tasks: Sequence[TaskAudit]) -> list[list[TaskAudit]]:
    """Groups the tasks of a suite that could not be built for the same reason; every other task is alone."""
    groups: dict[object, list[TaskAudit]] = defaultdict(list)
    for task in tasks:
        groups[(task.suite, task.faults) if task.faults and not task.states else id(task)].append(task)
    return list(groups.values())


def _lines(tasks: Sequence[TaskAudit]) -> Iterator[str]:
    if len(tasks) == 1:
        yield from _task_lines(tasks[0])
        return
    first = tasks[0]
    yield f"{first.suite}: {len(tasks)} tasks ({ranges([task.index for task in tasks])})"
    yield from _faults(first)


def _faults(task: TaskAudit) -> Iterator[str]:
    for fault in task.faults:
        yield f"  {fault.code}: {fault.message}"
        if fault.hint:
            yield f"    help: {fault.hint}"


def _task_lines(task: TaskAudit) -> Iterator[str]:
    found: dict[tuple[str, str], dict[int, Failure]] = defaultdict(dict)
    faults: dict[tuple[str, str], list[int]] = defaultdict(list)
    for state in task.states:
        for failure in state.failures:
            found[failure.kind, failure.subject][state.state] = failure
        for fault in state.faults:
            faults[fault.code, fault.message].append(state.state)
    if not (found or faults or task.faults):
        return
    yield f"{task.label} {task.name}" if task.suite else task.name
    yield from _faults(task)
    for (code, message), states in faults.items():
        yield f"  {code}: {message}, in {_of(states, task)}"
    for (kind, subject), failures in found.items():
        worst = min(failures.values(), key=lambda failure: nan if failure.margin is None else failure.margin)
        margin = amount(nan if worst.margin is None else worst.margin, worst.unit)
        why = ", ".join(part for part in (worst.failure, worst.limit and f"by {worst.limit}") if part)
        yield f"  {kind}: {subject}, in {_of(list(failures), task)}; worst margin {margin}{f' ({why})' if why else ''}"


def _of(states: Sequence[int], task: TaskAudit) -> str:
    total = len(task.states)
    return f"all {total} states" if len(states) == total > 1 else f"{len(states)} of {total} states ({ranges(states)})"


def ranges(numbers: Sequence[int]) -> str:
    """``0-3, 7`` for 0, 1, 2, 3, 7."""
    runs: list[list[int]] = []
    for number in sorted(numbers):
        if runs and number == runs[-1][-1] + 1:
            runs[-1][1:] = [number]
        else:
            runs.append([number])
    return ", ".join("-".join(map(str, run)) for run in runs)


def changes_text(changes: Sequence[AuditChange], first: Audit, second: Audit) -> str:
    """The findings that only one of the two audits has."""
    names = sorted({*first.versions, *second.versions})
    lines = [
        f"{name}: {first.versions.get(name, 'none')} -> {second.versions.get(name, 'none')}"
        for name in names
        if first.versions.get(name) != second.versions.get(name)
    ]
    last = ""
    for change in changes:
        lines += [change.task] if change.task != last else []
        last = change.task
        for states, word in ((change.new, "new"), (change.gone, "gone")):
            if states and not change.states:
                lines.append(f"  {word}: {change.kind}: {change.subject}")
            elif states:
                of = f"{len(states)} of {change.states} states ({ranges(states)})"
                lines.append(f"  {word}: {change.kind}: {change.subject}, in {of}")
        if change.before is not None and change.after is not None:
            unit = change.unit
            lines.append(f"    median margin there {amount(change.before, unit)} -> {amount(change.after, unit)}")
    shared = len({(t.suite, t.name) for t in first.tasks} & {(t.suite, t.name) for t in second.tasks})
    lines.append(f"{counted(shared, 'task')} in both: {len({c.task for c in changes})} differ")
    return "\n".join(lines) + "\n"
