"""Audit many tasks in parallel processes; cached audits are not repeated."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

from onto_compiler.knowledge import load_knowledge
from onto_compiler.pool import WorkerDiedError, map_over_processes
from runtime.worlds.libero.audit.cache import AuditCache
from runtime.worlds.libero.audit.kinds import Kind, load_kinds
from runtime.worlds.libero.audit.measures import DECIDING, MEASURES
from runtime.worlds.libero.audit.records import Audit, Fault, TaskAudit
from runtime.worlds.libero.audit.task import audit_task
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.native import versions

__all__ = ["AuditPlan", "kinds_of", "run_audit"]


@dataclass(frozen=True, slots=True)
class AuditPlan:
    """The settings of all task audits: how many ``states`` (None: all), the ontology, and the cache."""

    states: int | None = None
    seed: int = 0
    ontology: tuple[str, ...] = ()
    folder: Path | None = None


def run_audit(refs: Sequence[TaskRef], plan: AuditPlan, jobs: int, tick: Callable[[TaskAudit], None]) -> Audit:
    """Audit ``refs`` in their order, with at most ``jobs`` processes; ``tick`` is called with each when it is done.

    Raises:
        OntoError: TTL and ``RUN020`` if the ontology cannot be used. A task that cannot be audited is a finding.
    """
    kinds = kinds_of(plan.ontology)
    load_knowledge(*plan.ontology)
    done: dict[TaskRef, TaskAudit] = {}
    cache = AuditCache(plan.folder, plan.ontology, plan.seed)
    for ref in refs:
        if (task := _known(ref, plan, cache)) is not None:
            done[ref] = task
            tick(task)
    for ref, task in _all([ref for ref in refs if ref not in done], plan, jobs):
        done[ref] = task
        tick(task)
    declared = {kind.name: {name: v for name, v in asdict(kind).items() if name != "name"} for kind in kinds}
    return Audit(versions(), plan.seed, declared, tuple(done[ref] for ref in refs))


@lru_cache(maxsize=4)
def kinds_of(extra: tuple[str, ...]) -> tuple[Kind, ...]:
    """The kinds of premise failure that the shipped ontology and ``extra`` declare; raises as ``load_kinds``."""
    return load_kinds(extra, measures=MEASURES, deciding=DECIDING)


def _all(refs: Sequence[TaskRef], plan: AuditPlan, jobs: int) -> Iterator[tuple[TaskRef, TaskAudit]]:
    left = dict.fromkeys(refs)
    try:
        for ref, task in map_over_processes(partial(_one, plan), refs, jobs):
            del left[ref]
            yield ref, task
    except WorkerDiedError:
        # One task crashed its process, which ended the pool: run the rest one at a time, to know which it was.
        for ref in left:
            yield ref, _alone(ref, plan)


def _alone(ref: TaskRef, plan: AuditPlan) -> TaskAudit:
    try:
        ((_, task),) = map_over_processes(partial(_one, plan), [ref], 1, apart=True)
    except WorkerDiedError:
        fault = Fault("RUN024", "the process that audited this task died")
        return TaskAudit(ref.suite, ref.index, ref.name, ref.initial_states.is_file(), 0, (), (fault,))
    return task


def _known(ref: TaskRef, plan: AuditPlan, cache: AuditCache) -> TaskAudit | None:
    """The cached audit of ``ref``, if it has all the states that ``plan`` needs."""
    known = cache.load(ref)
    if known is None or len(known.states) < min(plan.states or known.available, known.available):
        return None
    return replace(known, states=known.states[: plan.states])


def _one(plan: AuditPlan, ref: TaskRef) -> TaskAudit:
    cache = AuditCache(plan.folder, plan.ontology, plan.seed)
    known = cache.load(ref)
    before = known.states if known else ()
    task = audit_task(ref, load_knowledge(*plan.ontology), kinds_of(plan.ontology), plan.states, plan.seed, before)
    cache.save(ref, task)
    return task
