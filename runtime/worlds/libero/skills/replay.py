"""The judge of a played episode: replays its actions in LIBERO's own environment."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.observation import Observation
from grounding.sim import SimGrounder
from onto_compiler.closing import Closing
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.faults import RunFault
from runtime.loop.records import Verification
from runtime.worlds.libero.loop.environment import NativeEnvironment
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.snapshot import Snapshot

__all__ = ["NativeReplay"]


class NativeReplay(Closing):
    """Replays an episode, one native control step at a time; ``steps`` counts them from :meth:`begin`."""

    def __init__(self, task: NativeTask, required: RequiredABox, schema: Schema) -> None:
        """Use ``task``, which :meth:`close` frees; raises ``SIM001`` ff. if a fact names what it lacks."""
        self._task = task
        self._environment = NativeEnvironment(task, required, schema)
        scene = self._environment.scene
        self._facts = SimGrounder(scene, required.facts, schema)
        self._conditions = SimGrounder(scene, [each.fact for each in required.preconditions], schema)
        self.steps = 0

    @property
    def qpos(self) -> NDArray[np.float64]:
        """A copy of the generalised positions, shape (nq,)."""
        return self._environment.qpos

    def begin(self, start: Snapshot) -> None:
        """Go to ``start``; raises ``SIM004`` if it is another scene's."""
        self._task.restore(start)
        self.steps = 0

    def step(self, action: ArrayLike) -> None:
        """Take one control step with an action (7,).

        Raises:
            RunFault: where MuJoCo meets a bad number; the state is then the one before.
        """
        before = self._task.snapshot()
        self._task.step(action)
        if self._task.diverged:
            self._task.restore(before)
            raise RunFault(f"the native state diverged in control step {self.steps + 1}", before)
        self.steps += 1

    def observe(self) -> Observation:
        """The observed ABox of the goal."""
        return self._facts.observe(self._task.data, self.steps)

    def observe_conditions(self) -> Observation:
        """The observed preconditions."""
        return self._conditions.observe(self._task.data, self.steps)

    def observe_premise(self) -> Observation:
        """The observed ABox of the task's declared initial facts."""
        return self._environment.observe_premise()

    def verify(self) -> Verification:
        """LIBERO's verdict; if it accepts, verify again after 20 steps without motion, and restore the state.

        Raises:
            OntoError: ``SIM018`` if LIBERO cannot judge the goal.
        """
        verification = self._environment.verify()
        if not verification.outcome:
            return verification
        before = self._task.snapshot()
        settled = self._environment.settle(verification)
        self._task.restore(before)
        return settled

    def close(self) -> None:
        """Free the native environment."""
        self._task.close()
