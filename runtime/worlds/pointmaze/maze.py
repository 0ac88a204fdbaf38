"""Mazes of walls and free cells, and the point mass that is driven through one: DINO-WM's PointMaze as MJCF.

The numbers are upstream's (``env/pointmaze/maze_model.py`` of DINO-WM, after D4RL's ``maze2d``): a sphere on two
slides, force-driven, on a plane without gravity. A state is ``(x, y, vx, vy)``, the joints' positions and velocities:
metres from where the ball's body stands in the model, (1.2, 1.2), and metres per second. Cell ``(i, j)`` of a layout,
row and column, is therefore the square around ``(i - 0.2, j - 0.2)``, and x runs along the rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.predicates.planar import clearance
from onto_compiler.problems import OntoError, near

__all__ = [
    "ACTION_DIM",
    "BALL",
    "FRAME_SKIP",
    "MACRO_STEPS",
    "MAX_SPEED",
    "MAZES",
    "RADIUS",
    "STATE_DIM",
    "SUCCESS_RADIUS",
    "TARGET",
    "TIME_STEP",
    "WALL",
    "Maze",
    "maze_named",
]

STATE_DIM = 4
ACTION_DIM = 2
TIME_STEP = 0.01
"""Seconds of one step of MuJoCo."""
FRAME_SKIP = 5
"""Steps of MuJoCo in one environment step."""
MACRO_STEPS = 5
"""Environment steps in one macro step, the world models' step."""
RADIUS = 0.1
"""Of the ball, metres."""
MAX_SPEED = 5.0
"""To which each velocity is clipped before an environment step, metres per second."""
SUCCESS_RADIUS = 0.5
"""A trial succeeds when the ball is nearer than this to the goal, metres."""
BALL, TARGET, WALL = "ball", "target", "wall"
"""The names of a maze's objects in task files; the body of each is ``NAME_main``, as in LIBERO's scenes."""

_ORIGIN = 1.2
"""Where the ball's body stands in the world, in x and in y: what a state's position is counted from."""
_HALF = 0.5
_GEAR = 100
_WALLS, _FREE = "#", "OG "


@dataclass(frozen=True)
class Maze:
    """A layout: ``rows`` of equal length, ``#`` a wall, ``O`` free, ``G`` free and the layout's own goal.

    Raises ``OntoError`` PMZ001 where rows differ in length, hold another letter, or leave no cell free.
    """

    name: str
    rows: tuple[str, ...]

    def __post_init__(self) -> None:
        letters = set("".join(self.rows))
        uneven = len({len(row) for row in self.rows}) != 1
        if uneven or letters - set(_WALLS + _FREE) or not letters & set(_FREE):
            message = f"the maze `{self.name}` is not a layout of rows of `#` and `O` of equal length"
            raise OntoError.of("PMZ001", message, "`#` is a wall, `O` is free, `G` is free and the goal; see `MAZES`")

    @cached_property
    def cells(self) -> NDArray[np.int64]:
        """(K, 2): row and column of each free cell, in order."""
        places = ((i, j) for i, row in enumerate(self.rows) for j, letter in enumerate(row) if letter in _FREE)
        return np.array(list(places), dtype=np.int64)

    @cached_property
    def centres(self) -> NDArray[np.float64]:
        """(K, 2): the middles of the free cells, in the coordinates of a state."""
        return centre(self.cells)

    @cached_property
    def free_boxes(self) -> NDArray[np.float64]:
        """(K, 4): x and y of the low corner, then of the high corner, of each free cell."""
        return _boxes(self.cells)

    @cached_property
    def wall_boxes(self) -> NDArray[np.float64]:
        """(W, 4): as :attr:`free_boxes`, of each wall."""
        return _boxes(self.walls)

    @cached_property
    def walls(self) -> NDArray[np.int64]:
        """(W, 2): row and column of each wall, in order."""
        places = ((i, j) for i, row in enumerate(self.rows) for j, letter in enumerate(row) if letter in _WALLS)
        return np.array(list(places), dtype=np.int64).reshape(-1, 2)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """The low and the high corner of the whole layout: x, y, x, y."""
        low, high = centre(np.array([[0, 0]])), centre(np.array([[len(self.rows) - 1, len(self.rows[0]) - 1]]))
        return (*(low[0] - _HALF).tolist(), *(high[0] + _HALF).tolist())

    def clearance(self, xy: NDArray[np.floating]) -> NDArray[np.float64]:
        """Signed distance of the ball's surface to the nearest wall, metres: (..., 2) or states (..., 4) to (...).

        Negative where the ball overlaps a wall; what lies outside of the layout is wall. Exact on both sides: a
        centre in a wall is as far from free space as it is.
        """
        points = np.asarray(xy, dtype=np.float64)[..., :2]
        to_free = _distance(points, self.free_boxes)
        to_wall = np.minimum(_distance(points, self.wall_boxes), _depth(points, self.extent))
        return np.where(to_free > 0, -to_free, to_wall) - RADIUS

    def free(self, xy: NDArray[np.floating], clearance: float = 0.0) -> NDArray[np.bool_]:
        """Whether the ball has at least ``clearance`` metres between its surface and every wall: (..., 2) to (...)."""
        return self.clearance(xy) >= clearance

    def mjcf(self) -> str:
        """The model as XML."""
        walls = "\n".join(
            f'      <geom name="wall_{i}_{j}" type="box" pos="{i + 1} {j + 1} 0" size="{_HALF} {_HALF} 0.2" '
            f'rgba="0.7 0.5 0.3 1"/>'
            for i, j in self.walls.tolist()
        )
        return _MJCF.format(
            name=self.name, walls=walls, origin=_ORIGIN, radius=RADIUS, gear=_GEAR, step=TIME_STEP, ball=BALL,
            target=TARGET, wall=WALL,
        )  # fmt: skip

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled model, shared by all users of this maze: do not modify it."""
        return _compiled(self)


_MJCF = """\
<mujoco model="pointmaze_{name}">
  <compiler inertiafromgeom="true" angle="radian"/>
  <option timestep="{step}" gravity="0 0 0" iterations="20" integrator="Euler"/>
  <size nuserdata="4"/>
  <custom>
    <numeric name="{target}_state" data="0"/>
  </custom>
  <default>
    <joint damping="1" limited="false"/>
    <geom friction="0.5 0.1 0.1" density="1000" margin="0.002" condim="1" contype="2" conaffinity="1"/>
  </default>
  <worldbody>
    <geom name="ground" type="plane" size="40 40 0.25" pos="0 0 -0.1" contype="1" conaffinity="0"/>
    <body name="{ball}_main" pos="{origin} {origin} 0">
      <joint name="{ball}_x" type="slide" axis="1 0 0"/>
      <joint name="{ball}_y" type="slide" axis="0 1 0"/>
      <geom name="{ball}_geom" type="sphere" size="{radius}" contype="1"/>
    </body>
    <body name="{target}_main" mocap="true" pos="{origin} {origin} 0">
      <site name="{target}_site" size="0.2" rgba="0.6 0.3 0.3 1"/>
    </body>
    <body name="{wall}_main">
{walls}
    </body>
  </worldbody>
  <actuator>
    <motor joint="{ball}_x" ctrlrange="-1 1" ctrllimited="true" gear="{gear}"/>
    <motor joint="{ball}_y" ctrlrange="-1 1" ctrllimited="true" gear="{gear}"/>
  </actuator>
</mujoco>
"""

MAZES = {
    maze.name: maze
    for maze in (
        Maze("u_maze", ("#####", "#GOO#", "###O#", "#OOO#", "#####")),
        Maze("small", ("######", "#OOOO#", "#O##O#", "#OOOO#", "######")),
        Maze(
            "medium", ("########", "#OO##OO#", "#OO#OOO#", "##OOO###", "#OO#OOO#", "#O#OO#O#", "#OOO#OG#", "########")
        ),
        Maze(
            "large",
            (
                *("############", "#OOOO#OOOOO#", "#O##O#O#O#O#", "#OOOOOO#OOO#", "#O####O###O#"),
                *("#OO#O#OOOOO#", "##O#O#O#O###", "#OO#OOO#OGO#", "############"),
            ),
        ),
    )
}
"""DINO-WM's maze and D4RL's larger ones, by name."""


def maze_named(name: str) -> Maze:
    """The maze of that name; raises ``OntoError`` PMZ002 for a name that is none of :data:`MAZES`."""
    if name not in MAZES:
        hint = near(name, MAZES) or f"known: {', '.join(f'`{known}`' for known in MAZES)}"
        raise OntoError.of("PMZ002", f"`{name}` is not a maze", hint)
    return MAZES[name]


@cache
def _compiled(maze: Maze) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(maze.mjcf())


def centre(cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """The middles of cells, rows and columns (..., 2), in the coordinates of a state (..., 2)."""
    return cells.astype(np.float64) + (1.0 - _ORIGIN)


def _boxes(cells: NDArray[np.int64]) -> NDArray[np.float64]:
    middle = centre(cells)
    return np.concatenate([middle - _HALF, middle + _HALF], axis=1)


def _distance(points: NDArray[np.float64], boxes: NDArray[np.float64]) -> NDArray[np.float64]:
    """From each of ``points`` (..., 2) to the nearest of ``boxes`` (K, 4), 0 within one; without any it is infinite."""
    if not len(boxes):
        return np.full(points.shape[:-1], np.inf)
    return np.maximum(clearance(points, boxes), 0.0)


def _depth(points: NDArray[np.float64], extent: tuple[float, float, float, float]) -> NDArray[np.float64]:
    """How far inside the layout each of ``points`` is; 0 outside."""
    low, high = np.array(extent[:2]), np.array(extent[2:])
    return np.asarray(np.maximum(np.minimum(points - low, high - points).min(axis=-1), 0.0))
