"""Which facts hold in a state whose contacts may be old, without a change to the simulation."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.sim import SimGrounder
from onto_compiler.required import Fact
from runtime.loop.diagnosis import satisfied

__all__ = ["ForwardedFacts"]


class ForwardedFacts:
    """Asks which facts of ``grounder`` hold; after a step, contacts and sites are those of one substep before."""

    def __init__(self, grounder: SimGrounder) -> None:
        self.facts: tuple[Fact, ...] = grounder.facts
        self._grounder, self._model = grounder, grounder.scene.model
        self._forwarded = mujoco.MjData(self._model)  # to forward the simulation's own would move its warm start

    def __call__(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        """Which facts hold at the positions of ``data``; shape (k,). Raises as :meth:`SimGrounder.observe`."""
        forwarded = self._forwarded
        forwarded.qpos[:], forwarded.qvel[:] = data.qpos, data.qvel
        mujoco.mj_forward(self._model, forwarded)
        return satisfied(self.facts, self._grounder.observe(forwarded))
