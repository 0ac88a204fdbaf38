"""A drawing of plans in a maze: the paths that the model's members predicted, and the path of the ball."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from onto_compiler.html import Html, element
from runtime.worlds.pointmaze.maze import RADIUS, SUCCESS_RADIUS, Maze

__all__ = ["Way", "maze_drawing"]

_SCALE = 100.0
_ARROW = 0.08
"""Metres of arrow for each metre per second."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A plan: ``executed`` (T + 1, 4), and ``imagined`` (M, T + 1, 4), with M = 0 without a model."""

    executed: NDArray[np.float64]
    imagined: NDArray[np.float64]


def maze_drawing(
    maze: Maze, start: NDArray[np.float64], goal: NDArray[np.float64], ways: Sequence[Way], caption: str
) -> Html:
    """An SVG of ``ways`` in ``maze`` from ``start`` to ``goal`` (4,), y upwards; ``caption`` labels it."""
    low_x, low_y, high_x, high_y = maze.extent

    def at(x: float, y: float) -> tuple[str, str]:
        return f"{(x - low_x) * _SCALE:.1f}", f"{(high_y - y) * _SCALE:.1f}"

    def line(points: NDArray[np.float64], kind: str) -> str:
        joined = " ".join(",".join(at(x, y)) for x, y in points[:, :2].tolist())
        return f'<polyline class="{kind}" points="{joined}"/>'

    def arrow(state: NDArray[np.float64], kind: str) -> str:
        tip = state[:2] + _ARROW * state[2:]
        return line(np.stack([state[:2], tip]), f"{kind} arrow")

    def disc(state: NDArray[np.float64], radius: float, kind: str) -> str:
        x, y = at(float(state[0]), float(state[1]))
        return f'<circle class="{kind}" cx="{x}" cy="{y}" r="{radius * _SCALE:g}"/>'

    parts = []
    for left, bottom, right, top in maze.wall_boxes.tolist():
        x, y = at(left, top)
        wide, high = (right - left) * _SCALE, (top - bottom) * _SCALE
        parts.append(f'<rect class="wall" x="{x}" y="{y}" width="{wide:g}" height="{high:g}"/>')
    parts += [disc(goal, SUCCESS_RADIUS, "side"), disc(goal, 0.04, "goal"), arrow(goal, "goal")]
    parts += [line(member, "imagined") for way in ways for member in way.imagined]
    parts += [line(way.executed, "executed") for way in ways]
    parts += [disc(way.executed[-1], RADIUS / 2, "stop") for way in ways]
    parts += [disc(start, RADIUS, "begin"), arrow(start, "begin")]
    if ways:
        parts.append(arrow(ways[-1].executed[-1], "executed"))
    size = f"0 0 {(high_x - low_x) * _SCALE:g} {(high_y - low_y) * _SCALE:g}"
    return element("svg", Html("".join(parts)), viewBox=size, role="img", aria_label=caption, class_="maze")
