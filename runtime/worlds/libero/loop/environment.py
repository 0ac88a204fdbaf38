"""A native LIBERO task as the loop's environment: grounded by us, written in ``state`` mode, judged by LIBERO."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.faults import RunFault
from runtime.loop.records import Application, Proposal, Verification
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.libero.simulator.native_import import predicate_names
from runtime.worlds.libero.simulator.snapshot import Snapshot

__all__ = ["SETTLE_STEPS", "NativeEnvironment"]

SETTLE_STEPS = 20  # control steps of 1/20 s without motion, after which an accepted state is asked again
_QUERY = "check_success()"
_ATOMS = "_eval_predicate() of each atom"  # of a goal with connectives or quantifiers, which LIBERO's check lacks


class NativeEnvironment:
    """The loop's :class:`~runtime.loop.correction.Environment` over a :class:`NativeTask`; proposals write ``qpos``."""

    def __init__(self, task: NativeTask, required: RequiredABox, schema: Schema) -> None:
        """Resolve the required facts in the task's scene.

        Raises:
            OntoError: ``SIM001`` ff., where a fact names what the scene lacks.
        """
        self._task = task
        self._required = required
        self._scene = Scene(task.model)
        self._grounder = SimGrounder(self._scene, required.facts, schema)
        self._premise = SimGrounder(self._scene, required.premise, schema)
        self._scratch = mujoco.MjData(task.model)
        self._before: Snapshot | None = None  # the state that the last proposal changed

    @property
    def scene(self) -> Scene:
        """The index of the task's model."""
        return self._scene

    @property
    def qpos(self) -> NDArray[np.float64]:
        """A copy of the generalised positions, shape (nq,)."""
        return np.array(self._task.data.qpos)

    @property
    def qvel(self) -> NDArray[np.float64]:
        """A copy of the generalised velocities, shape (nv,)."""
        return np.array(self._task.data.qvel)

    def observe(self) -> Observation:
        """The observed ABox of the goal."""
        return self._grounder.observe(self._task.data)

    def observe_premise(self) -> Observation:
        """The observed ABox of the task's declared initial facts."""
        return self._premise.observe(self._task.data)

    def observe_at(self, qpos: NDArray[np.float64]) -> Observation:
        """The observed ABox of the goal if ``qpos`` were written; the live state stays as it is."""
        self._scratch.qpos[:] = qpos
        self._scratch.qvel[:] = 0.0
        mujoco.mj_forward(self._task.model, self._scratch)
        return self._grounder.observe(self._scratch)

    def apply(self, proposal: Proposal) -> Application:
        """Write the proposal's ``qpos`` and nothing else; on a fault the state before is restored.

        Raises:
            RunFault: where the proposal, or the state that it leads to, is not finite or not of this scene.
        """
        before = self._before = self._task.snapshot()
        start = self.qpos
        try:
            self._task.write_qpos(proposal.qpos)
            sound = np.isfinite(self._task.data.qacc).all() and not self._task.diverged
            fault = "" if sound else "the written state's accelerations are not finite"
        except (OntoError, mujoco.FatalError) as error:
            fault = str(error)
        if fault:
            self._task.restore(before)
            raise RunFault(fault)
        return Application(proposal, "state", float(np.linalg.norm(proposal.qpos - start)))

    @property
    def judged(self) -> bool:
        """Whether LIBERO can judge the goal: whole, or else each atom that it is made of."""
        known = predicate_names()
        return self._task.judged or all(fact.native.predicate.lower() in known for fact in self._required.facts)

    def verify(self) -> Verification:
        """Ask LIBERO; raises ``SIM018`` where it can judge neither the goal nor its atoms."""
        return Verification(_QUERY if self._task.judged else _ATOMS, self._success())

    def settle(self, verification: Verification) -> Verification:
        """Ask LIBERO again after :data:`SETTLE_STEPS` steps.

        Where it still accepts, the state is afterwards the one that was verified; otherwise the one that it settled to.
        A state that diverges is given up for the one before the last proposal.
        """
        verified = self._task.snapshot()
        self._task.settle(SETTLE_STEPS)
        # MuJoCo answers a divergence with the default pose: qpos is finite then, and says nothing of the task.
        diverged = self._task.diverged
        settled = not diverged and self._success()
        if settled:
            self._task.restore(verified)
        elif diverged:
            self._task.restore(self._before or verified)
        return replace(verification, settled=settled, settle_steps=SETTLE_STEPS)

    def _success(self) -> bool:
        """LIBERO's verdict on the goal, or on some alternative, each of whose atoms LIBERO is asked for."""
        if self._task.judged or not self.judged:
            return self._task.success()
        facts = self._required.facts
        ways = ([facts[index] for index in way] for way in self._required.ways)
        return any(all(self._task.evaluate(fact.native) is fact.polarity for fact in way) for way in ways)
