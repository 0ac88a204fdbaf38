"""The motion of the ball where it touches no wall, in closed form: MuJoCo's own arithmetic, without MuJoCo.

Away from walls only the motors and the joints' damping act on the ball; MuJoCo's Euler integrator applies the damping
at the end of a step (``mj_Euler`` with ``eulerdamp``): ``v' = v + h (F - d v) / (m + h d)``, ``x' = x + h v'``. The
plane under the ball pushes along z, where there is no joint. The operations are in MuJoCo's order, and the results are
identical bit for bit, as a test checks.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.jit import compiled
from runtime.worlds.pointmaze.maze import FRAME_SKIP, RADIUS, Maze

__all__ = ["FreeMotion"]

_NEAR = 0.01
"""Within this of a wall, metres, MuJoCo decides: its contacts begin at a margin of 0.002."""


class FreeMotion:
    """Environment steps of ``maze`` that touch nothing."""

    def __init__(self, maze: Maze) -> None:
        model = maze.model
        mass = np.zeros((model.nv, model.nv))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, mass, data.qM)
        step, damping = model.opt.timestep, model.dof_damping[0]
        self._numbers = (step, damping, model.actuator_gear[0, 0], 1.0 / (mass[0, 0] + step * damping))
        self._walls = np.ascontiguousarray(maze.wall_boxes)

    def step(
        self, states: NDArray[np.float64], actions: NDArray[np.float64], following: NDArray[np.float64]
    ) -> NDArray[np.intp]:
        """Write the states (B, 4) one environment step later to ``following``; return the rows that need MuJoCo.

        These came near a wall on the way, and their rows of ``following`` mean nothing. Velocities and actions are
        clipped already.
        """
        near_wall = np.zeros(len(states), dtype=np.bool_)
        _free_steps(states, actions, self._walls, *self._numbers, following, near_wall)
        return np.flatnonzero(near_wall)


@compiled
def _free_steps(
    states: NDArray[np.float64],
    actions: NDArray[np.float64],
    walls: NDArray[np.float64],
    step: float,
    damping: float,
    gear: float,
    inverse: float,
    following: NDArray[np.float64],
    near_wall: NDArray[np.bool_],
) -> None:
    near = (RADIUS + _NEAR) ** 2
    for row in range(states.shape[0]):
        x, y, vx, vy = states[row]
        for _ in range(FRAME_SKIP):
            for wall in range(walls.shape[0]):
                dx = max(walls[wall, 0] - x, x - walls[wall, 2], 0.0)
                dy = max(walls[wall, 1] - y, y - walls[wall, 3], 0.0)
                if dx * dx + dy * dy < near:
                    near_wall[row] = True
                    break
            if near_wall[row]:
                break
            vx = vx + step * ((-damping * vx + gear * actions[row, 0]) * inverse)
            vy = vy + step * ((-damping * vy + gear * actions[row, 1]) * inverse)
            x = x + step * vx
            y = y + step * vy
        following[row, 0] = x
        following[row, 1] = y
        following[row, 2] = vx
        following[row, 3] = vy
