"""robosuite's own tasks: single-arm manipulation, judged by ``_check_success``."""

from __future__ import annotations

from runtime.worlds.environments import register

__all__ = ["ROBOSUITE"]

ROBOSUITE = "onto/Robosuite-v0"
"""The id in Gymnasium; see :class:`runtime.worlds.robosuite.gym.RobosuiteEnv` for what it takes."""

register(ROBOSUITE, "runtime.worlds.robosuite.gym:RobosuiteEnv")
