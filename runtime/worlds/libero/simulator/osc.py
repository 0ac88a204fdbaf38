"""One control step of robosuite's ``OSC_POSE`` under MuJoCo's dynamics, compiled.

Source: robosuite 1.4.0, ``controllers/osc.py``, ``utils/control_utils.py`` and ``robots/single_arm.py``. What it does
in 25 substeps with three forward passes each, this does with one ``mj_step1``/``mj_step2`` pair each. The algebra is
the same, with Cholesky factors in the place of (pseudo-)inverses; it differs where robosuite would truncate a singular
value, which is at a pose that has lost a degree of freedom to within 1e-15.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grounding.jit import compiled
from runtime.worlds.libero.simulator.libmujoco import mj_jac_site, mj_step1, mj_step2
from runtime.worlds.libero.simulator.touch import GRIPPER_SPEED

__all__ = ["Addresses", "Arm", "Control", "Work", "control_step", "rotation"]

NULL_KP = 10.0  # of the null space's posture task, control_utils.nullspace_torques
NULL_KV = 2.0 * math.sqrt(NULL_KP)
POSITION_SCALE = 0.05  # metres per unit of action
ROTATION_SCALE = 0.5  # radians per unit of action
QUATERNION_EPS = np.finfo(np.float64).eps * 4.0

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


class Addresses(NamedTuple):
    """Views of one ``MjModel``/``MjData`` pair; all alias MuJoCo's memory."""

    model: np.uint64
    data: np.uint64
    qpos: Floats
    qvel: Floats
    ctrl: Floats
    mass: Floats  # qM, sparse
    bias: Floats  # qfrc_bias
    site_pos: Floats  # (3,) of the grip site
    site_mat: Floats  # (9,)
    ncon: Ints  # (1,)
    contact_geom: Ints  # (capacity, 2)


class Arm(NamedTuple):
    """Where the model keeps the arm, and the controller's gains: constant for a scene."""

    site: np.int32
    qpos: Ints  # (7,)
    dof: Ints  # (7,)
    actuators: Ints  # (7,)
    fingers: Ints  # (2,) actuators
    mass_index: Ints  # (7, 7) into qM
    torque_low: Floats  # (7,)
    torque_high: Floats
    finger_bias: Floats  # (2,)
    finger_weight: Floats
    kp: Floats  # (6,)
    kd: Floats
    posture: Floats  # (7,) joint positions that the null space holds


class Work(NamedTuple):
    """Scratch arrays of a step."""

    action: Floats  # (7,) clipped
    turn: Floats  # (3,) rotation vector of the action
    quaternion: NDArray[np.float32]  # (4,) of the turn
    rotation: Floats  # (3, 3) of the turn
    site: Floats  # (2, 3, nv) Jacobian of the grip site, every joint's
    factor: Floats  # (7, 7)
    spread: Floats  # (7, 6)
    inertia: Floats  # (6, 6)
    linear: Floats  # (3, 3)
    angular: Floats  # (3, 3)
    wrench: Floats  # (6,)
    null: Floats  # (6,)
    posture: Floats  # (7,)


class Control(NamedTuple):
    """The controller's state, which a snapshot carries; views of one array, so that it is copied in one stroke."""

    goal_pos: Floats  # (3,)
    goal_ori: Floats  # (3, 3)
    gripper: Floats  # (2,) current action
    fresh: Floats  # (1,) robosuite's new_update, 0 or 1: read the kinematics before the first substep
    ee_pos: Floats  # (3,)
    ee_ori: Floats  # (3, 3)
    ee_vel: Floats  # (6,) linear, angular
    joint_pos: Floats  # (7,)
    joint_vel: Floats  # (7,)
    jacobian: Floats  # (6, 7)
    mass: Floats  # (7, 7)
    torques: Floats  # (7,) unclipped


@compiled
def rotation(vector: Floats, quaternion: NDArray[np.float32], out: Floats) -> None:
    """Matrix (3, 3) of a rotation vector (3,), in the single precision of robosuite's ``quat2mat``.

    ``quaternion`` (4,) is scratch. Here as everywhere in this module, arrays are given and not made, and written
    element by element: numba compiles that in half the time.
    """
    angle = np.linalg.norm(vector)
    for i in range(3):
        for j in range(3):
            out[i, j] = 1.0 if i == j else 0.0
    if angle == 0.0:
        return
    quaternion[0] = np.cos(angle / 2.0)
    for i in range(3):
        quaternion[1 + i] = vector[i] / angle * np.sin(angle / 2.0)
    n = np.dot(quaternion, quaternion)
    if n < QUATERNION_EPS:
        return
    scale = math.sqrt(2.0 / n)
    for i in range(4):
        quaternion[i] *= scale
    w, x, y, z = quaternion[0], quaternion[1], quaternion[2], quaternion[3]
    out[0, 0], out[0, 1], out[0, 2] = 1.0 - y * y - z * z, x * y - z * w, x * z + y * w
    out[1, 0], out[1, 1], out[1, 2] = x * y + z * w, 1.0 - x * x - z * z, y * z - x * w
    out[2, 0], out[2, 1], out[2, 2] = x * z - y * w, y * z + x * w, 1.0 - x * x - y * y


@compiled
def _read(at: Addresses, arm: Arm, control: Control, jacobian: Floats) -> None:
    """Copy pose, velocity, Jacobian and mass matrix of the arm: robosuite's ``Controller.update``."""
    for i in range(3):
        control.ee_pos[i] = at.site_pos[i]
        for j in range(3):
            control.ee_ori[i, j] = at.site_mat[3 * i + j]
    mj_jac_site(at.model, at.data, jacobian[0].ctypes.data, jacobian[1].ctypes.data, arm.site)
    for row in range(6):
        line = jacobian[row // 3, row % 3]
        # The arm hangs on a fixed base: no other joint moves its site.
        total = 0.0
        for k in range(7):
            value = line[arm.dof[k]]
            control.jacobian[row, k] = value
            total += value * at.qvel[arm.dof[k]]
        control.ee_vel[row] = total
    for i in range(7):
        control.joint_pos[i] = at.qpos[arm.qpos[i]]
        control.joint_vel[i] = at.qvel[arm.dof[i]]
        for j in range(7):
            control.mass[i, j] = at.mass[arm.mass_index[i, j]]


@compiled
def _copy(source: Floats, out: Floats) -> None:
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            out[i, j] = source[i, j]


@compiled
def _factor(a: Floats) -> None:
    """Cholesky factor of a symmetric positive definite matrix, in place, in its lower triangle.

    Its diagonal holds the inverses, since a multiplication is many times as fast as a division.
    """
    n = a.shape[0]
    for j in range(n):
        for k in range(j):
            for i in range(j, n):
                a[i, j] -= a[i, k] * a[j, k]
        a[j, j] = 1.0 / math.sqrt(a[j, j])
        for i in range(j + 1, n):
            a[i, j] *= a[j, j]


@compiled
def _solve(factor: Floats, b: Floats) -> None:
    """Solve in place for one right-hand side."""
    n = b.size
    for i in range(n):
        for k in range(i):
            b[i] -= factor[i, k] * b[k]
        b[i] *= factor[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            b[i] -= factor[k, i] * b[k]
        b[i] *= factor[i, i]


@compiled
def _set_goal(control: Control, work: Work) -> None:
    turns = False
    for i in range(3):
        control.goal_pos[i] = control.ee_pos[i] + POSITION_SCALE * work.action[i]
        work.turn[i] = ROTATION_SCALE * work.action[3 + i]
        turns |= work.turn[i] != 0.0
    if turns:
        rotation(work.turn, work.quaternion, work.rotation)
        np.dot(work.rotation, control.ee_ori, control.goal_ori)


@compiled
def _wrench(arm: Arm, control: Control, wrench: Floats) -> None:
    """The desired force and torque (6,): a spring and a damper towards the goal."""
    current, goal = control.ee_ori, control.goal_ori
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        turn = 0.0
        for column in range(3):
            turn += current[j, column] * goal[k, column] - current[k, column] * goal[j, column]
        wrench[i] = (control.goal_pos[i] - control.ee_pos[i]) * arm.kp[i] - control.ee_vel[i] * arm.kd[i]
        wrench[3 + i] = 0.5 * turn * arm.kp[3 + i] - control.ee_vel[3 + i] * arm.kd[3 + i]


@compiled
def _posture(arm: Arm, control: Control, posture: Floats, null: Floats) -> None:
    """The joint torques (7,) that pull towards the posture, and the acceleration (6,) that they give the gripper.

    The torques are the mass matrix times a joint acceleration, so its inverse is not needed for the second.
    """
    posture[:] = 0.0
    null[:] = 0.0
    for i in range(7):
        pull = NULL_KP * (arm.posture[i] - control.joint_pos[i]) - NULL_KV * control.joint_vel[i]
        for j in range(7):
            posture[j] += control.mass[i, j] * pull
        for row in range(6):
            null[row] += control.jacobian[row, i] * pull


@compiled
def _inertia(control: Control, work: Work) -> None:
    """J M^-1 J^T, the inverse of the operational space inertia: the square of what solves L x = J^T, M being L L^T."""
    factor, spread, inertia = work.factor, work.spread, work.inertia
    _copy(control.mass, factor)
    _factor(factor)
    for i in range(7):
        for row in range(6):
            spread[i, row] = control.jacobian[row, i]
        for k in range(i):
            for row in range(6):
                spread[i, row] -= factor[i, k] * spread[k, row]
        for row in range(6):
            spread[i, row] *= factor[i, i]
    inertia[:] = 0.0
    for i in range(7):
        for row in range(6):
            for column in range(6):
                inertia[row, column] += spread[i, row] * spread[i, column]


@compiled
def _torques(at: Addresses, arm: Arm, control: Control, work: Work) -> None:
    """Operational space control with decoupled position and orientation, and a posture task in the null space."""
    wrench, posture, null, inertia = work.wrench, work.posture, work.null, work.inertia
    _wrench(arm, control, wrench)
    _posture(arm, control, posture, null)
    _inertia(control, work)
    for row in range(3):
        for column in range(3):
            work.linear[row, column] = inertia[row, column]
            work.angular[row, column] = inertia[3 + row, 3 + column]
    _factor(work.linear)
    _factor(work.angular)
    _factor(inertia)
    _solve(work.linear, wrench[:3])
    _solve(work.angular, wrench[3:])
    _solve(inertia, null)
    for j in range(7):
        total = posture[j] + at.bias[arm.dof[j]]
        for row in range(6):
            total += control.jacobian[row, j] * (wrench[row] - null[row])
        control.torques[j] = total


@compiled
def _apply(at: Addresses, arm: Arm, control: Control, gripper: float) -> None:
    for i in range(7):
        at.ctrl[arm.actuators[i]] = min(max(control.torques[i], arm.torque_low[i]), arm.torque_high[i])
    move = GRIPPER_SPEED * np.sign(gripper)
    for i in range(2):
        control.gripper[i] = min(max(control.gripper[i] + (move if i else -move), -1.0), 1.0)
        at.ctrl[arm.fingers[i]] = arm.finger_bias[i] + arm.finger_weight[i] * control.gripper[i]


@compiled
def _touch(at: Addresses, side: NDArray[np.int16], touched: NDArray[np.bool_]) -> None:
    for i in range(at.ncon[0]):
        a, b = side[at.contact_geom[i, 0]], side[at.contact_geom[i, 1]]
        if a >= 0 and b >= 0:
            touched[a, b] = True
            touched[b, a] = True


@compiled
def control_step(
    at: Addresses,
    arm: Arm,
    control: Control,
    work: Work,
    action: Floats,
    first: int,
    last: int,
    side: NDArray[np.int16],
    touched: NDArray[np.bool_],
) -> None:
    """Take the substeps from ``first`` up to ``last`` of one control step with ``action`` (7,), clipped to [-1, 1].

    ``side`` (ngeom,) numbers the geoms of interest, -1 for the others; ``touched`` (k, k) is set where two of them met
    in any substep.
    """
    for i in range(7):
        work.action[i] = min(max(action[i], -1.0), 1.0)
    for substep in range(first, last):
        mj_step1(at.model, at.data)
        if side.size:
            _touch(at, side, touched)
        if substep > 0 or control.fresh[0] != 0.0:
            _read(at, arm, control, work.site)
        if substep == 0:
            _set_goal(control, work)
        _torques(at, arm, control, work)
        _apply(at, arm, control, work.action[6])
        mj_step2(at.model, at.data)
    control.fresh[0] = 1.0
