"""An open task: grounded by us, changed by writing its state, judged by the simulator itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any, Protocol

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.observation import Observation
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.correction import Environment
from runtime.loop.diagnosis import unmet
from runtime.loop.faults import RunFault
from runtime.loop.records import GROUNDED, Application, Proposal, Verification

__all__ = ["SETTLE_STEPS", "NativeState", "StateEnvironment", "TaskEnvironment", "settling"]

SETTLE_STEPS = 20  # control steps of 1/20 s without motion before an accepted state is verified again


def settling(state: ArrayLike | None, asked: int | None, usual: int) -> int:
    """Control steps without motion before an initial state is judged: ``asked``, if it is given.

    Otherwise an official initial state takes the world's ``usual`` number, and a given one is judged as it is.
    """
    if asked is not None:
        return asked
    return usual if state is None else 0


class TaskEnvironment(Environment, Protocol):
    """An open task: the loop's environment, and what an episode needs in addition."""

    seed: int
    judge: str
    """What verifies: "native", the simulator itself, or "grounding", the grounded required facts."""

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled scene."""
        ...

    def textured(self) -> mujoco.MjModel:
        """The scene as pictures of its states need it, which may be :attr:`model`."""
        ...

    @property
    def data(self) -> mujoco.MjData:
        """The live state."""
        ...

    @property
    def judged(self) -> bool:
        """Whether the simulator can judge the goal."""
        ...

    def observe_premise(self) -> Observation:
        """Ground the task's declared initial facts in the current state."""
        ...

    def start(self, index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Write initial state ``index``, or a flat ``state`` (1 + nq + nv: time, qpos, qvel), and let it settle.

        Returns the number of control steps, see :func:`settling`. Raises ``SIM017`` if there is no such initial state,
        ``SIM003``, ``SIM004`` for a state of another scene, ``SIM019`` if it diverges.
        """
        ...

    def place(self, model: str) -> None:
        """Start all later episodes with the fixtures' poses in the file ``model``; raises ``SIM023``."""
        ...

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """The required facts whose verdict in the present state depends on the fixtures' poses."""
        ...

    def versions(self) -> dict[str, str]:
        """Versions of the packages that affect physical results, for provenance."""
        ...

    def close(self) -> None:
        """Free the scene."""
        ...


class NativeState(Protocol):
    """The state of a simulator's own environment, as :class:`StateEnvironment` needs it."""

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled scene."""
        ...

    @property
    def data(self) -> mujoco.MjData:
        """The live state."""
        ...

    @property
    def diverged(self) -> bool:
        """Whether MuJoCo met a bad number since the last restore."""
        ...

    def write_qpos(self, qpos: ArrayLike) -> None:
        """Write ``qpos`` (nq,), still the joints that it changes, and recompute; raises ``SIM003``, ``SIM004``."""
        ...

    def settle(self, steps: int) -> None:
        """Take control steps without motion."""
        ...

    def snapshot(self) -> Any:  # noqa: ANN401 - its own kind
        """The complete simulation state."""
        ...

    def restore(self, saved: Any) -> None:  # noqa: ANN401 - as above
        """Go back to what :meth:`snapshot` gave."""
        ...


class StateEnvironment(ABC):
    """Grounds a native state, writes proposals to its ``qpos``, and verifies; a world adds its native judge."""

    judge: str = "native"

    def __init__(self, native: NativeState, scene: Scene, required: RequiredABox, schema: Schema) -> None:
        """Resolve the required facts in ``scene``, the index of the native model.

        Raises:
            OntoError: ``SIM001`` ff., where a fact names what the scene lacks.
        """
        self._native = native
        self._goal = required
        self._scene = scene
        self._grounder = SimGrounder(scene, required.facts, schema)
        self._premise = SimGrounder(scene, required.premise, schema)
        self._scratch = mujoco.MjData(native.model)
        self._before: Any = None  # the state that the last proposal changed

    @abstractmethod
    def verify_natively(self) -> Verification:
        """The verdict of the simulator; raises ``SIM018`` if it cannot judge the goal."""

    def verify(self) -> Verification:
        """The judge's verdict; raises as :meth:`verify_natively` if the judge is the simulator."""
        if self.judge == "grounding":
            return Verification(GROUNDED, not unmet(self._goal, self.observe()))
        return self.verify_natively()

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled scene."""
        return self._native.model

    def textured(self) -> mujoco.MjModel:
        """The scene as pictures of its states need it."""
        return self.model

    @property
    def data(self) -> mujoco.MjData:
        """The live state."""
        return self._native.data

    @property
    def scene(self) -> Scene:
        """The index of the task's model."""
        return self._scene

    @property
    def qpos(self) -> NDArray[np.float64]:
        """A copy of the generalised positions, shape (nq,)."""
        return np.array(self._native.data.qpos)

    @property
    def qvel(self) -> NDArray[np.float64]:
        """A copy of the generalised velocities, shape (nv,)."""
        return np.array(self._native.data.qvel)

    def place(self, model: str) -> None:
        """Refuse: in this world only the seed places the fixtures."""
        message, hint = "a model file places nothing in the world of this task", "leave out --model"
        raise OntoError.of("SIM023", message, hint, model)

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """Nothing: in this world a flat state is complete."""
        return ()

    def observe(self) -> Observation:
        """The observed ABox of the goal."""
        return self._grounder.observe(self._native.data)

    def observe_premise(self) -> Observation:
        """The observed ABox of the task's declared initial facts."""
        return self._premise.observe(self._native.data)

    def observe_at(self, qpos: NDArray[np.float64]) -> Observation:
        """The observed ABox of the goal if ``qpos`` were written; the live state stays as it is."""
        self._scratch.qpos[:] = qpos
        self._scratch.qvel[:] = 0.0
        mujoco.mj_forward(self._native.model, self._scratch)
        return self._grounder.observe(self._scratch)

    def apply(self, proposal: Proposal) -> Application:
        """Write the proposal's ``qpos`` and nothing else; on a fault the state before is restored.

        Raises:
            RunFault: where the proposal, or the state that it leads to, is not finite or not of this scene.
        """
        native = self._native
        before = self._before = native.snapshot()
        start = self.qpos
        try:
            native.write_qpos(proposal.qpos)
            sound = np.isfinite(native.data.qacc).all() and not native.diverged
            fault = "" if sound else "the written state's accelerations are not finite"
        except (OntoError, mujoco.FatalError) as error:
            fault = str(error)
        if fault:
            native.restore(before)
            raise RunFault(fault)
        return Application(proposal, "state", float(np.linalg.norm(proposal.qpos - start)))

    def settle(self, verification: Verification) -> Verification:
        """Verify again after :data:`SETTLE_STEPS` steps.

        If it is still accepted, the verified state is restored; otherwise the settled state is kept, or the state
        before the last proposal is restored if it diverged.
        """
        native = self._native
        verified = native.snapshot()
        native.settle(SETTLE_STEPS)
        # After a divergence MuJoCo resets to the default pose: qpos is finite, but meaningless for the task.
        diverged = native.diverged
        settled = not diverged and self.verify().outcome
        if settled:
            native.restore(verified)
        elif diverged:
            native.restore(self._before or verified)
        return replace(verification, settled=settled, settle_steps=SETTLE_STEPS)
