"""PointMaze as a Gymnasium environment: importing this module, as ``onto_evwm`` does, registers its id."""

from __future__ import annotations

from runtime.worlds.environments import register

__all__ = ["POINT_MAZE"]

POINT_MAZE = "onto/PointMaze-v0"
"""The id; see :class:`runtime.worlds.pointmaze.environment.PointMazeEnv` for what it takes."""

register(POINT_MAZE, "runtime.worlds.pointmaze.environment:PointMazeEnv")
