"""LIBERO's proprioception below its demonstrations' keys, from robosuite's observations.

Sources: LIBERO ``scripts/create_dataset.py`` and ``envs/bddl_base_domain.py`` (``get_robot_state_vector``), robosuite
1.4.0 ``utils/transform_utils.py`` (``quat2axisangle``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["OBSERVED", "axis_angles", "proprioception", "robot_states"]

OBSERVED = ("robot0_eef_pos", "robot0_eef_quat", "robot0_gripper_qpos", "robot0_joint_pos")
Observations = Sequence[Mapping[str, NDArray[Any]]]


def proprioception(observed: Observations) -> dict[str, NDArray[np.float64]]:
    """``ee_pos`` (n, 3) in metres, ``ee_ori`` (n, 3) as a rotation vector, both as ``ee_states`` (n, 6); the joints."""
    position = _stack(observed, "robot0_eef_pos")
    turn = axis_angles(_stack(observed, "robot0_eef_quat"))
    return {
        "ee_ori": turn,
        "ee_pos": position,
        "ee_states": np.concatenate([position, turn], axis=1),
        "gripper_states": _stack(observed, "robot0_gripper_qpos"),
        "joint_states": _stack(observed, "robot0_joint_pos"),
    }


def robot_states(observed: Observations) -> NDArray[np.float64]:
    """Fingers (2), position (3) and quaternion xyzw (4) of the gripper, (n, 9)."""
    keys = ("robot0_gripper_qpos", "robot0_eef_pos", "robot0_eef_quat")
    return np.concatenate([_stack(observed, key) for key in keys], axis=1)


def axis_angles(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation vectors (n, 3), their length in [0, 2 pi], of unit ``quaternions`` (n, 4), xyzw.

    A quaternion and its negative give vectors of different lengths, as in robosuite.
    """
    w = np.clip(quaternions[:, 3:], -1.0, 1.0)
    size = np.sqrt(1.0 - w * w)
    still = size == 0.0
    return np.where(still, 0.0, quaternions[:, :3] * 2.0 * np.arccos(w) / np.where(still, 1.0, size))


def _stack(observed: Observations, key: str) -> NDArray[np.float64]:
    return np.stack([np.asarray(one[key], dtype=np.float64) for one in observed])
