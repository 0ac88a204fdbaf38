"""The true dynamics of a maze for many states at once, for training data and the planner on the true dynamics.

One environment step clips each velocity to :data:`~runtime.worlds.pointmaze.maze.MAX_SPEED`, holds a force for
:data:`~runtime.worlds.pointmaze.maze.FRAME_SKIP` steps of MuJoCo, and is a function of state and action alone: the
solver starts cold at each environment step, so that a rollout of ten steps is one of five and then another of five.
Where the ball is near no wall the step is written out (:mod:`runtime.worlds.pointmaze.free_motion`); MuJoCo takes the
others.
"""

from __future__ import annotations

import mujoco
import numpy as np
from mujoco import rollout as batched
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.free_motion import FreeMotion
from runtime.worlds.pointmaze.maze import ACTION_DIM, FRAME_SKIP, MAX_SPEED, STATE_DIM, Maze

__all__ = ["Rollout", "checked_actions", "checked_states"]

_LIMIT = 1e9
"""MuJoCo resets a simulation whose numbers reach ten times this."""


class Rollout:
    """Rolls actions out from states of ``maze`` on ``threads`` threads; the result does not depend on their number."""

    def __init__(self, maze: Maze, threads: int = 1) -> None:
        self.maze = maze
        self._model = maze.model
        self._coasting = FreeMotion(maze)
        self._data = [mujoco.MjData(self._model) for _ in range(max(threads, 1))]
        self._pool = batched.Rollout(nthread=threads if threads > 1 else 0)

    def states(self, state: NDArray[np.floating], actions: NDArray[np.floating]) -> NDArray[np.float64]:
        """The states that follow: ``state`` (B, 4) or (4,) and ``actions`` (B, T, 2) give (B, T + 1, 4).

        Actions are clipped to [-1, 1]. Raises ``OntoError`` PMZ003 for other shapes and PMZ004 for numbers that are
        not finite, before anything is run.
        """
        given = checked_actions(actions)
        starts = checked_states(state)
        if starts.ndim == 1:
            starts = np.broadcast_to(starts, (len(given), STATE_DIM))
        if starts.shape != (len(given), STATE_DIM):
            raise _shape(f"{starts.shape} states for {len(given)} rows of actions", "(B, 4) for actions of (B, T, 2)")
        return self._run(starts, np.clip(given, -1.0, 1.0))

    def _run(self, starts: NDArray[np.float64], actions: NDArray[np.float64]) -> NDArray[np.float64]:
        rows, steps = actions.shape[:2]
        found = np.empty((rows, steps + 1, STATE_DIM))
        found[:, 0] = starts
        begin, following = np.empty((rows, STATE_DIM)), np.empty((rows, STATE_DIM))
        for step in range(steps):
            begin[:, :2] = found[:, step, :2]
            np.clip(found[:, step, 2:], -MAX_SPEED, MAX_SPEED, out=begin[:, 2:])
            touching = self._coasting.step(begin, actions[:, step], following)
            if len(touching):
                following[touching] = self._simulated(begin[touching], actions[touching, step])
            found[:, step + 1] = following
        return found

    def _simulated(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> NDArray[np.float64]:
        """One environment step of MuJoCo from ``states`` (B, 4) with ``actions`` (B, 2), both clipped already."""
        rows = len(states)
        begin = np.concatenate([np.zeros((rows, 1)), states], axis=1)  # time, then qpos and qvel
        held = np.repeat(actions[:, None], FRAME_SKIP, axis=1)
        out = np.empty((rows, FRAME_SKIP, begin.shape[1]))
        models = [self._model] * rows
        self._pool.rollout(models, self._data, begin, held, nstep=FRAME_SKIP, state=out, skip_checks=True)
        return out[:, -1, 1:]


def checked_states(state: NDArray[np.floating]) -> NDArray[np.float64]:
    """``state`` (..., 4) in float64; raises ``OntoError`` PMZ003 for another shape, PMZ004 for what is not finite."""
    return _checked(state, STATE_DIM, "states", "(..., 4): x, y, vx, vy")


def checked_actions(actions: NDArray[np.floating]) -> NDArray[np.float64]:
    """``actions`` (B, T, 2) in float64; raises ``OntoError`` PMZ003 for another shape, PMZ004 for what is no number."""
    found = _checked(actions, ACTION_DIM, "actions", "(B, T, 2)")
    if found.ndim != 3:
        raise _shape(f"actions of shape {found.shape}", "(B, T, 2)")
    return found


def _checked(given: NDArray[np.floating], width: int, what: str, expected: str) -> NDArray[np.float64]:
    try:
        found = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise _shape(f"{what} that are no array of numbers", expected) from None
    if found.ndim < 1 or found.shape[-1] != width:
        raise _shape(f"{what} of shape {found.shape}", expected)
    usable = np.abs(found) < _LIMIT
    if not usable.all():
        bad = int(np.count_nonzero(~usable))
        raise OntoError.of(
            "PMZ004", f"{bad} of {found.size} numbers in the {what} are not finite", f"expected {what} {expected}"
        )
    return found


def _shape(found: str, expected: str) -> OntoError:
    return OntoError.of("PMZ003", f"found {found}", f"expected {expected}")
