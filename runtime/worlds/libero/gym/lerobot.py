"""Observations in the shape that LeRobot's own LIBERO environment gives, for policies and scripts that expect it.

Source: huggingface/lerobot ``src/lerobot/envs/libero.py`` (``obs_type="pixels_agent_pos"``).
"""

from __future__ import annotations

from typing import Any, cast

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.libero.gym.environment import LiberoEnv, Observed

__all__ = ["LeRobotView"]

_PIXELS = {"agentview_image": "image", "robot0_eye_in_hand_image": "image2"}
_STATE = {
    "robot0_eef_pos": ("eef", "pos"),
    "robot0_eef_quat": ("eef", "quat"),
    "robot0_gripper_qpos": ("gripper", "qpos"),
    "robot0_gripper_qvel": ("gripper", "qvel"),
    "robot0_joint_pos": ("joints", "pos"),
    "robot0_joint_vel": ("joints", "vel"),
}

Nested = dict[str, Any]


class LeRobotView(gymnasium.ObservationWrapper[Nested, NDArray[np.float32], Observed]):
    """``pixels`` (``image``, ``image2``) and ``robot_state`` (``eef``, ``gripper``, ``joints``) of a LIBERO task.

    ``eef`` holds a rotation matrix ``mat`` too: the controller's, which is the grip site's at the last substep.
    """

    def __init__(self, env: gymnasium.Env[Observed, NDArray[np.float32]]) -> None:
        """Wrap ``env``; raises ``SIM030`` if it lacks the pictures or a part of the state."""
        super().__init__(env)
        if not isinstance(env.unwrapped, LiberoEnv):
            raise OntoError.of("SIM030", f"{env.unwrapped} is not a LIBERO environment", "wrap onto/Libero-v0")
        self._libero = env.unwrapped
        known = cast("spaces.Dict", env.observation_space).spaces
        missing = [key for key in (*_PIXELS, *_STATE) if key not in known]
        if missing:
            hint = "make it with images=True, both cameras and all observables"
            raise OntoError.of("SIM030", f"LeRobot observes `{missing[0]}`, and this environment does not", hint)
        state: dict[str, dict[str, spaces.Space[Any]]] = {}
        for key, (part, name) in _STATE.items():
            state.setdefault(part, {})[name] = known[key]
        state["eef"]["mat"] = spaces.Box(-np.inf, np.inf, (3, 3), np.float64)
        pixels = {name: known[key] for key, name in _PIXELS.items()}
        parts: dict[str, spaces.Space[Any]] = {part: spaces.Dict(below) for part, below in state.items()}
        self.observation_space = cast(
            "spaces.Space[Nested]", spaces.Dict({"pixels": spaces.Dict(pixels), "robot_state": spaces.Dict(parts)})
        )

    @property
    def task_description(self) -> str:
        """The instruction, under the name by which LeRobot asks a vector environment for it."""
        return self._libero.language

    @property
    def _max_episode_steps(self) -> int:
        """LeRobot reads the horizon here."""
        return self._libero.horizon

    def observation(self, observation: Observed) -> Nested:
        """The same arrays, nested."""
        state: dict[str, dict[str, NDArray[Any]]] = {}
        for key, (part, name) in _STATE.items():
            state.setdefault(part, {})[name] = observation[key]
        simulation = self._libero.simulation
        state["eef"]["mat"] = simulation.data.site_xmat[simulation.scene.arm.site].reshape(3, 3).copy()
        return {"pixels": {name: observation[key] for key, name in _PIXELS.items()}, "robot_state": state}
