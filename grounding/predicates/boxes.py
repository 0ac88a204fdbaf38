"""The exact distance between two boxes, for the cases in which MuJoCo's own search for it gives up."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

__all__ = ["Box", "box_distance"]

Box = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]
"""Centre (3,), axes as columns (3, 3), half sizes (3,), in one frame, metres."""

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
_EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if np.abs(_CORNERS[i] - _CORNERS[j]).sum() == 2.0])
PARALLEL = 1e-12


def box_distance(first: Box, second: Box) -> float:
    """The distance between two boxes (metres), 0 when they overlap.

    Apart, the nearest points are a corner of one and a point of the other, or interior points of two edges; all of
    those are tried, so there is no search that could fail.
    """
    if _overlap(first, second):
        return 0.0
    a, b = _corners(first), _corners(second)
    return float(min(_to_box(a, second), _to_box(b, first), _between_edges(a, b)))


def _corners(box: Box) -> NDArray[np.float64]:
    centre, axes, half = box
    return centre + (_CORNERS * half) @ axes.T


def _overlap(first: Box, second: Box) -> bool:
    """Separating axis test: the faces' normals and the cross products of edges."""
    (c1, r1, h1), (c2, r2, h2) = first, second
    crosses = np.cross(r1.T[:, None, :], r2.T[None, :, :]).reshape(9, 3)
    axes = np.vstack([r1.T, r2.T, crosses])
    lengths = np.linalg.norm(axes, axis=1)
    axes = axes[lengths > PARALLEL]
    reach = np.abs(axes @ r1) @ h1 + np.abs(axes @ r2) @ h2
    return bool((np.abs(axes @ (c2 - c1)) <= reach).all())


def _to_box(points: NDArray[np.float64], box: Box) -> float:
    centre, axes, half = box
    local = (points - centre) @ axes
    return float(np.linalg.norm(local - np.clip(local, -half, half), axis=1).min())


def _between_edges(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Smallest distance between interior points of two edges; infinite when every pair is nearest at an end."""
    p, u = a[_EDGES[:, 0]][:, None, :], (a[_EDGES[:, 1]] - a[_EDGES[:, 0]])[:, None, :]
    q, v = b[_EDGES[:, 0]][None, :, :], (b[_EDGES[:, 1]] - b[_EDGES[:, 0]])[None, :, :]
    w = p - q
    uu, uv, vv = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    determinant = uu * vv - uv * uv
    skew = determinant > PARALLEL * uu * vv
    determinant = np.where(skew, determinant, 1.0)
    s, t = (uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant
    inner = skew & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    distances = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    return float(np.where(inner, distances, np.inf).min())
