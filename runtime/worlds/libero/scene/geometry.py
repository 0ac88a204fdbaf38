"""Pure functions over arrays that every placement needs: rotations, boxes of geoms, and the balance of a resting body.

Quaternions are MuJoCo's ``wxyz``; lengths are metres, angles radians; rotation matrices map local to world vectors.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Support",
    "align_yaw",
    "balance",
    "cube_rotations",
    "extent",
    "level",
    "matrix_of",
    "nonnegative_least_squares",
    "quaternion_of",
    "yaw_matrix",
]

Array = NDArray[np.float64]

_HORIZONTAL = 1e-9  # a projected axis shorter than this has no heading
_LEVEL_RAD = np.radians(15.0)  # a resting object leans less than this from the pose that it rests in
_ACTIVE = 1e-10  # tolerance of the active set, relative to unit forces


def matrix_of(quat: Array) -> Array:
    """Rotation matrix (3, 3) of the quaternion ``quat`` (4,), which need not be normalised."""
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, quat / np.linalg.norm(quat))
    return flat.reshape(3, 3)


def quaternion_of(matrix: Array) -> Array:
    """Unit quaternion (4,) of the rotation matrix (3, 3)."""
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(matrix).ravel())
    return quat


def yaw_matrix(angle: float) -> Array:
    """Rotation by ``angle`` about the world's vertical."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@cache
def _cube() -> tuple[tuple[tuple[float, ...], ...], ...]:
    found = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            if np.linalg.det(matrix) > 0:
                found.append(tuple(map(tuple, matrix.tolist())))
    return tuple(found)


def cube_rotations() -> Array:
    """The 24 rotations (24, 3, 3) that map the coordinate axes onto themselves."""
    return np.array(_cube())


def level(matrix: Array, limit: float = _LEVEL_RAD) -> Array:
    """Turn ``matrix`` the least so that its most vertical axis is vertical, or not at all beyond ``limit`` (rad).

    An object at rest on something uneven leans a little; what stands flat touches at several points at once.
    """
    column = int(np.argmax(np.abs(matrix[2])))
    axis = matrix[:, column]
    up = np.array([0.0, 0.0, np.sign(axis[2])])
    turn = np.cross(axis, up)
    sine = float(np.linalg.norm(turn))
    angle = float(np.arctan2(sine, axis @ up))
    if sine < _HORIZONTAL or angle > limit:
        return matrix
    quat = np.zeros(4)
    mujoco.mju_axisAngle2Quat(quat, turn / sine, angle)
    return matrix_of(quat) @ matrix


def align_yaw(matrix: Array, frame: Array) -> float:
    """The smallest turn about the vertical that makes a horizontal axis of ``matrix`` parallel to one of ``frame``."""

    def heading(rotation: Array) -> float:
        column = int(np.argmax(np.linalg.norm(rotation[:2], axis=0)))
        return float(np.arctan2(rotation[1, column], rotation[0, column]))

    quarter = np.pi / 2
    turn = (heading(frame) - heading(matrix)) % quarter
    return turn - quarter if turn > quarter / 2 else turn


def _corners(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Array:
    """Corners (8, 3) in the world of the box that bounds one geom in its own frame."""
    centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
    local = centre + half * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return np.asarray(local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])


def extent(model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.intp]) -> tuple[Array, Array]:
    """Lower and upper corner (3,) in the world of the box around ``geoms``; planes, which have no end, are left out.

    ``data`` must have been through ``mj_kinematics``. Raises ``ValueError`` when no geom of finite size is given.
    """
    finite = [int(g) for g in geoms if model.geom_type[g] != mujoco.mjtGeom.mjGEOM_PLANE]
    if not finite:
        raise ValueError("no geom of finite size")
    points = np.concatenate([_corners(model, data, g) for g in finite])
    return points.min(axis=0), points.max(axis=0)


def nonnegative_least_squares(columns: Array, target: Array, rounds: int = 200) -> tuple[Array, float]:
    """Minimise ``|columns @ x - target|`` over ``x >= 0`` by Lawson and Hanson's active set (1974, chapter 23).

    ``columns`` is (m, n), ``target`` (m,). Returns ``x`` (n,) and the norm of what remains.
    """
    n = columns.shape[1]
    x = np.zeros(n)
    free = np.zeros(n, dtype=np.bool_)
    for _ in range(rounds):
        gradient = columns.T @ (target - columns @ x)
        gradient[free] = -np.inf
        best = int(np.argmax(gradient)) if n else -1
        if best < 0 or gradient[best] <= _ACTIVE:
            break
        free[best] = True
        while free.any():
            trial = np.zeros(n)
            trial[free] = np.linalg.lstsq(columns[:, free], target, rcond=None)[0]
            bad = free & (trial <= 0.0)
            if not bad.any():
                x = trial
                break
            step = float(np.min(x[bad] / np.maximum(x[bad] - trial[bad], 1e-300)))
            x = x + step * (trial - x)
            free &= x > _ACTIVE
            x[~free] = 0.0
    return x, float(np.linalg.norm(target - columns @ x))


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """Contacts that may carry a body: points (n, 3), normals (n, 3) towards the body, friction coefficients (n,)."""

    points: Array
    normals: Array
    friction: Array


def _wrenches(support: Support, centre: Array, length: float) -> Array:
    """Unit wrenches (6, 4 n) of the edges of each contact's friction pyramid, torques in units of ``length``."""
    normals = support.normals
    helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    side = np.cross(normals, helper)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(normals, side)
    grip = support.friction[:, None]
    forces = np.concatenate([normals + grip * tangent for tangent in (side, -side, other, -other)])
    forces /= np.linalg.norm(forces, axis=1, keepdims=True)
    arms = np.tile(support.points - centre, (4, 1)) / length
    return np.concatenate([forces, np.cross(arms, forces)], axis=1).T


def balance(support: Support, centre: Array, length: float, lean: float = 0.0) -> float:
    """How far gravity is from being carried by the contacts: 0 balanced, 1 nothing holds; in units of the weight.

    ``centre`` (3,) is that of mass; ``length`` scales torque to force. With ``lean`` the centre is moved by so many
    metres to four sides and the worst answer counts: a body that stands on an edge is balanced, but not for long.
    """
    if not len(support.points):
        return 1.0
    shifts = [(0.0, 0.0)] if not lean else [(lean, 0.0), (-lean, 0.0), (0.0, lean), (0.0, -lean)]
    weight = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    worst = 0.0
    for dx, dy in shifts:
        edges = _wrenches(support, centre + np.array([dx, dy, 0.0]), length)
        worst = max(worst, nonnegative_least_squares(edges, weight)[1])
    return worst
