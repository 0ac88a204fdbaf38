"""What a demonstration is, and the file that holds those of one task."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.hidden import HiddenStates
from runtime.worlds.snapshot import Snapshot

__all__ = ["IMAGES", "PROPRIO", "DemoFile", "Demonstration", "Origin", "lacking"]

PROPRIO = ("ee_ori", "ee_pos", "ee_states", "gripper_states", "joint_states")
IMAGES = {"agentview_rgb": "agentview", "eye_in_hand_rgb": "robot0_eye_in_hand"}
"""LIBERO's keys below ``obs``, and the cameras that they show."""


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """The origin of one of our demonstrations.

    ``success_step`` counts actions until the native predicate is first true. ``intended`` (n, 7) are the skill's
    actions before noise, pushes and slips; ``disturbances`` lists these, ``tries`` the skills and how each ended.
    """

    trial: int
    seed: int
    state_index: int
    success_step: int
    severity: float
    disturbances: tuple[Mapping[str, Any], ...]
    tries: tuple[Mapping[str, Any], ...]
    intended: NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Demonstration:
    """``n`` control steps of 1/20 s.

    ``states`` (n, 1 + nq + nv) is LIBERO's flat state before each action, ``actions`` (n, 7) are OSC_POSE's in [-1, 1],
    ``obs`` is what was observed, by LIBERO's key, (n, ...); ``rewards`` and ``dones`` (n,) are 1 at the end.
    ``pictures`` are the keys of all pictures in the file, read or not.
    ``start`` is the whole state before the first action, from which a replay is exact, and ``hidden`` is what the flat
    states leave out before every one. ``truth`` (n, k) says which of ``facts``, those of the goal in the order of the
    required ABox, hold in the state after each action. LIBERO's own files lack these, and some derived from them lack
    ``robot_states`` (n, 9) and ``model_file`` too.
    """

    name: str
    states: NDArray[Any]
    actions: NDArray[Any]
    rewards: NDArray[Any]
    dones: NDArray[Any]
    obs: Mapping[str, NDArray[Any]]
    robot_states: NDArray[Any] | None
    init_state: NDArray[Any]
    model_file: str = ""
    pictures: tuple[str, ...] = ()
    start: Snapshot | None = None
    origin: Origin | None = None
    hidden: HiddenStates | None = None
    truth: NDArray[np.bool_] | None = None
    facts: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.actions)

    @property
    def onset(self) -> int | None:
        """After how many actions all facts hold and stay true to the end, at least 1.

        None if they do not hold at the end, or nothing is recorded of them. It may be later than the first success.
        """
        if self.truth is None or not self.truth[-1].all():
            return None
        undone = np.flatnonzero(~self.truth.all(axis=1))
        return int(undone[-1]) + 2 if undone.size else 1

    def snapshot(self, step: int) -> Snapshot:
        """The whole state before action ``step`` (from 0), from which a replay is exact.

        Raises ``DEM007`` without the hidden states, and ``IndexError`` if there is no such step.
        """
        if self.hidden is None or self.start is None:
            raise lacking(self, "hidden state")
        if not 0 <= step < len(self):
            raise IndexError(f"{self.name} has no step {step}: it has {len(self)}")
        return self.hidden.snapshot(step, self.states[step], self.start)


def lacking(demo: Demonstration, what: str, why: str = "", file: str = "") -> OntoError:
    """The error that ``demo`` in ``file`` does not keep ``what`` for each step, and ``why`` that matters."""
    message = f"`{demo.name}` was recorded without the {what} of every step{why}"
    return OntoError.of("DEM007", message, "`onto demos collect` makes demonstrations that keep it", file)


@dataclass(frozen=True, slots=True)
class DemoFile:
    """The demonstrations of one task: ``suite`` and ``task`` name it, as far as the file says.

    ``about`` describes how one of our files was made; it is empty for other files.
    """

    path: str
    suite: str
    task: str
    language: str
    bddl: str
    demos: tuple[Demonstration, ...]
    attributes: Mapping[str, Any] = field(default_factory=dict)
    about: Mapping[str, Any] = field(default_factory=dict)
