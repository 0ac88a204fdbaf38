"""A task's goal in the states of its native environment: our verdict beside the native one, and what either costs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse_file
from onto_compiler.knowledge import Knowledge, load_knowledge
from runtime.loop.monitor import GoalMonitor
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.snapshot import Snapshot

__all__ = ["NativeGoal"]

CALLS, PASSES = 20, 3


class NativeGoal:
    """The required facts of a task, grounded in its native environment's own state."""

    def __init__(self, ref: TaskRef, native: NativeTask) -> None:
        """Lift the task and resolve its facts on the environment's model."""
        self._knowledge = _knowledge()
        schema = self._knowledge.schema
        self._required = required_abox(parse_file(ref.bddl), schema, ref.name)
        self._scene = Scene(native.model)
        grounder = SimGrounder(self._scene, self._required.facts, schema)
        self._monitor = GoalMonitor(self._required, grounder, self._knowledge.tables)

    @property
    def movable(self) -> str:
        """An object that can be grasped: the goal's first, or the scene's where the goal moves none."""
        free = [name for name in self._scene.entities if self._scene.free_joint(name) is not None]
        named = [name for fact in self._required.facts for name in fact.native.arguments if name in free]
        return (*named, *free)[0]

    def holds(self, native: NativeTask) -> bool:
        """Whether the goal has no unmet fact in the present state."""
        return not self._monitor.unmet(native.data)

    def microseconds(self, native: NativeTask, states: Sequence[Snapshot]) -> dict[str, float]:
        """Mean over ``states``: to ground and diagnose the goal, without margins and with, and ``check_success``."""
        data = native.data
        calls = {
            "grounding_us": lambda: self._monitor.unmet(data),
            "margins_us": lambda: self._monitor.diagnose(data),
            "check_success_us": native.env._check_success,  # noqa: SLF001  without what NativeTask adds
        }
        found: dict[str, list[float]] = {name: [] for name in calls}
        for state in states:
            native.restore(state)
            for name, call in calls.items():
                found[name].append(_least(call))
        return {name: 1e6 * float(np.mean(seconds)) for name, seconds in found.items()}


@cache
def _knowledge() -> Knowledge:
    return load_knowledge()


def _least(call: Callable[[], object]) -> float:
    """Seconds a call: of :data:`CALLS` in a row, the best of some passes."""
    best = float("inf")
    for _ in range(PASSES):
        started = time.perf_counter()
        for _ in range(CALLS):
            call()
        best = min(best, (time.perf_counter() - started) / CALLS)
    return best
