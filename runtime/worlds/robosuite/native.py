"""A robosuite task in its own environment, without pictures: built, reset, stepped, and verified."""

from __future__ import annotations

import importlib
import platform
from importlib.metadata import version
from typing import Any
from xml.etree.ElementTree import SubElement

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from grounding.scenes import Naming
from onto_compiler.bddl.ast import Region, TaskSpec
from onto_compiler.problems import OntoError, near
from runtime.worlds import snapshot
from runtime.worlds.flat_state import FlatStates, write_qpos
from runtime.worlds.native_import import before_robosuite, quiet
from runtime.worlds.snapshot import BAD_NUMBERS, Snapshot

__all__ = ["INITIAL_STATES", "RobosuiteTask", "versions"]

INITIAL_STATES = 50
"""Resets that are drawn from a seed; robosuite ships no states of its own."""
ROBOT = "Panda"
STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0)  # OSC_POSE without motion, gripper open
DEPTH_M = 0.1
"""Of a region with a rectangle: how far above its target an object counts as in it (``PickPlace.not_in_bin``)."""
_ROOT, _PADS = "_main", ("left_fingerpad", "right_fingerpad")


class RobosuiteTask:
    """The environment that the problem of a task file names. Its model is compiled once; a reset only writes states."""

    def __init__(self, spec: TaskSpec, seed: int) -> None:
        """Build the environment in some seconds, in its initial state 0; ``SIM010``, ``SIM016`` if it cannot be."""
        self.spec, self.seed = spec, seed
        before_robosuite()
        with quiet():
            try:
                suite = importlib.import_module("robosuite")
                known = importlib.import_module("robosuite.environments.base").REGISTERED_ENVS
            except ImportError as error:
                message = f"robosuite cannot be imported: {error}"
                raise OntoError.of("SIM010", message, 'install the simulator: pip install "onto-evwm[sim]"') from error
            names = {name.lower(): name for name in known}
            name = names.get(spec.problem.lower())
            if name is None:
                hint = near(spec.problem.lower(), names)
                raise OntoError.of("SIM016", f"robosuite has no environment `{spec.problem}`", hint, spec.file)
            state = np.random.get_state()  # noqa: NPY002  robosuite draws from numpy's global generator
            try:
                np.random.seed(seed)  # noqa: NPY002  as above
                self.env = _with_regions(known[name], spec)(
                    robots=ROBOT,
                    controller_configs=suite.load_controller_config(default_controller="OSC_POSE"),
                    has_renderer=False,
                    has_offscreen_renderer=False,
                    use_camera_obs=False,
                    ignore_done=True,  # the horizon is the caller's
                    hard_reset=False,
                    control_freq=20,
                )
            finally:
                np.random.set_state(state)  # noqa: NPY002  as above
        self.reset(0)

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled scene."""
        return self.env.sim.model._model  # noqa: SLF001  robosuite wraps the model and gives no other access

    @property
    def data(self) -> mujoco.MjData:
        """The live state."""
        return self.env.sim.data._data  # noqa: SLF001  as above

    @property
    def naming(self) -> Naming:
        """Names as task files have them, in lower case: root bodies, joints that regions stand for, fingerpads."""
        model, env = self.model, self.env
        bodies = [model.body(body).name for body in range(1, model.nbody) if model.body_parentid[body] == 0]
        joints = {model.joint(joint).name.lower(): model.joint(joint).name for joint in range(model.njnt)}
        gripper = env.robots[0].gripper
        return Naming(
            roots={body.removesuffix(_ROOT).lower(): body for body in bodies},
            joints={region.site: (joints[region.site],) for region in self.spec.regions if region.site in joints},
            parts={f"{gripper.naming_prefix}{pad}": gripper.important_geoms[pad] for pad in _PADS},
        )

    def reset(self, index: int) -> None:
        """Draw initial state ``index``; raises ``SIM017`` if there is no such."""
        if not 0 <= index < INITIAL_STATES:
            message = f"`{self.spec.problem}` has no initial state {index}"
            raise OntoError.of("SIM017", message, f"it has {INITIAL_STATES}, from 0")
        state = np.random.get_state()  # noqa: NPY002  as above
        try:
            np.random.seed([self.seed, index])  # noqa: NPY002  as above
            snapshot.reset_gripper(self.env)
            with quiet():
                self.env.reset()
        finally:
            np.random.set_state(state)  # noqa: NPY002  as above
        self._clear_warnings()

    def reset_to(self, state: ArrayLike) -> None:
        """Go to a flat ``state`` (1 + nq + nv: time, qpos, qvel) from initial state 0; ``SIM003``, ``SIM004``."""
        flat = FlatStates(self.model, self.spec.problem).checked(state)
        self.reset(0)
        data, nq = self.data, self.model.nq
        data.time, data.qpos[:], data.qvel[:] = flat[0], flat[1 : 1 + nq], flat[1 + nq :]
        mujoco.mj_forward(self.model, data)

    def step(self, action: ArrayLike) -> None:
        """One control step (1/20 s) with an OSC_POSE action (7,)."""
        with quiet():
            self.env.step(np.asarray(action, dtype=np.float64))

    def settle(self, steps: int) -> None:
        """Take ``steps`` control steps without motion."""
        for _ in range(steps):
            self.step(STILL)

    def success(self) -> bool:
        """Robosuite's own verdict on the present state."""
        return bool(self.env._check_success())  # noqa: SLF001  robosuite gives no other access

    @property
    def diverged(self) -> bool:
        """Whether the simulation diverged since the last reset or restore."""
        return any(self.data.warning[kind].number > 0 for kind in BAD_NUMBERS)

    def write_qpos(self, qpos: ArrayLike) -> None:
        """Write ``qpos`` (nq,), still the joints that it changes, and recompute; raises ``SIM003``, ``SIM004``."""
        write_qpos(self.model, self.data, qpos, self.spec.problem)

    def snapshot(self) -> Snapshot:
        """The complete simulation state."""
        return snapshot.take(self.env)

    def restore(self, saved: Snapshot) -> None:
        """Go back to ``saved``; raises ``SIM004`` if it is another scene's."""
        snapshot.put(self.env, saved)
        self._clear_warnings()

    def close(self) -> None:
        """Free the environment."""
        with quiet():
            self.env.close()

    def _clear_warnings(self) -> None:
        for kind in BAD_NUMBERS:
            self.data.warning[kind].number = 0


def _with_regions(environment: Any, spec: TaskSpec) -> Any:  # noqa: ANN401  classes of an untyped package
    """``environment`` with a site for each region that has a rectangle; sites take no part in the physics."""

    class WithRegions(environment):
        def _load_model(self) -> None:
            super()._load_model()
            for region in spec.regions:
                if region.ranges:
                    _add_site(self.model.worldbody, region)

    return WithRegions


def _add_site(world: Any, region: Region) -> None:  # noqa: ANN401  an XML element
    body = world.find(f"./body[@name='{region.target.name}']")
    if body is None:
        raise OntoError.of("SIM002", f"region `{region.site}` is of `{region.target.name}`, not a fixture")
    x0, y0, x1, y1 = region.ranges[0]
    place = ((x0 + x1) / 2, (y0 + y1) / 2, DEPTH_M / 2)
    size = (abs(x1 - x0) / 2, abs(y1 - y0) / 2, DEPTH_M / 2)
    numbers = {"pos": place, "size": size, "rgba": (0.0, 0.0, 0.0, 0.0)}
    text = {name: " ".join(map(str, values)) for name, values in numbers.items()}
    SubElement(body, "site", {"name": region.site, "type": "box", **text})


def versions() -> dict[str, str]:
    """Versions of the packages that affect physical results, for provenance."""
    found = {"python": platform.python_version(), "mujoco": mujoco.__version__, "numpy": np.__version__}
    return found | {name: version(name) for name in ("onto-evwm", "robosuite")}
