"""The whole state of a native environment, hidden parts included.

LIBERO's flat state (time, qpos, qvel) leaves out the warm start and actuator state, the fixtures' poses (sampled into
the model at every reset), the gripper's current action, and the controller's goal and cached kinematics. A replay from
the flat state alone therefore drifts; from a :class:`Snapshot` it is exact.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.worlds.fixtures import FixturePoses

__all__ = ["BAD_NUMBERS", "Snapshot", "check_scene", "give_back", "held_by", "identity", "put", "reset_gripper", "take"]

FULL = mujoco.mjtState.mjSTATE_INTEGRATION
BAD_NUMBERS = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)
# Fields that distinguish scenes of equal sizes. The fixtures' poses (body_pos) are part of the state.
_PARTS = (
    *("body_parentid", "body_mass", "geom_bodyid", "geom_type", "geom_size", "geom_pos"),
    *("jnt_type", "jnt_bodyid", "jnt_range", "site_bodyid", "site_size", "site_pos"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """``integration``: MuJoCo's mjSTATE_INTEGRATION vector. Poses in metres and wxyz quaternions, for every body."""

    integration: NDArray[np.float64]
    body_pos: NDArray[np.float64]  # (nbody, 3), in the parent's frame
    body_quat: NDArray[np.float64]  # (nbody, 4), wxyz
    gripper_action: NDArray[np.float64]
    controller: Mapping[str, Any]  # goal, reference and cached kinematics, by robosuite's attribute name
    clock: tuple[int, float, bool]  # control steps, seconds, done
    scene: str  # the identity of the model that it is a state of

    def placed(self, fixtures: FixturePoses | None) -> Snapshot:
        """The same with the fixtures at the poses ``fixtures``; unchanged if that is None."""
        if fixtures is None:
            return self
        return replace(self, body_pos=fixtures.body_pos, body_quat=fixtures.body_quat)


def identity(model: mujoco.MjModel) -> str:
    """A hash of the scene's bodies, geoms, joints and sites, including their names.

    It does not depend on textures or on the fixtures' poses.
    """
    total = hashlib.blake2b(model.names[: int(model.name_siteadr[-1])], digest_size=16)
    for name in _PARTS:
        total.update(getattr(model, name).tobytes())
    return total.hexdigest()


def check_scene(saved: Snapshot, model: mujoco.MjModel, scene: str) -> None:
    """Raise ``SIM004`` if ``saved`` is not of ``model``, whose :func:`identity` is ``scene``."""
    sizes = saved.integration.size, saved.body_pos.shape, saved.body_quat.shape
    if saved.scene != scene or sizes != (mujoco.mj_stateSize(model, FULL), model.body_pos.shape, model.body_quat.shape):
        raise OntoError.of(
            "SIM004", "the snapshot belongs to another scene", "restore it in the task that it was taken in"
        )


def take(env: Any) -> Snapshot:  # noqa: ANN401  robosuite's untyped environment
    """Copy the state of ``env``."""
    model, data, robot = env.sim.model._model, env.sim.data._data, env.robots[0]  # noqa: SLF001  the only access
    integration = np.empty(mujoco.mj_stateSize(model, FULL))
    mujoco.mj_getState(model, data, integration, FULL)
    return Snapshot(
        integration,
        model.body_pos.copy(),
        model.body_quat.copy(),
        np.array(robot.gripper.current_action, dtype=np.float64),
        held_by(robot.controller),
        (env.timestep, env.cur_time, env.done),
        identity(model),
    )


def put(env: Any, saved: Snapshot) -> None:  # noqa: ANN401  robosuite's untyped environment
    """Write ``saved`` back; raises ``SIM004`` when it is another scene's."""
    model, data, robot = env.sim.model._model, env.sim.data._data, env.robots[0]  # noqa: SLF001  the only access
    check_scene(saved, model, identity(model))
    model.body_pos[:] = saved.body_pos
    model.body_quat[:] = saved.body_quat
    mujoco.mj_setState(model, data, saved.integration, FULL)
    mujoco.mj_forward(model, data)
    mujoco.mj_setState(model, data, saved.integration, FULL)  # mj_forward moves the warm start
    robot.gripper.current_action = saved.gripper_action.copy()
    give_back(robot.controller, saved.controller)
    env.timestep, env.cur_time, env.done = saved.clock


def reset_gripper(env: Any) -> None:  # noqa: ANN401  robosuite's untyped environment
    """Write the gripper's current action as a new environment has it.

    Where robosuite's own reset does not build the scene anew, it leaves that as the last episode had it, and the next
    episode's fingers start from there.
    """
    gripper = env.robots[0].gripper
    gripper.current_action = np.zeros(gripper.dof)


def held_by(controller: Any) -> dict[str, Any]:  # noqa: ANN401  robosuite's untyped controller
    """The controller's numbers and arrays; its simulator and interpolators are not state."""
    kinds = (np.ndarray, np.generic, float, int, bool, type(None))
    return {name: _copy(value) for name, value in vars(controller).items() if isinstance(value, kinds)}


def give_back(controller: Any, held: Mapping[str, Any]) -> None:  # noqa: ANN401  as above
    """Restore the state that :func:`held_by` returned."""
    for name, value in held.items():
        setattr(controller, name, _copy(value))


def _copy(value: Any) -> Any:  # noqa: ANN401  a number, an array or None
    return value.copy() if isinstance(value, np.ndarray) else value
