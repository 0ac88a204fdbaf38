"""A task that is open in its simulator: grounded by us, written in ``state`` mode, judged by the simulator itself."""

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

SETTLE_STEPS = 20  # control steps of 1/20 s without motion, after which an accepted state is asked again


def settling(state: ArrayLike | None, asked: int | None, usual: int) -> int:
    """Control steps without motion before a start is judged: those ``asked`` for, if any.

    An official initial state (None) otherwise takes the world's ``usual`` ones, and one that was given is judged as it
    is.
    """
    if asked is not None:
        return asked
    return usual if state is None else 0


class TaskEnvironment(Environment, Protocol):
    """What a world opens: the loop's environment, and what an episode needs beside it."""

    seed: int
    judge: str
    """Who verifies: "native", the simulator itself, or "grounding", the required facts as they are grounded."""

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
        """Go to initial state ``index``, or to a flat ``state`` (1 + nq + nv: time, qpos, qvel), and let it settle.

        Gives the number of control steps, see :func:`settling`. Raises ``SIM017`` where there is no such initial state,
        ``SIM003``, ``SIM004`` for a state that is none of this scene, ``SIM019`` where it diverges.
        """
        ...

    def place(self, model: str) -> None:
        """From now on start with the fixtures as the file ``model`` has them; raises ``SIM023``."""
        ...

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """The required facts whose verdict in the present state hangs on where fixtures stand, were that unknown."""
        ...

    def versions(self) -> dict[str, str]:
        """Versions of what decides a physical result, for provenance."""
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
        """All that decides what happens next."""
        ...

    def restore(self, saved: Any) -> None:  # noqa: ANN401 - as above
        """Go back to what :meth:`snapshot` gave."""
        ...


class StateEnvironment(ABC):
    """Grounds a native state, writes proposals to its ``qpos``, and asks its judge; a world adds the native one."""

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
        """Ask the simulator's own judge; raises ``SIM018`` where it cannot judge the goal."""

    def verify(self) -> Verification:
        """Ask the judge; raises as :meth:`verify_natively` where that is the simulator."""
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
        """Refuse: in this world the seed alone places what does not move."""
        message, hint = "a model file places nothing in the world of this task", "leave out --model"
        raise OntoError.of("SIM023", message, hint, model)

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """Nothing: a flat state says all there is of such a world."""
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
        """Ask the judge again after :data:`SETTLE_STEPS` steps.

        Where it still accepts, the state is afterwards the one that was verified; otherwise the one that it settled to.
        A state that diverges is given up for the one before the last proposal.
        """
        native = self._native
        verified = native.snapshot()
        native.settle(SETTLE_STEPS)
        # MuJoCo answers a divergence with the default pose: qpos is finite then, and says nothing of the task.
        diverged = native.diverged
        settled = not diverged and self.verify().outcome
        if settled:
            native.restore(verified)
        elif diverged:
            native.restore(self._before or verified)
        return replace(verification, settled=settled, settle_steps=SETTLE_STEPS)
