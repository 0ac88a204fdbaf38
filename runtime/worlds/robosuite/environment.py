"""An open robosuite task: grounded by us, judged by robosuite's ``_check_success``."""

from __future__ import annotations

from numpy.typing import ArrayLike

from grounding.scenes import Scene
from onto_compiler.bddl.parse import parse_file
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.records import Verification
from runtime.worlds.environment import StateEnvironment, settling
from runtime.worlds.robosuite.native import RobosuiteTask, versions
from runtime.worlds.world import TaskRef

__all__ = ["PREMISE_STEPS", "RobosuiteEnvironment"]

PREMISE_STEPS = 10  # control steps of 1/20 s: objects are placed a little above what they fall on


class RobosuiteEnvironment(StateEnvironment):
    """What :class:`~runtime.worlds.robosuite.world.Robosuite` opens."""

    judged = True

    def __init__(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> None:
        """Build the environment that the task file names; raises ``SIM`` problems."""
        self.task = RobosuiteTask(parse_file(ref.bddl), seed)
        super().__init__(self.task, Scene(self.task.model, self.task.naming), required, schema)
        self.seed = seed

    def verify_natively(self) -> Verification:
        """Robosuite's verdict."""
        return Verification("_check_success()", self.task.success())

    def start(self, index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Draw initial state ``index``, or write a flat ``state``, and let it settle; raises as its protocol says."""
        if state is None:
            self.task.reset(index)
        else:
            self.task.reset_to(state)
        steps = settling(state, settle, PREMISE_STEPS)
        self.task.settle(steps)
        if self.task.diverged:
            message = f"the simulation of `{self.task.spec.problem}` diverged while its state settled"
            raise OntoError.of("SIM019", message)
        return steps

    def versions(self) -> dict[str, str]:
        """Versions of the packages that affect physical results."""
        return versions()

    def close(self) -> None:
        """Free the environment."""
        self.task.close()
