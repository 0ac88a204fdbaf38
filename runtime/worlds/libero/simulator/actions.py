"""An action of LIBERO: OSC_POSE's six numbers and one for the gripper."""

from __future__ import annotations

__all__ = ["ACTION_SIZE", "DUMMY_ACTION"]

ACTION_SIZE = 7
DUMMY_ACTION = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0)  # no motion, gripper open
"""The action with which LIBERO's evaluations let a scene settle."""
