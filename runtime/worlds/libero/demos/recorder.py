"""A simulation that records its states, hidden ones too, its actions, what is true, and LIBERO's observations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from runtime.worlds.libero.simulator.actions import ACTION_SIZE, DUMMY_ACTION
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.snapshot import Snapshot

__all__ = ["DemoRecorder"]

Observed = Mapping[str, NDArray[Any]]


class DemoRecorder(Simulation):
    """The exact loop; from :meth:`begin` on each step is disturbed, executed and recorded.

    An observation is the one available to a policy for choosing the action: LIBERO's of the previous step, taken one
    substep before that step's end.
    """

    def __init__(
        self,
        scene: CompiledScene,
        observe: Callable[[mujoco.MjData], Observed],
        holds: Callable[[mujoco.MjData], bool],
        facts: Callable[[mujoco.MjData], NDArray[np.bool_]],
    ) -> None:
        """Record what ``observe`` reads, when ``holds`` is true for the first time, and which ``facts`` (k,) hold.

        ``holds`` is asked as LIBERO's environment asks after a step, with contacts that are one substep old.
        """
        self._observe, self._holds, self._facts, self._seen = observe, holds, facts, dict[str, NDArray[Any]]()
        self._disturb: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None
        self._recording = False
        super().__init__(scene, exact=True)

    def prepare(self, state: ArrayLike, steps: int) -> None:
        """Go to the flat ``state`` and let it settle for ``steps`` control steps, unrecorded; the last is observed."""
        self._recording, self._disturb = False, None
        self.reset_to(state)
        self.settle(steps - 1)
        super().step(DUMMY_ACTION, self._look)

    def begin(self, disturb: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> None:
        """Record from here on; every action (7,) is passed through ``disturb``."""
        self._recording, self._disturb = True, disturb
        self.wanted: list[NDArray[np.float64]] = []
        self.actions: list[NDArray[np.float64]] = []
        self.before: list[Snapshot] = []
        self.truth: list[NDArray[np.bool_]] = []
        self.observed: list[Observed] = []
        self.success_step = 0  # counts actions; 0 while there was no success

    def calm(self) -> None:
        """Stop disturbing."""
        self._disturb = None

    def end(self) -> None:
        """Stop recording."""
        self._recording = False

    def step(self, action: ArrayLike, before_last_substep: Callable[[], object] | None = None) -> None:
        """As :meth:`Simulation.step`, which also says what is raised."""
        if not self._recording:
            super().step(action, before_last_substep)
            return
        wanted = np.array(action, dtype=np.float64).reshape(ACTION_SIZE)
        done = wanted if self._disturb is None else self._disturb(wanted)
        before, seen = self.snapshot(), self._seen
        super().step(done, self._look)
        self.wanted.append(wanted)
        self.actions.append(done)
        self.before.append(before)
        self.truth.append(self._facts(self.data))
        self.observed.append(seen)
        if not self.success_step and self._holds(self.data):
            self.success_step = len(self.actions)

    def _look(self) -> None:
        self._seen = dict(self._observe(self.data))
