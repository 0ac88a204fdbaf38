"""Collect demonstrations of many tasks; an interrupted collection can be resumed."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onto_compiler.knowledge import load_knowledge
from onto_compiler.pool import map_over_processes
from onto_compiler.problems import OntoError, Problem
from onto_compiler.versions import version_of
from runtime.worlds.libero.demos.describe import describe
from runtime.worlds.libero.demos.hdf5 import h5py
from runtime.worlds.libero.demos.keep import Kept, TaskStore
from runtime.worlds.libero.demos.trial import TaskCollector
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states

__all__ = ["COUNTS", "Collected", "CollectionRequest", "collect", "collect_task", "count_for"]

FORMAT = 2  # of what is kept
COUNTS = {"libero_goal": 50, "libero_spatial": 10, "libero_object": 10, "libero_10": 10}
"""The default number of demonstrations per task, by suite."""
_OTHER = 10
_PACKAGES = ("mujoco", "robosuite", "numpy")


@dataclass(frozen=True, slots=True)
class CollectionRequest:
    """``count`` demonstrations of a task, from the trials of ``seed``, into ``folder``."""

    ref: TaskRef
    count: int
    seed: int
    folder: Path
    images: bool = False

    @property
    def trials(self) -> int:
        """How many trials are run at most."""
        return 3 * self.count + 10


@dataclass(frozen=True, slots=True)
class Collected:
    """The result for one task: ``demos`` in the file at ``path``, from ``trials``; ``rejected`` counts by reason.

    ``busy`` means that another process collects it.
    """

    suite: str
    index: int
    task: str
    path: str
    wanted: int
    demos: int
    trials: int
    rejected: Mapping[str, int]
    busy: bool = False

    @property
    def short(self) -> bool:
        """Whether fewer were found than wanted."""
        return self.demos < self.wanted


def count_for(suite: str) -> int:
    """How many demonstrations of each of its tasks a suite gets."""
    return COUNTS.get(suite, _OTHER)


def collect(orders: Sequence[CollectionRequest], jobs: int, tick: Callable[[Collected], None]) -> tuple[Collected, ...]:
    """Carry out ``orders`` in at most ``jobs`` processes; waits for tasks that other processes are collecting.

    ``tick`` is called with each task when it is done. When all are done, raises the problems of tasks that could not
    be collected: ``SIM013``, ``DEM003``, ``DEM004``, ``DEM006``, ``CLI007``, and as ``onto ground``.
    """
    h5py()
    done: dict[CollectionRequest, Collected] = {}
    problems: list[Problem] = []
    for wait in (False, True):
        left = [order for order in orders if order not in done]
        for order, found in map_over_processes(_wait if wait else _try, left, jobs):
            if isinstance(found, OntoError):
                problems += found.problems
                done[order] = _nothing(order)
            elif not found.busy:
                done[order] = found
            if order in done:
                tick(done[order])
    if problems:
        raise OntoError(*problems)
    return tuple(done[order] for order in orders)


def collect_task(order: CollectionRequest, *, wait: bool) -> Collected:
    """Collect one task; without ``wait``, only where no other process does. Raises as :func:`collect`."""
    ref, spec = order.ref, _spec(order)
    store = TaskStore(order.folder, ref.suite, ref.name, spec)
    with store.locked(wait=wait) as mine:
        if not mine:
            return _nothing(order, busy=True)
        kept = store.known()
        if _complete(order, store, kept):
            return _collected(order, store, kept)
        initial_states(ref)
        attributes, model = describe(ref, images=order.images)
        kept = _run(order, store, kept, attributes, model)
        if any(not isinstance(place, str) for place in kept.values()):
            store.finish(kept, attributes, order.count)
        return _collected(order, store, kept)


def _run(order: CollectionRequest, store: TaskStore, kept: Kept, attributes: Mapping[str, Any], model: str) -> Kept:
    collector: TaskCollector | None = None
    found: Kept = {}
    try:
        for trial in range(order.trials):
            if sum(not isinstance(place, str) for place in found.values()) >= order.count:
                break
            if trial not in kept:
                collector = collector or TaskCollector(
                    order.ref, load_knowledge(), order.seed, model, images=order.images
                )
                kept[trial] = store.keep(trial, attributes, collector.collect(trial))
            found[trial] = kept[trial]
    finally:
        if collector is not None:
            collector.close()
    return found


def _complete(order: CollectionRequest, store: TaskStore, kept: Kept) -> bool:
    """Whether the file holds ``count`` demonstrations, or all that can be collected."""
    inside = [place for place in kept.values() if not isinstance(place, str) and place[0] == store.path]
    parts = [place for place in kept.values() if not isinstance(place, str) and place[0] != store.path]
    return len(inside) >= order.count or (not parts and all(trial in kept for trial in range(order.trials)))


def _collected(order: CollectionRequest, store: TaskStore, kept: Kept) -> Collected:
    reasons = Counter(_kind(place) for place in kept.values() if isinstance(place, str))
    demos = len(kept) - reasons.total()
    ref = order.ref
    return Collected(ref.suite, ref.index, ref.name, str(store.path), order.count, demos, len(kept), dict(reasons))


def _kind(reason: str) -> str:
    return reason.partition(":")[2].strip() or reason


def _nothing(order: CollectionRequest, *, busy: bool = False) -> Collected:
    ref = order.ref
    return Collected(ref.suite, ref.index, ref.name, "", order.count, 0, 0, {}, busy)


def _spec(order: CollectionRequest) -> dict[str, Any]:
    """The settings that determine the bytes of a demonstration."""
    return {
        "format": FORMAT,
        "suite": order.ref.suite,
        "task": order.ref.name,
        "bddl": hashlib.sha256(order.ref.bddl.read_bytes()).hexdigest(),
        "seed": order.seed,
        "images": order.images,
        **{name: version_of(name) or "" for name in _PACKAGES},
    }


def _try(order: CollectionRequest) -> Collected | OntoError:
    return _caught(order, wait=False)


def _wait(order: CollectionRequest) -> Collected | OntoError:
    return _caught(order, wait=True)


def _caught(order: CollectionRequest, *, wait: bool) -> Collected | OntoError:
    try:
        return collect_task(order, wait=wait)
    except OntoError as error:
        return error
