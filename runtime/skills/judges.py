"""Who says whether a played episode reached its goal: LIBERO itself, or the exact loop with the goal as grounded.

A judge starts from the snapshot that the play started from and takes the same actions. Both judges are bit-equal to the
native environment, so they see the states that an exact play saw; only the native one asks LIBERO's own predicate.
"""

from __future__ import annotations

from dataclasses import replace
from types import TracebackType
from typing import Literal, Protocol, Self

import mujoco
from numpy.typing import ArrayLike

from grounding.observation import Observation
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.diagnosis import unmet
from runtime.environment import SETTLE_STEPS, NativeEnvironment
from runtime.faults import RunFault
from runtime.records import Verification
from runtime.simulator.compiled import CompiledScene
from runtime.simulator.native import NativeTask
from runtime.simulator.simulation import Simulation
from runtime.simulator.snapshot import Snapshot

__all__ = ["ExactJudge", "Judge", "NativeJudge", "View"]

_GROUNDED = "the goal as grounded, in the exact loop"


class View:
    """The required facts, the task's initial facts and the preconditions of one scene, grounded in a state."""

    def __init__(self, scene: Scene, required: RequiredABox, schema: Schema) -> None:
        """Resolve all of them; raises ``SIM001`` ff. where one names what the scene lacks."""
        self._facts = SimGrounder(scene, required.facts, schema)
        self._premise = SimGrounder(scene, required.premise, schema)
        self._conditions = SimGrounder(scene, [each.fact for each in required.preconditions], schema)

    def facts(self, data: mujoco.MjData, step: int = 0) -> Observation:
        """The observed ABox of the goal, after ``step`` control steps."""
        return self._facts.observe(data, step)

    def premise(self, data: mujoco.MjData) -> Observation:
        """The observed ABox of the declared initial facts."""
        return self._premise.observe(data)

    def conditions(self, data: mujoco.MjData, step: int = 0) -> Observation:
        """What is observed of the preconditions."""
        return self._conditions.observe(data, step)


class Judge(Protocol):
    """A run of the same actions from the same snapshot, and the verdict on where it leads."""

    name: str

    @property
    def data(self) -> mujoco.MjData:
        """The live state, to be read only."""
        ...

    @property
    def view(self) -> View:
        """What can be observed in it."""
        ...

    def begin(self, start: Snapshot) -> None:
        """Go to ``start``, of the same scene; raises ``SIM004`` otherwise."""
        ...

    def step(self, action: ArrayLike) -> None:
        """Take one control step with an action (7,); raises :class:`RunFault` where the state diverges."""
        ...

    def verify(self) -> Verification:
        """Ask whether the goal holds."""
        ...

    def settle(self, verification: Verification) -> Verification:
        """Ask again after the scene was left alone, and go back."""
        ...

    def close(self) -> None:
        """Free what the judge holds."""
        ...


class NativeJudge:
    """LIBERO's own environment steps, and its own ``check_success`` decides."""

    name: Literal["native"] = "native"

    def __init__(self, task: NativeTask, required: RequiredABox, schema: Schema) -> None:
        """Take over ``task``, which :meth:`close` frees; raises as :class:`NativeEnvironment`."""
        self._task = task
        self._environment = NativeEnvironment(task, required, schema)
        self.view = View(self._environment.scene, required, schema)

    @property
    def data(self) -> mujoco.MjData:
        """The native environment's state."""
        return self._task.data

    def begin(self, start: Snapshot) -> None:
        """Write ``start``; raises ``SIM004`` where it is another scene's."""
        self._task.restore(start)

    def step(self, action: ArrayLike) -> None:
        """Take one native step; raises :class:`RunFault` where MuJoCo meets a bad number, and goes back."""
        before = self._task.snapshot()
        self._task.step(action)
        if self._task.diverged:
            self._task.restore(before)
            raise RunFault("the state diverged in the native environment", before)

    def verify(self) -> Verification:
        """Ask ``check_success``; raises ``SIM018`` where LIBERO cannot judge the goal."""
        return self._environment.verify()

    def settle(self, verification: Verification) -> Verification:
        """Ask again after 20 native steps without motion."""
        return self._environment.settle(verification)

    def close(self) -> None:
        """Free the native environment."""
        self._task.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


class ExactJudge:
    """The exact loop steps, and the goal as grounded decides: nothing of LIBERO's environment has to be built."""

    name: Literal["exact"] = "exact"

    def __init__(self, scene: CompiledScene, required: RequiredABox, schema: Schema) -> None:
        """Make a simulation of ``scene``; raises as :class:`View`."""
        self._required = required
        self._simulation = Simulation(scene, exact=True)
        self.view = View(scene.index, required, schema)

    @property
    def data(self) -> mujoco.MjData:
        """The simulation's state."""
        return self._simulation.data

    def begin(self, start: Snapshot) -> None:
        """Write ``start``; raises ``SIM004`` where it is another scene's."""
        self._simulation.restore(start)

    def step(self, action: ArrayLike) -> None:
        """Take one exact step; raises :class:`RunFault` where the state diverges."""
        self._simulation.step(action)

    def verify(self) -> Verification:
        """Whether no required fact is unmet."""
        return Verification(_GROUNDED, self._holds())

    def settle(self, verification: Verification) -> Verification:
        """Ask again after 20 steps without motion."""
        before = self._simulation.snapshot()
        try:
            self._simulation.settle(SETTLE_STEPS)
            settled = self._holds()
        except RunFault:
            settled = False
        self._simulation.restore(before)
        return replace(verification, settled=settled, settle_steps=SETTLE_STEPS)

    def close(self) -> None:
        """Nothing to free."""

    def _holds(self) -> bool:
        return not unmet(self._required, self.view.facts(self.data))
