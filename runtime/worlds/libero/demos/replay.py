"""Execute demonstrations again in LIBERO's own environment, and compare the results with the recorded ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.fixtures import fixtures_of_demo
from runtime.worlds.libero.demos.read import load
from runtime.worlds.libero.demos.records import DemoFile, Demonstration
from runtime.worlds.libero.simulator.assets import TaskRef, find_task
from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["AFTER", "DemoReplay", "replay", "replay_file", "task_of"]

AFTER = 20  # control steps without motion, after which the task must still be done


@dataclass(frozen=True, slots=True)
class DemoReplay:
    """The result of replaying one demonstration.

    ``reached`` counts actions until the native predicate is first true, 0 if it never is; ``recorded`` is the number in
    the file, 0 without one. ``holds`` is the predicate after :data:`AFTER` further steps with an open, resting hand.
    ``drift`` is the largest difference to a recorded state (in metres, radians or their rates). ``whole``: whether it
    started from a window record and not only from the flat state; ``placed``: whether the fixtures' poses are the
    recorded ones.
    """

    file: str
    suite: str
    task: str
    demo: str
    steps: int
    recorded: int
    reached: int
    holds: bool
    drift: float
    whole: bool
    placed: bool

    @property
    def same(self) -> bool:
        """Whether it succeeded, and where a step is recorded, at that step and for good."""
        return self.reached > 0 and (not self.recorded or (self.reached == self.recorded and self.holds))


def replay(path: str | Path) -> Iterator[DemoReplay]:
    """Replay every demonstration of a file.

    Raises:
        OntoError: ``DEM001``, ``DEM002``, ``DEM004`` for the file; ``DEM005`` if the installed LIBERO lacks its
            task or has another of that name; ``SIM003`` and ``SIM004`` for a state of another scene.
    """
    file = load(path)
    with NativeTask.open(task_of(file)) as task:
        for demo in file.demos:
            yield _replay(task, file, demo)


def replay_file(path: Path) -> tuple[DemoReplay, ...] | OntoError:
    """The same in one piece, with what would be raised: for worker processes."""
    try:
        return tuple(replay(path))
    except OntoError as error:
        return error


def _replay(task: NativeTask, file: DemoFile, demo: Demonstration) -> DemoReplay:
    fixtures = fixtures_of_demo(demo, task.model, file.path)
    if demo.start is not None:
        task.restore(demo.start)
    else:
        task.reset_to(demo.init_state, fixtures)
    reached, drift = 0, 0.0
    for number, (state, action) in enumerate(zip(demo.states, demo.actions, strict=True), start=1):
        data = task.data
        now = np.concatenate([[data.time], data.qpos, data.qvel])
        if now.size != state.size:
            message = f"a state of `{demo.name}` has {state.size} numbers, the scene of `{file.task}` {now.size}"
            raise OntoError.of("SIM004", message, "take the LIBERO that it was recorded in", file.path)
        drift = max(drift, float(np.abs(now - state)[1:].max()))
        if task.step(action) and not reached:
            reached = number
    task.settle(AFTER)
    recorded = demo.origin.success_step if demo.origin else 0
    return DemoReplay(
        file.path,
        file.suite,
        file.task,
        demo.name,
        len(demo),
        recorded,
        reached,
        task.success(),
        drift,
        demo.start is not None,
        fixtures is not None,
    )


def task_of(file: DemoFile) -> TaskRef:
    """The installed task that was recorded; raises ``DEM005`` if there is none, or another of that name."""
    try:
        ref = find_task(file.suite, file.task)
    except OntoError as error:
        problem = error.problems[0]
        if problem.code == "SIM010":
            raise
        message = f"the file is of `{file.suite}/{file.task}`: {problem.message}"
        raise OntoError.of("DEM005", message, problem.hint, file.path) from error
    content = file.attributes.get("bddl_file_content")
    if content is not None and content != ref.bddl.read_text(encoding="utf-8"):
        message = f"the task file of `{file.suite}/{file.task}` is another than the one that was recorded"
        raise OntoError.of("DEM005", message, "install the LIBERO that it was recorded in", file.path)
    return ref
