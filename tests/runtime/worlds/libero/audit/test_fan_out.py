"""A process that dies costs one task its audit, and no other."""

from __future__ import annotations

from pathlib import Path

import pytest

from onto_compiler.pool import WorkerDiedError

pytestmark = pytest.mark.sim


def test_a_task_that_takes_its_process_down_is_named_and_the_others_are_audited(monkeypatch):
    from runtime.worlds.libero.audit import fan_out
    from runtime.worlds.libero.audit.records import StateAudit, TaskAudit
    from runtime.worlds.libero.simulator.assets import TaskRef

    refs = [TaskRef("suite", index, f"task_{index}", Path("no.bddl"), Path("no.npz")) for index in range(4)]

    def mapped(_function, some, _jobs, *, apart=False):
        for ref in some:
            if ref.index == 1:
                raise WorkerDiedError.of("CLI007", "killed")
            yield ref, TaskAudit(ref.suite, ref.index, ref.name, False, 1, (StateAudit(0),))

    monkeypatch.setattr(fan_out, "map_over_processes", mapped)
    told = []
    audit = fan_out.run_audit(refs, fan_out.AuditPlan(), 2, told.append)
    assert [task.index for task in audit.tasks] == [0, 1, 2, 3]
    assert [[fault.code for fault in task.faults] for task in audit.tasks] == [[], ["RUN024"], [], []]
    assert sorted(task.index for task in told) == [0, 1, 2, 3]
    assert not audit.clean
