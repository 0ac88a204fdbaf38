"""Points on the surfaces of collision geoms, in their body's frame: what a grasp or a path must reach or avoid."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = ["body_cloud", "geom_cloud"]

Array = NDArray[np.float64]

SPACING = 0.006  # metres between neighbouring points
THIN = 0.005  # metres; finer detail than this is dropped
ROUND = 16  # points around a cylinder or a sphere at the least
_FEWEST, _MOST = 2, 120  # points along one side


def body_cloud(model: mujoco.MjModel, body: int, geoms: Iterable[int]) -> Array:
    """Surface points (n, 3) of those of ``geoms`` that belong to ``body``, in the body's frame."""
    parts = [np.empty((0, 3))]
    for geom in geoms:
        if model.geom_bodyid[geom] != body:
            continue
        flat = np.zeros(9)
        mujoco.mju_quat2Mat(flat, model.geom_quat[geom])
        parts.append(geom_cloud(model, int(geom)) @ flat.reshape(3, 3).T + model.geom_pos[geom])
    return _thinned(np.concatenate(parts))


def _thinned(points: Array) -> Array:
    """One point for each occupied cell of a grid: shapes are made of parts that overlap."""
    _, first = np.unique(np.round(points / THIN).astype(np.int64), axis=0, return_index=True)
    return points[np.sort(first)]


def geom_cloud(model: mujoco.MjModel, geom: int) -> Array:
    """Surface points (n, 3) of one geom in its own frame; none for a plane, which has no end."""
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_PLANE:
        return np.empty((0, 3))
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return _box(size)
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _mesh(model, int(model.geom_dataid[geom]))
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return _cylinder(float(size[0]), float(size[1]))
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        cap = _ball(np.full(3, size[0]))
        end = np.array([0.0, 0.0, size[1]])
        return np.concatenate([_cylinder(float(size[0]), float(size[1])), cap + end, cap - end])
    return _ball(np.full(3, size[0]) if kind == mujoco.mjtGeom.mjGEOM_SPHERE else size)


def _steps(half: float) -> Array:
    return np.linspace(-half, half, int(np.clip(np.ceil(2 * half / SPACING) + 1, _FEWEST, _MOST)))


def _box(half: Array) -> Array:
    parts = []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        a, b = np.meshgrid(_steps(half[first]), _steps(half[second]), indexing="ij")
        for sign in (-1.0, 1.0):
            side = np.empty((a.size, 3))
            side[:, axis], side[:, first], side[:, second] = sign * half[axis], a.ravel(), b.ravel()
            parts.append(side)
    return np.concatenate(parts)


def _around(radius: float) -> Array:
    angle = np.linspace(0.0, 2 * np.pi, max(ROUND, int(2 * np.pi * radius / SPACING)), endpoint=False)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _cylinder(radius: float, half: float) -> Array:
    ring = _around(radius)
    shell = [np.column_stack([radius * ring, np.full(len(ring), z)]) for z in _steps(half)]
    for r, sign in itertools.product(np.arange(0.0, radius, SPACING), (-1.0, 1.0)):
        shell.append(np.column_stack([r * ring, np.full(len(ring), sign * half)]))
    return np.concatenate(shell)


def _ball(radii: Array) -> Array:
    polar = np.linspace(0.0, np.pi, max(ROUND // 2, int(np.pi * float(radii.max()) / SPACING)))
    ring = _around(float(radii.max()))
    points = [np.column_stack([np.sin(p) * ring, np.full(len(ring), np.cos(p))]) for p in polar]
    return np.asarray(np.concatenate(points) * radii)


def _mesh(model: mujoco.MjModel, mesh: int) -> Array:
    """Points on the faces of the mesh's convex hull, which is what MuJoCo collides; its vertices where it has none."""
    start, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    vertices = model.mesh_vert[start : start + count].astype(np.float64)
    graph = int(model.mesh_graphadr[mesh])
    if graph < 0:
        return np.asarray(vertices)
    words = model.mesh_graph[graph:]
    nvert, nface = int(words[0]), int(words[1])
    offset = 2 + 3 * nvert + 3 * nface  # numvert, numface, vert_edgeadr, vert_globalid, edge_localid (nvert + 3 nface)
    faces = words[offset : offset + 3 * nface].reshape(nface, 3)
    corners = vertices[faces]
    parts = [corners.reshape(-1, 3)]
    for a, b, c in corners:
        longest = max(np.linalg.norm(b - a), np.linalg.norm(c - a), np.linalg.norm(c - b))
        n = int(np.clip(np.ceil(longest / SPACING), 1, _MOST))
        u, v = np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n, indexing="ij")
        inside = (u + v <= 1.0 + 1e-9) & (u + v > 0)
        u, v = u[inside][:, None], v[inside][:, None]
        parts.append(a + u * (b - a) + v * (c - a))
    return np.concatenate(parts)
