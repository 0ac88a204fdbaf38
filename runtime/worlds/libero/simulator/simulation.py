"""A scene under dynamics, one 20 Hz control step at a time, with only LIBERO's physics."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from onto_compiler.problems import OntoError
from onto_compiler.wording import counted
from runtime.loop.faults import RunFault
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.flat_state import FlatStates
from runtime.worlds.libero.simulator.actions import ACTION_SIZE, DUMMY_ACTION
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.snapshot import BAD_NUMBERS, FULL, Snapshot, check_scene

__all__ = ["Simulation", "Stepper"]

_LOG = logging.getLogger("onto_evwm.mujoco")


class Stepper(Protocol):
    """The controller and the order of the physics calls; holds the controller's state."""

    touched: NDArray[np.bool_]

    def watch(self, entities: Sequence[NDArray[np.intp]]) -> None:
        """Set ``touched`` (k, k) from now on where geoms of two of ``entities`` meet in any substep."""
        ...

    def step(self, action: NDArray[np.float64], before_last_substep: Callable[[], object] | None = None) -> None:
        """Take one control step with ``action`` (7,), finite; it is clipped to [-1, 1].

        ``before_last_substep`` is called before the last substep.
        """
        ...

    def take(self, *, before: bool = False) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Copy the gripper's current action and the controller's state, by robosuite's attribute names.

        ``before`` gives what they were before the last step.
        """
        ...

    def put(self, gripper: NDArray[np.float64], controller: Mapping[str, Any]) -> None:
        """Write both back."""
        ...


class Simulation:
    """One scene and its state. ``exact`` steps as the native environment does, bit for bit, at half its speed gain.

    The compiled loop is for search and monitoring: it agrees with the native environment to within 1e-9 in free motion,
    and drifts in chaotic contact. Published results use ``exact`` or the native environment.
    """

    def __init__(self, scene: CompiledScene, *, exact: bool = False) -> None:
        """Allocate a state of ``scene`` and go to its home.

        Simulations of one scene share its model, and with it the fixtures' poses; see :meth:`restore`.
        """
        mujoco.set_mju_user_warning(_LOG.warning)  # it would write MUJOCO_LOG.TXT into the working folder
        self.scene = scene
        self.model = scene.model
        self.data = mujoco.MjData(scene.model)
        self.exact = exact
        self.steps = 0
        self._flat = FlatStates(scene.model, scene.bddl.stem)
        self._good = np.empty(mujoco.mj_stateSize(self.model, FULL))
        self._stepper = _stepper(scene, self.data, exact=exact)
        self.restore(scene.home)
        scene.users.add(self)

    @property
    def state_size(self) -> int:
        """The length of LIBERO's flat state: time, qpos, qvel."""
        return self._flat.size

    @property
    def flat_state(self) -> NDArray[np.float64]:
        """LIBERO's flat state: time, qpos, qvel, shape (1 + nq + nv,)."""
        return np.concatenate(([self.data.time], self.data.qpos, self.data.qvel))

    def reset_to(self, state: ArrayLike, fixtures: FixturePoses | None = None) -> None:
        """Go to a flat ``state`` (1 + nq + nv,) as LIBERO's ``reset`` and ``set_init_state`` would: a state write.

        ``fixtures`` are the fixtures' poses, by default those of the scene's home; see :meth:`restore`.
        Raises ``SIM004`` when the state is another scene's, ``SIM003`` when it is not finite.
        """
        self.reset_from(self.scene.home.placed(fixtures), state)

    def reset_from(self, home: Snapshot, state: ArrayLike) -> None:
        """The same after a ``reset`` that left the scene at ``home``, where what the flat state lacks comes from."""
        flat = self._flat.checked(state)
        self.restore(home)
        data, nq = self.data, self.model.nq
        data.time = flat[0]
        data.qpos[:] = flat[1 : 1 + nq]
        data.qvel[:] = flat[1 + nq :]
        mujoco.mj_forward(self.model, data)

    def step(self, action: ArrayLike, before_last_substep: Callable[[], object] | None = None) -> None:
        """Take one control step (1/20 s) with an OSC_POSE action (7,), clipped to [-1, 1].

        ``before_last_substep`` may read :attr:`data` before the last substep: that is when LIBERO observes.
        Raises ``SIM021`` for an action that is not seven finite numbers, and :class:`RunFault` with the last good
        snapshot where the state diverges; that snapshot is then the state.
        """
        given = _checked(action)
        mujoco.mj_getState(self.model, self.data, self._good, FULL)
        time = self.data.time
        self._stepper.step(given, before_last_substep)
        self.steps += 1
        if self.data.time <= time or not self._finite():
            self.steps -= 1
            good = self._snapshot(self._good.copy(), *self._stepper.take(before=True))
            self.restore(good)
            raise RunFault(f"the state diverged in control step {self.steps + 1}", good)

    def rollout(self, actions: Sequence[ArrayLike] | NDArray[np.float64]) -> None:
        """Take one control step for each action."""
        for action in actions:
            self.step(action)

    def settle(self, steps: int = 10) -> None:
        """Take ``steps`` control steps without motion: the official initial states hang above the table."""
        for _ in range(steps):
            self.step(DUMMY_ACTION)

    def watch(self, entities: Sequence[str]) -> None:
        """Accumulate from now on, in :attr:`touched`, which of ``entities`` touch in any substep.

        Between two control steps a contact can come and go (robosuite issue 366). Raises ``SIM001`` if one is
        unknown.
        """
        self._stepper.watch([self.scene.index.contact_geoms(name) for name in entities])

    @property
    def touched(self) -> NDArray[np.bool_]:
        """Which watched entities have touched since :meth:`watch`: (k, k), symmetric."""
        return self._stepper.touched

    def snapshot(self) -> Snapshot:
        """The complete simulation state, including hidden state."""
        integration = np.empty_like(self._good)
        mujoco.mj_getState(self.model, self.data, integration, FULL)
        return self._snapshot(integration, *self._stepper.take())

    def restore(self, saved: Snapshot) -> None:
        """Go back to ``saved``, of this scene, whoever took it; raises ``SIM004`` if it is another scene's.

        Where its fixtures stand elsewhere they are moved, which is refused (``SIM022``) while another simulation runs
        in the same compiled scene.
        """
        model, data = self.model, self.data
        check_scene(saved, model, self.scene.home.scene)
        self._move_fixtures(saved)
        mujoco.mj_setState(model, data, saved.integration, FULL)
        mujoco.mj_forward(model, data)
        mujoco.mj_setState(model, data, saved.integration, FULL)  # mj_forward moves the warm start
        self._stepper.put(saved.gripper_action, saved.controller)
        self.steps = saved.clock[0]
        for kind in BAD_NUMBERS:
            data.warning[kind].number = 0

    def _move_fixtures(self, saved: Snapshot) -> None:
        """Write the fixtures' poses, which MuJoCo keeps in the model, unless that would move another simulation's."""
        model = self.model
        if np.array_equal(model.body_pos, saved.body_pos) and np.array_equal(model.body_quat, saved.body_quat):
            return
        others = len(self.scene.users) - (self in self.scene.users)
        if others:
            raise OntoError.of(
                "SIM022",
                f"the snapshot's fixtures stand elsewhere than those of {others} other simulations of this scene",
                "compile the scene once more for this simulation: every `compile_scene` gives a model of its own",
            )
        model.body_pos[:] = saved.body_pos
        model.body_quat[:] = saved.body_quat

    def _finite(self) -> bool:
        # A sum is not finite where a term is not; it can only overflow in a state that has diverged.
        return math.isfinite(self.data.qpos.sum() + self.data.qvel.sum())

    def _snapshot(
        self, integration: NDArray[np.float64], gripper: NDArray[np.float64], controller: Mapping[str, Any]
    ) -> Snapshot:
        clock = (self.steps, self.steps / 20, False)
        return Snapshot(
            integration,
            self.model.body_pos.copy(),
            self.model.body_quat.copy(),
            gripper,
            controller,
            clock,
            self.scene.home.scene,
        )


def _checked(action: ArrayLike) -> NDArray[np.float64]:
    what, given = "", np.empty(0)
    try:
        given = np.asarray(action, dtype=np.float64).ravel()
    except (TypeError, ValueError) as error:
        what = f"an action that is no array of numbers: {error}"
    else:
        if given.size != ACTION_SIZE:
            what = f"an action of {counted(given.size, 'number')}"
        elif not np.isfinite(given).all():
            what = f"an action of the numbers {given.tolist()}"
    if what:
        raise OntoError.of("SIM021", what, "OSC_POSE takes seven finite numbers in [-1, 1]")
    return given


def _stepper(scene: CompiledScene, data: mujoco.MjData, *, exact: bool) -> Stepper:
    if exact:
        from runtime.worlds.libero.simulator.exact import ExactStepper  # noqa: PLC0415  robosuite takes a second to import

        return ExactStepper(scene, data)
    from runtime.worlds.libero.simulator.compiled_step import CompiledStepper  # noqa: PLC0415  so does numba

    return CompiledStepper(scene, data)
