"""What a demonstration is, and the file that holds those of one task."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from runtime.worlds.snapshot import Snapshot

__all__ = ["IMAGES", "PROPRIO", "DemoFile", "Demonstration", "Origin"]

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
    ``start`` is the whole state before the first action, from which a replay is exact; LIBERO's own files lack it, and
    some derived from them lack ``robot_states`` (n, 9) and ``model_file`` too.
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

    def __len__(self) -> int:
        return len(self.actions)


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
