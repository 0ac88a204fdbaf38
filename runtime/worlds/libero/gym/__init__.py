"""LIBERO tasks as Gymnasium environments: importing this package registers ``onto/Libero-v0``.

Gymnasium 1.x loads no plugins by itself. ``gymnasium.make("onto_evwm:onto/Libero-v0", task="libero_goal/8")`` imports
``onto_evwm`` first, which imports this package; from then on the id alone will do.
"""

from __future__ import annotations

from runtime.worlds.environments import register

__all__ = ["LIBERO"]

LIBERO = "onto/Libero-v0"
"""The id; see :class:`runtime.worlds.libero.gym.environment.LiberoEnv` for what it takes."""

register(LIBERO, "runtime.worlds.libero.gym.environment:LiberoEnv")
