"""The compiled control step as a :class:`~runtime.worlds.libero.simulator.simulation.Stepper`, and its contacts."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.memory import contact_places
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.osc import Addresses, Arm, Control, Work, control_step
from runtime.worlds.libero.simulator.touch import sides

__all__ = ["CompiledStepper"]

_SHAPES: Mapping[str, tuple[int, ...]] = {
    "goal_pos": (3,),
    "goal_ori": (3, 3),
    "gripper": (2,),
    "fresh": (1,),
    "ee_pos": (3,),
    "ee_ori": (3, 3),
    "ee_vel": (6,),
    "joint_pos": (7,),
    "joint_vel": (7,),
    "jacobian": (6, 7),
    "mass": (7, 7),
    "torques": (7,),
}


class CompiledStepper:
    """Steps ``data`` with numba. It holds views of MuJoCo's memory, and ``data`` with them."""

    def __init__(self, scene: CompiledScene, data: mujoco.MjData) -> None:
        self._scene, self._data = scene, data
        self._home = scene.home.controller
        self._at = _addresses(scene, data)
        self._arm = _arm(scene)
        self._work = _work(scene.model)
        self._flat = np.zeros(sum(math.prod(shape) for shape in _SHAPES.values()))
        self._before = self._flat.copy()
        self._control = _views(self._flat)
        self._side = np.empty(0, dtype=np.int16)
        self.touched = np.zeros((0, 0), dtype=np.bool_)

    def watch(self, entities: Sequence[NDArray[np.intp]]) -> None:
        """Accumulate from now on which of ``entities`` (each its geom ids) touch in any substep, in ``touched``."""
        self._side = sides(self._scene.model.ngeom, entities)
        self.touched = np.zeros((len(entities), len(entities)), dtype=np.bool_)

    def step(self, action: NDArray[np.float64], before_last_substep: Callable[[], object] | None = None) -> None:
        """Take one control step with ``action`` (7,), finite; ``before_last_substep`` is called when it is due."""
        self._before[:] = self._flat
        last = self._scene.substeps
        if before_last_substep is None:
            self._advance(action, 0, last)
            return
        self._advance(action, 0, last - 1)
        before_last_substep()
        self._advance(action, last - 1, last)

    def _advance(self, action: NDArray[np.float64], first: int, last: int) -> None:
        control_step(self._at, self._arm, self._control, self._work, action, first, last, self._side, self.touched)

    def take(self, *, before: bool = False) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Copy the gripper's current action and the controller's state, now or ``before`` the last step."""
        c = _views((self._before if before else self._flat).copy())
        held = {
            "goal_pos": c.goal_pos,
            "goal_ori": c.goal_ori,
            "ee_pos": c.ee_pos,
            "ee_ori_mat": c.ee_ori,
            "ee_pos_vel": c.ee_vel[:3],
            "ee_ori_vel": c.ee_vel[3:],
            "joint_pos": c.joint_pos,
            "joint_vel": c.joint_vel,
            "J_pos": c.jacobian[:3],
            "J_ori": c.jacobian[3:],
            "J_full": c.jacobian,
            "mass_matrix": c.mass,
            "torques": c.torques,
            "new_update": bool(c.fresh[0]),
        }
        return c.gripper, {**self._home, **held}

    def put(self, gripper: NDArray[np.float64], controller: Mapping[str, Any]) -> None:
        """Write both back."""
        c = self._control
        c.gripper[:] = gripper
        c.goal_pos[:], c.goal_ori[:] = controller["goal_pos"], controller["goal_ori"]
        c.ee_pos[:], c.ee_ori[:] = controller["ee_pos"], controller["ee_ori_mat"]
        c.ee_vel[:3], c.ee_vel[3:] = controller["ee_pos_vel"], controller["ee_ori_vel"]
        c.joint_pos[:], c.joint_vel[:] = controller["joint_pos"], controller["joint_vel"]
        c.jacobian[:], c.mass[:] = controller["J_full"], controller["mass_matrix"]
        c.fresh[0] = controller["new_update"]


def _views(flat: NDArray[np.float64]) -> Control:
    """The parts of ``flat`` in the order of :data:`_SHAPES`."""
    parts, start = {}, 0
    for name, shape in _SHAPES.items():
        stop = start + math.prod(shape)
        parts[name] = flat[start:stop].reshape(shape)
        start = stop
    return Control(**parts)


def _arm(scene: CompiledScene) -> Arm:
    model, arm, controller = scene.model, scene.arm, scene.home.controller
    limits = model.actuator_ctrlrange[arm.fingers]
    return Arm(
        site=np.int32(arm.site),
        qpos=arm.qpos,
        dof=arm.dof,
        actuators=arm.actuators,
        fingers=arm.fingers,
        mass_index=_mass_index(model, arm.dof),
        torque_low=arm.torque_low,
        torque_high=arm.torque_high,
        finger_bias=0.5 * (limits[:, 1] + limits[:, 0]),
        finger_weight=0.5 * (limits[:, 1] - limits[:, 0]),
        kp=np.array(controller["kp"], dtype=np.float64),
        kd=np.array(controller["kd"], dtype=np.float64),
        posture=np.array(controller["initial_joint"], dtype=np.float64),
    )


def _mass_index(model: mujoco.MjModel, dofs: NDArray[np.int32]) -> NDArray[np.int32]:
    """Where ``qM`` holds each entry of the chain's mass matrix: a dof's row runs from itself up to its ancestors."""
    index = np.empty((len(dofs), len(dofs)), dtype=np.int32)
    place = {int(dof): i for i, dof in enumerate(dofs)}
    for i, dof in enumerate(int(d) for d in dofs):
        address, ancestor = int(model.dof_Madr[dof]), dof
        while ancestor >= 0:
            if ancestor in place:
                index[i, place[ancestor]] = index[place[ancestor], i] = address
            address, ancestor = address + 1, int(model.dof_parentid[ancestor])
    return index


def _work(model: mujoco.MjModel) -> Work:
    return Work(
        action=np.zeros(7),
        turn=np.zeros(3),
        quaternion=np.zeros(4, dtype=np.float32),
        rotation=np.zeros((3, 3)),
        site=np.zeros((2, 3, model.nv)),
        factor=np.zeros((7, 7)),
        spread=np.zeros((7, 6)),
        inertia=np.zeros((6, 6)),
        linear=np.zeros((3, 3)),
        angular=np.zeros((3, 3)),
        wrench=np.zeros(6),
        null=np.zeros(6),
        posture=np.zeros(7),
    )


def _addresses(scene: CompiledScene, data: mujoco.MjData) -> Addresses:
    model, site = scene.model, scene.arm.site
    return Addresses(
        model=np.uint64(model._address),  # noqa: SLF001  the bindings' documented way to the C struct
        data=np.uint64(data._address),  # noqa: SLF001
        qpos=data.qpos,
        qvel=data.qvel,
        ctrl=data.ctrl,
        mass=data.qM,
        bias=data.qfrc_bias,
        site_pos=data.site_xpos[site],
        site_mat=data.site_xmat[site],
        ncon=_ncon(data),
        contact_geom=_contact_geoms(data),
    )


def _ncon(data: mujoco.MjData) -> NDArray[np.int32]:
    cell: Any = (ctypes.c_char * 4).from_address(data._address + contact_places().ncon)  # noqa: SLF001  as above
    return np.ndarray(1, dtype=np.int32, buffer=cell)


def _contact_geoms(data: mujoco.MjData) -> NDArray[np.int32]:
    """The ``geom`` pairs of as many contacts as the arena can hold; MuJoCo keeps them at the arena's start."""
    places = contact_places()
    start = ctypes.c_size_t.from_address(data._address + places.contact).value  # noqa: SLF001  as above
    capacity = int(data.narena) // places.stride
    block: Any = (ctypes.c_char * (capacity * places.stride)).from_address(start)
    return np.ndarray((capacity, 2), dtype=np.int32, buffer=block, offset=places.geom, strides=(places.stride, 4))
