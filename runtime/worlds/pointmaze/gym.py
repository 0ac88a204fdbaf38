"""PointMaze as a Gymnasium environment.

Importing this module registers ``onto/PointMaze-v0``, which
``gymnasium.make("runtime.worlds.pointmaze.gym:onto/PointMaze-v0")`` does first.
"""

from __future__ import annotations

import gymnasium

__all__ = ["POINT_MAZE"]

POINT_MAZE = "onto/PointMaze-v0"
"""The id; see :class:`runtime.worlds.pointmaze.environment.PointMazeEnv` for what it takes."""

# The environment truncates itself and needs no wrapper.
if POINT_MAZE not in gymnasium.registry:
    gymnasium.register(POINT_MAZE, entry_point="runtime.worlds.pointmaze.environment:PointMazeEnv")
