"""Whether the gripper has released: some of LIBERO's predicates are true of an object that is still held."""

from __future__ import annotations

import mujoco
import numpy as np

__all__ = ["Released"]

_GRIPPER = "gripper0_"


class Released:
    """Checks in one scene whether the gripper touches a movable object."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Find the geoms of the gripper, and those of bodies on a free joint."""
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
