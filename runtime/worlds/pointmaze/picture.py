"""Pictures of the maze from above, as upstream's camera shows it, rendered without OpenGL.

Colours and sizes are those of upstream's scene: a checkered plane, brown walls, and the site of radius 0.2 around the
ball, which covers it. The target is hidden, as in DINO-WM's data. x runs to the right and y upwards; the layout fills
the picture. The disc's edge is antialiased, so that its position can be read with subpixel accuracy.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from grounding.jit import compiled
from onto_compiler.problems import OntoError
from runtime.worlds.pointmaze.maze import Maze

__all__ = ["SIZE", "draw"]

SIZE = 64
"""Pixels, across and down."""
_DISC = 0.2
"""Radius of the disc drawn for the ball, metres."""
_BALL = np.array([0.3, 0.6, 0.3]) * 255
_WALL = np.array([0.7, 0.5, 0.3]) * 255
_GROUND = np.array([[0.2, 0.3, 0.4], [0.1, 0.2, 0.3]]) * 255
_SQUARE = 2.0
"""Of the plane's checkers, metres: each of the 20 repeats of its texture across 80 metres holds two by two."""
_FINE = 8
"""Rays across a pixel of the background, and as many down."""
_LEAST = 8


def draw(maze: Maze, states: NDArray[np.floating], size: int = SIZE) -> NDArray[np.uint8]:
    """Pictures (N, ``size``, ``size``, 3) of the ball at the first two columns of ``states`` (N, 2 or more), metres.

    Raises ``OntoError`` PMZ003 for states of another shape and a size below 8, PMZ004 for numbers that are not finite.
    """
    xy = np.asarray(states)
    if xy.ndim != 2 or xy.shape[1] < 2 or size < _LEAST:
        message = f"found states of shape {xy.shape} and pictures of {size} pixels"
        raise OntoError.of("PMZ003", message, f"expected states (N, 4) and pictures of at least {_LEAST} pixels")
    places = np.ascontiguousarray(xy[:, :2], dtype=np.float64)
    if not np.isfinite(places).all():
        raise OntoError.of("PMZ004", "a state to be drawn holds numbers that are not finite")
    left, top, scale = _frame(maze, size)
    pictures = np.empty((len(places), size, size, 3), dtype=np.uint8)
    _paint(_background(maze, size), places, left, top, scale, _DISC * scale, _BALL, pictures)
    return pictures


def _frame(maze: Maze, size: int) -> tuple[float, float, float]:
    """The x of the picture's left edge, the y of its top edge, and pixels per metre; the layout is in the middle."""
    low_x, low_y, high_x, high_y = maze.extent
    width = max(high_x - low_x, high_y - low_y)
    return (low_x + high_x - width) / 2, (low_y + high_y + width) / 2, size / width


@lru_cache(maxsize=16)
def _background(maze: Maze, size: int) -> NDArray[np.float64]:
    """The picture without the ball, (size, size, 3), 0 to 255: the mean of what 64 rays of each pixel meet."""
    left, top, scale = _frame(maze, size)
    across = (np.arange(size * _FINE) + 0.5) / (_FINE * scale)
    x, y = np.meshgrid(left + across, top - across)
    colours = _GROUND[((np.floor(x / _SQUARE) + np.floor(y / _SQUARE)) % 2).astype(np.int64)]
    for low_x, low_y, high_x, high_y in maze.wall_boxes.tolist():
        colours[(x >= low_x) & (x < high_x) & (y >= low_y) & (y < high_y)] = _WALL
    seen: NDArray[np.float64] = colours.reshape(size, _FINE, size, _FINE, 3).mean(axis=(1, 3))
    seen.flags.writeable = False
    return seen


@compiled
def _paint(
    background: NDArray[np.float64],
    places: NDArray[np.float64],
    left: float,
    top: float,
    scale: float,
    radius: float,
    ball: NDArray[np.float64],
    pictures: NDArray[np.uint8],
) -> None:
    size = background.shape[0]
    empty = np.empty((size, size, 3), dtype=np.uint8)
    for row in range(size):
        for column in range(size):
            for channel in range(3):
                empty[row, column, channel] = np.uint8(background[row, column, channel] + 0.5)
    for picture in range(places.shape[0]):
        pictures[picture] = empty
        across = (places[picture, 0] - left) * scale - 0.5  # pixel centres are whole numbers
        down = (top - places[picture, 1]) * scale - 0.5
        reach = radius + 1.0
        if not (-reach < across < size + reach and -reach < down < size + reach):
            continue  # the ball is out of the picture
        for row in range(max(int(np.floor(down - reach)), 0), min(int(np.ceil(down + reach)) + 1, size)):
            for column in range(max(int(np.floor(across - reach)), 0), min(int(np.ceil(across + reach)) + 1, size)):
                gap = np.sqrt((row - down) ** 2 + (column - across) ** 2)
                covered = min(max(radius + 0.5 - gap, 0.0), 1.0)
                if covered > 0.0:
                    for channel in range(3):
                        seen = background[row, column, channel]
                        pictures[picture, row, column, channel] = np.uint8(
                            seen + covered * (ball[channel] - seen) + 0.5
                        )
