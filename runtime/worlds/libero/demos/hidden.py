"""What LIBERO's flat state leaves out, before every action of a demonstration: a replay from any step is exact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.snapshot import Snapshot

__all__ = ["HiddenStates", "hidden_of"]

_MOVING = (
    *("goal_pos", "goal_ori", "new_update", "ee_pos", "ee_ori_mat", "ee_pos_vel", "ee_ori_vel"),
    *("joint_pos", "joint_vel", "J_full", "mass_matrix", "torques"),
)
_TURNS = 3  # the first row of robosuite's ``J_full`` that is of ``J_ori``; those before are ``J_pos``


@dataclass(frozen=True, slots=True, eq=False)
class HiddenStates:
    """The hidden state before each of ``n`` actions; the fixtures' poses, which do not move, are not here.

    ``integration`` (n, r) is MuJoCo's mjSTATE_INTEGRATION vector without time, qpos and qvel, which come first in it:
    the warm start, the controls and what is applied from outside. ``gripper_action`` (n, 2) is the gripper's current
    action. ``controller`` holds what the controller changes, by robosuite's attribute name, each (n, ...): its goal,
    the kinematics that it last read, and ``new_update``, whether it reads them again before the next step.
    """

    integration: NDArray[np.float64]
    gripper_action: NDArray[np.float64]
    controller: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        return len(self.integration)

    def snapshot(self, step: int, state: NDArray[np.float64], start: Snapshot) -> Snapshot:
        """The whole state before action ``step``, whose flat state is ``state`` (1 + nq + nv,).

        ``start`` is the one before the first action: it gives all that never changes.
        """
        held = {name: _value(values[step]) for name, values in self.controller.items()}
        held |= {"J_pos": held["J_full"][:_TURNS].copy(), "J_ori": held["J_full"][_TURNS:].copy()}
        steps = start.clock[0] + step
        return replace(
            start,
            integration=np.concatenate([state, self.integration[step]]),
            gripper_action=self.gripper_action[step].copy(),
            controller={**start.controller, **held},
            clock=(steps, steps / 20, False),
        )

    def checked(self, states: NDArray[np.float64], start: Snapshot) -> HiddenStates:
        """The same; raises ``ValueError`` unless it fits the flat ``states`` (n, 1 + nq + nv) after ``start``."""
        steps, flat = states.shape
        arrays = {"integration": self.integration, "gripper_action": self.gripper_action, **self.controller}
        first = {
            "integration": start.integration[flat:],
            "gripper_action": start.gripper_action,
            **{name: np.asarray(start.controller[name]) for name in _MOVING},
        }
        if missing := sorted(first.keys() - arrays.keys()):
            raise ValueError(f"the hidden states have no `{missing[0]}`")
        for name, values in arrays.items():
            wanted = (steps, *first[name].shape) if name in first else None
            if values.shape != wanted:
                raise ValueError(f"the hidden `{name}` has the shape {values.shape}, not {wanted}")
            if not np.isfinite(values).all():
                raise ValueError(f"the hidden `{name}` holds a number that is not finite")
        return self


def hidden_of(snapshots: Sequence[Snapshot], flat: int) -> HiddenStates:
    """The hidden states of ``snapshots``, one or more, whose flat states have ``flat`` numbers."""
    return HiddenStates(
        np.stack([one.integration[flat:] for one in snapshots]),
        np.stack([one.gripper_action for one in snapshots]),
        {name: np.stack([np.asarray(one.controller[name]) for one in snapshots]) for name in _MOVING},
    )


def _value(held: Any) -> Any:  # noqa: ANN401  an array, or one number or truth value of numpy's
    return held.copy() if isinstance(held, np.ndarray) else held.item()
