"""A LIBERO task as a Gymnasium environment over the compiled simulator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Literal, cast

import gymnasium
import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from onto_compiler.bddl.parse import parse_file
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.loop.faults import RunFault
from runtime.worlds.facts import FactReporter, GoalReport
from runtime.worlds.libero.gym.starts import Advance, Start, Starts
from runtime.worlds.libero.gym.stove_lights import StoveLights
from runtime.worlds.libero.loop.environment import PREMISE_STEPS
from runtime.worlds.libero.loop.uncertain import Placements, uncertain_row
from runtime.worlds.libero.scene.horizons import chosen_task, horizon_of
from runtime.worlds.libero.scene.observations import Observer
from runtime.worlds.libero.scene.views import CAMERAS, Convention, Views
from runtime.worlds.libero.simulator.actions import ACTION_SIZE, DUMMY_ACTION
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.required import required_of

__all__ = ["LiberoEnv"]

Observed = dict[str, NDArray[Any]]
Info = dict[str, Any]


class LiberoEnv(gymnasium.Env[Observed, NDArray[np.float32]]):
    """One task; an action is OSC_POSE's, and a step is a control step of 1/20 s.

    A reset writes an initial state and lets it settle. It never builds a scene, and keeps nothing of an earlier
    episode. ``terminated`` is success, with a reward of 1; ``truncated`` is the suite's horizon, or a simulation that
    diverged (``info["fault"]``). ``info`` holds ``success``, whose ``judge`` is grounding: each required fact as it is
    grounded here, not LIBERO's own predicate; the typed ``facts`` of the goal with their margins, and in ``failures`` a
    diagnosis and a route for each that is unmet.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}  # noqa: RUF012  gymnasium declares it as an instance's

    def __init__(  # the names are what gymnasium.make passes on
        self,
        task: str | None = None,
        *,
        suite: str | None = None,
        index: int | str | None = None,
        state_index: int = 0,
        advance: Advance = 0,
        exact: bool = False,
        settle: int = PREMISE_STEPS,
        horizon: int | None = None,
        observables: Sequence[str] | None = None,
        timing: Literal["libero", "current"] = "libero",
        images: bool = False,
        cameras: Sequence[str] = CAMERAS,
        image_size: int | tuple[int, int] = 256,
        image_convention: Convention = "opengl",
        fast_render: bool = False,
        render_mode: str | None = None,
        render_camera: str = CAMERAS[0],
        scene_seed: int | None = None,
        ontology: Sequence[str] = (),
    ) -> None:
        """Load the scene of a task from the cache, or compile it in some seconds.

        Args:
            task: ``SUITE/INDEX``, ``SUITE/NAME`` or the path of a task file.
            suite: With ``index``, the same in two parts.
            index: The task's number in its suite, from 0, or its name.
            state_index: The default official initial state.
            advance: How many states a reset without one advances, or ``"random"``; 0 repeats the same state.
            exact: Step bit for bit as the native environment does, at a third of the speed.
            settle: Control steps without motion after a reset to an official state; they do not count.
            horizon: Control steps until ``truncated``; default: the suite's.
            observables: The low-dimensional keys to observe; default: all.
            timing: ``"libero"`` observes one substep before the end of a step, as LIBERO does after a reset;
                ``"current"`` observes the end.
            images: Whether observations hold a picture ``CAMERA_image`` of each of ``cameras``.
            cameras: Names of cameras of the scene.
            image_size: Height and width of the pictures in pixels, or one number for both.
            image_convention: ``"opengl"`` has the lowest row first, as LIBERO; ``"opencv"`` the topmost.
            fast_render: Draw without shadows, reflections and multisampling.
            render_mode: None or ``"rgb_array"``; :meth:`render` then draws ``render_camera``, topmost row first.
            render_camera: The camera that :meth:`render` shows.
            scene_seed: Places the fixtures, which no initial state describes; default 0.
            ontology: Turtle files of your own, for predicates and rules.

        Raises:
            OntoError: ``SIM030`` for an option that makes no sense, and as ``onto ground`` for a task.
        """
        if render_mode not in {None, *self.metadata["render_modes"]}:
            raise OntoError.of("SIM030", f"there is no render mode `{render_mode}`", "it is None or rgb_array")
        if timing not in {"libero", "current"}:
            raise OntoError.of("SIM030", f"there is no timing `{timing}`", "it is libero or current")
        if settle < 0 or (horizon is not None and horizon < 1):
            raise OntoError.of("SIM030", f"settle is {settle} and horizon {horizon}", "they count control steps")
        self.render_mode = render_mode
        self._ref = chosen_task(task, suite, index)
        self.horizon = horizon_of(self._ref.suite) if horizon is None else horizon
        self._timing = timing
        knowledge = load_knowledge(*ontology)
        required = required_of(self._ref, knowledge)
        self.language = required.language
        self._required, self._schema = required, knowledge.schema
        drawing = images or render_mode is not None
        scene = compile_scene(self._ref.bddl, scene_seed or 0, pictures=drawing)
        self._simulation = Simulation(scene, exact=exact)
        self._starts = Starts(self._ref, scene, self._simulation.flat_state, state_index, advance, settle)
        spec = parse_file(self._ref.bddl)
        self._placements = None if scene_seed is not None else Placements(spec, scene.index)
        self._observer = Observer(scene, [declared.name for declared in spec.objects], observables)
        self._reporter = FactReporter(scene.index, required, knowledge)
        self._burners = StoveLights(scene, spec, knowledge.schema) if drawing else None
        self._scratch = mujoco.MjData(scene.model) if timing == "current" else None
        size = (image_size, image_size) if isinstance(image_size, int) else image_size
        self._views = Views(scene.model, cameras if images else (), size, image_convention, fast=fast_render)
        self._render_camera = render_camera
        self.observation_space = cast(
            "spaces.Space[Observed]", spaces.Dict({**self._views.spaces, **self._observer.spaces})
        )
        self.action_space = spaces.Box(-1.0, 1.0, (ACTION_SIZE,), np.float32)
        self._start: Start | None = None
        self._seen: Observed = {}
        self._steps = 0

    @property
    def simulation(self) -> Simulation:
        """The simulation itself, for snapshots and forks."""
        return self._simulation

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Observed, Info]:
        """Start an episode from ``options["state_index"]``, or a flat ``options["state"]`` (1 + nq + nv,).

        Without either, ``seed`` s starts from official state s modulo their number or, if the task has none, from
        LIBERO's reset with that seed, which places objects and fixtures again. Without a seed, the last requested
        state is used again, changed by ``advance``. A state of your own is judged as it is, unless
        ``options["settle"]`` gives it control steps without motion first. ``options["model"]`` is a file with the
        fixtures' poses: MJCF that was saved from the scene, or demonstrations.

        Raises ``SIM017`` for a state that the task does not have, ``SIM030`` for an unknown option, ``SIM003``,
        ``SIM004`` for a state of another scene, ``SIM023`` for a file without these poses, and ``SIM019`` if it
        diverges while settling.
        """
        super().reset(seed=seed)
        start = self._starts.choose(self._start, self.np_random, seed, options or {})
        simulation = self._simulation
        simulation.reset_to(start.state, start.fixtures)
        self._start = start  # now that it was fit
        if self._burners is not None:
            self._burners.reset()
            self._burners.update(simulation.data)
        if not start.settle:
            self._observe(simulation.data)
        try:
            for left in reversed(range(start.settle)):
                self._go(DUMMY_ACTION, look=left == 0)
        except RunFault as fault:
            message = f"the simulation of `{self._ref.name}` diverged while its state settled"
            raise OntoError.of("SIM019", message) from fault
        self._steps = 0
        return self._seen, self._info() | {"premise": self._reporter.premise(simulation.data)}

    def step(self, action: NDArray[np.float32]) -> tuple[Observed, float, bool, bool, Info]:
        """Take one control step with ``action`` (7,) in [-1, 1]; raises ``SIM021`` for what is no action."""
        fault = ""
        try:
            self._go(action)
        except RunFault as broken:
            fault = str(broken)
            self._observe(self._simulation.data)  # the last good state
        self._steps += 1
        info = self._info()
        if fault:
            info["fault"] = fault
        success = info["success"] and not fault
        return self._seen, float(success), success, bool(fault) or self._steps >= self.horizon, info

    def render(self) -> NDArray[np.uint8] | None:
        """The present state as (height, width, 3) RGB, topmost row first; None without a render mode."""
        if self.render_mode is None:
            return None
        return self._views.draw(self._simulation.data, self._render_camera)[::-1].copy()

    def close(self) -> None:
        """Free the OpenGL context and the environment for seeded resets."""
        self._views.close()
        self._starts.close()

    def _go(self, action: ArrayLike, *, look: bool = True) -> None:
        simulation, scratch = self._simulation, self._scratch
        before_last_substep = partial(self._observe, simulation.data) if look and scratch is None else None
        simulation.step(action, before_last_substep)
        if self._burners is not None:
            self._burners.update(simulation.data)
        if look and scratch is not None:  # a step leaves poses one substep behind qpos
            scratch.qpos[:], scratch.qvel[:] = simulation.data.qpos, simulation.data.qvel
            mujoco.mj_kinematics(simulation.model, scratch)
            mujoco.mj_comPos(simulation.model, scratch)
            mujoco.mj_camlight(simulation.model, scratch)
            self._observe(scratch)

    def _observe(self, data: mujoco.MjData) -> None:
        self._seen = {**self._views.look(data), **self._observer.read(data)}

    def _uncertain(self, report: GoalReport) -> tuple[Info, ...]:
        """The facts whose verdict depends on the fixtures' poses, which a state of your own does not include."""
        start = self._start
        if self._placements is None or start is None or start.index >= 0 or start.fixtures is not None:
            return ()
        found = self._placements.uncertain(self._required.facts, report.observation, self._simulation.data)
        return tuple(uncertain_row(each, self._schema) for each in found)

    @property
    def _scene_seed(self) -> int:
        """The seed of the reset that placed the fixtures, if no file gives their poses."""
        start = self._start
        return self._simulation.scene.seed if start is None or start.seed is None else start.seed

    def _info(self) -> Info:
        report = self._reporter.report(self._simulation.data, self._steps)
        return {
            "success": report.success,
            "is_success": report.success,  # LeRobot's name
            "judge": "grounding",
            "facts": report.facts,
            "failures": report.failures,
            "task": self._ref.name,
            "suite": self._ref.suite,
            "language": self.language,
            "scene_seed": self._scene_seed,
            "state_index": -1 if self._start is None else self._start.index,
            "uncertain": self._uncertain(report),
            "settle_steps": 0 if self._start is None else self._start.settle,
            "step": self._steps,
        }
