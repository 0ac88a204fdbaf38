"""Flat states (time, qpos, qvel), validated before writing: finite, and possible in this scene."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from onto_compiler.problems import OntoError

__all__ = ["FlatStates", "write_qpos"]

UNIT = 0.01  # how far the length of a pose's quaternion may be from 1
_HINT = "take the initial states of the same task and version of its simulator"


class FlatStates:
    """The flat states of ``model``; ``task`` names it in messages."""

    def __init__(self, model: mujoco.MjModel, task: str) -> None:
        """Store the addresses of the free joints' quaternions."""
        free = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
        self._task, self._model = task, model
        self._joints = free
        self._quaternions = 1 + model.jnt_qposadr[free][:, None] + np.arange(3, 7)
        self.size = int(1 + model.nq + model.nv)

    def checked(self, state: ArrayLike) -> NDArray[np.float64]:
        """``state`` as an array (1 + nq + nv,) of its own.

        Raises ``SIM004`` if it is another scene's: of another length, or with numbers in the place of a free body's
        quaternion that are none; ``SIM003`` if it is not finite.
        """
        flat = np.array(state, dtype=np.float64).ravel()
        if flat.size != self.size:
            message = f"the initial state has {flat.size} numbers, the scene of `{self._task}` needs {self.size}"
            raise OntoError.of("SIM004", message, _HINT)
        if not np.isfinite(flat).all():
            raise OntoError.of("SIM003", f"the initial state is not finite at {int(np.argmin(np.isfinite(flat)))}")
        quaternions = flat[self._quaternions]
        off = np.abs(np.einsum("ij,ij->i", quaternions, quaternions) - 1.0) > 2.0 * UNIT
        if off.any():
            joint = self._model.joint(int(self._joints[np.argmax(off)])).name
            message = f"the initial state has no orientation for `{joint}` of `{self._task}`: it is another scene's"
            raise OntoError.of("SIM004", message, _HINT)
        return flat


def write_qpos(model: mujoco.MjModel, data: mujoco.MjData, qpos: ArrayLike, task: str, *, still: bool = True) -> None:
    """Write ``qpos`` (nq,) to ``data`` and recompute what follows from it; ``task`` names the scene in messages.

    ``still`` zeroes the velocity of the joints that it changes. Raises ``SIM004`` if it is another scene's, and
    ``SIM003`` if it is not finite.
    """
    new = np.array(qpos, dtype=np.float64).ravel()
    if new.size != model.nq:
        raise OntoError.of("SIM004", f"qpos has {new.size} numbers, the scene of `{task}` needs {model.nq}")
    if not np.isfinite(new).all():
        raise OntoError.of("SIM003", f"qpos is not finite at {int(np.argmin(np.isfinite(new)))}")
    if still:
        changed = np.flatnonzero(new != data.qpos)
        for joint in np.unique(np.searchsorted(model.jnt_qposadr, changed, side="right") - 1):
            stop = model.jnt_dofadr[joint + 1] if joint + 1 < model.njnt else model.nv
            data.qvel[model.jnt_dofadr[joint] : stop] = 0.0
    data.qpos[:] = new
    mujoco.mj_forward(model, data)
