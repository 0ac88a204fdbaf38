"""LIBERO tasks as Gymnasium environments: importing this package registers ``onto/Libero-v0``.

Gymnasium 1.x loads no plugins by itself. ``gymnasium.make("onto_evwm:onto/Libero-v0", task="libero_goal/8")`` imports
``onto_evwm`` first, which has this package imported; from then on the id alone will do.
"""

from __future__ import annotations

import gymnasium

__all__ = ["LIBERO"]

LIBERO = "onto/Libero-v0"
"""The id; see :class:`runtime.worlds.libero.gym.environment.LiberoEnv` for what it takes."""

# The horizon differs by suite, so that the environment truncates itself and needs no wrapper.
if LIBERO not in gymnasium.registry:
    gymnasium.register(LIBERO, entry_point="runtime.worlds.libero.gym.environment:LiberoEnv")
