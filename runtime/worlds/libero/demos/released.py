"""Whether the gripper has let go: LIBERO's predicates do not ask, and some are true of an object that is still held."""

from __future__ import annotations

import mujoco
import numpy as np

__all__ = ["Released"]

_GRIPPER = "gripper0_"


class Released:
    """Asks of one scene whether the gripper touches anything that can be carried."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Tell the gripper's geoms, and those of bodies on a free joint, from all others."""
        names = (mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or "" for body in range(model.nbody))
        gripper = np.array([name.startswith(_GRIPPER) for name in names])
        free = np.zeros(model.nbody, dtype=np.bool_)
        free[model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE]] = True
        self._gripper = gripper[model.geom_bodyid]
        self._loose = free[model.body_rootid][model.geom_bodyid]

    def __call__(self, data: mujoco.MjData) -> bool:
        """Whether no contact of ``data`` is between the two."""
        pairs = data.contact.geom.reshape(-1, 2)
        first, second = pairs[:, 0], pairs[:, 1]
        held = (self._gripper[first] & self._loose[second]) | (self._gripper[second] & self._loose[first])
        return not held.any()
