"""PointMaze as a Gymnasium environment: states or pictures, with typed facts and diagnoses of the goal in ``info``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal, cast

import gymnasium
import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from grounding.scenes import Scene
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError, near
from runtime.worlds.facts import FactReporter
from runtime.worlds.pointmaze.grounded import place, required_facts
from runtime.worlds.pointmaze.maze import ACTION_DIM, FRAME_SKIP, STATE_DIM, TIME_STEP, maze_named
from runtime.worlds.pointmaze.picture import SIZE, draw
from runtime.worlds.pointmaze.rollout import Rollout, checked_states
from runtime.worlds.pointmaze.trials import trial_in
from runtime.worlds.pointmaze.verdict import judge

__all__ = ["HORIZON", "PointMazeEnv"]

Observed = dict[str, NDArray[Any]]
Info = dict[str, Any]
HORIZON = 100
"""Environment steps: four plans of 25."""
_RENDERED = 224
_FRESH, _TRIALS = 10_000, 1_000_000
"""A reset without a seed draws a trial number from this range."""
_OPTIONS = ("trial", "state", "goal")


class PointMazeEnv(gymnasium.Env[Observed, NDArray[np.float32]]):
    """A ball in a maze; an action is a force along x and y in [-1, 1], and a step lasts 1/20 s.

    ``terminated`` is the published success, the ball nearer than 0.5 m to the target, with a reward of 1; ``truncated``
    is the horizon. ``info`` holds ``success``, the distances from the goal, ``progress`` (how many metres nearer to it
    than at the start), the typed ``facts`` of the goal with their margins, and in ``failures`` a diagnosis and a plan
    route for each that is unmet.
    """

    metadata = {  # noqa: RUF012  gymnasium declares it as an instance's
        "render_modes": ["rgb_array"],
        "render_fps": round(1 / (FRAME_SKIP * TIME_STEP)),
    }

    def __init__(  # the names are what gymnasium.make passes on
        self,
        maze: str = "u_maze",
        *,
        observe: Literal["state", "pixels"] = "state",
        size: int = SIZE,
        horizon: int = HORIZON,
        terminate: bool = True,
        render_mode: str | None = None,
        ontology: Sequence[str] = (),
    ) -> None:
        """Build the maze.

        Args:
            maze: One of :data:`runtime.worlds.pointmaze.maze.MAZES`.
            observe: ``"state"`` gives ``state`` and ``goal`` (4,): metres and metres per second; ``"pixels"`` gives
                pictures ``pixels`` and ``goal_pixels`` (size, size, 3) instead.
            size: Width and height of a picture in pixels.
            horizon: Environment steps until ``truncated``.
            terminate: Whether an episode ends with its success; otherwise it goes on to the horizon.
            render_mode: None or ``"rgb_array"``.
            ontology: Turtle files of your own, for predicates and rules.

        Raises:
            OntoError: ``PMZ002`` for an unknown maze, ``PMZ007`` for an option that makes no sense.
        """
        if render_mode not in {None, *self.metadata["render_modes"]}:
            raise OntoError.of("PMZ007", f"there is no render mode `{render_mode}`", "it is None or rgb_array")
        if observe not in {"state", "pixels"}:
            raise OntoError.of("PMZ007", f"nothing observes `{observe}`", "it is state or pixels")
        if horizon < 1:
            raise OntoError.of("PMZ007", f"the horizon is {horizon}", "it counts environment steps")
        self.render_mode = render_mode
        self.maze = maze_named(maze)
        self._observe, self._size, self._horizon, self._terminate = observe, size, horizon, terminate
        self._rollout = Rollout(self.maze)
        knowledge = load_knowledge(*ontology)
        required = required_facts(knowledge)
        self.language = required.language
        self._task = required.task
        self._reporter = FactReporter(Scene(self.maze.model), required, knowledge, level="plan")
        self._data = mujoco.MjData(self.maze.model)
        state = spaces.Box(-np.inf, np.inf, (STATE_DIM,), np.float64)
        picture = spaces.Box(0, 255, draw(self.maze, np.empty((0, STATE_DIM)), size).shape[1:], np.uint8)
        names, space = (("state", "goal"), state) if observe == "state" else (("pixels", "goal_pixels"), picture)
        self.observation_space = cast("spaces.Space[Observed]", spaces.Dict(dict.fromkeys(names, space)))
        self.action_space = spaces.Box(-1.0, 1.0, (ACTION_DIM,), np.float32)
        self._state = np.zeros(STATE_DIM)
        self._goal = np.zeros(STATE_DIM)
        self._shown: NDArray[np.uint8] = np.empty((0,), np.uint8)
        self._far = 0.0
        self._trial = -1
        self._steps = 0

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Observed, Info]:
        """Start trial ``options["trial"]``, or from ``options["state"]`` (4,) towards ``options["goal"]`` (4,).

        Without either, ``seed`` s is trial s (modulo a million). Without a seed, too, the seeded generator draws a
        trial of number 10,000 or more, which no table uses. Raises ``PMZ003`` and ``PMZ004`` for an invalid state,
        ``PMZ005`` for an unknown trial, ``PMZ007`` for an unknown option.
        """
        super().reset(seed=seed)
        self._trial, start, goal = self._begin(seed, options or {})
        self._state, self._goal, self._steps = start, goal, 0
        self._far = float(judge(start, goal).position)
        self._shown = draw(self.maze, goal[None], self._size)[0]
        return self._observation(), self._info() | {"premise": self._reporter.premise(self._data)}

    def step(self, action: NDArray[np.float32]) -> tuple[Observed, float, bool, bool, Info]:
        """Hold the force ``action`` (2,) for five steps of MuJoCo.

        Raises ``PMZ003`` for another shape and ``PMZ004`` for numbers that are not finite.
        """
        forces = np.asarray(action)
        if forces.shape != (ACTION_DIM,):
            raise OntoError.of("PMZ003", f"found an action of shape {forces.shape}", f"expected ({ACTION_DIM},)")
        self._state = self._rollout.states(self._state[None], forces[None, None])[0, -1]
        self._steps += 1
        info = self._info()
        success = bool(info["success"])
        return self._observation(), float(success), success and self._terminate, self._steps >= self._horizon, info

    def render(self) -> NDArray[np.uint8] | None:
        """The maze from above, (224, 224, 3) RGB; None without a render mode."""
        return None if self.render_mode is None else draw(self.maze, self._state[None], _RENDERED)[0]

    def _begin(
        self, seed: int | None, options: Mapping[str, Any]
    ) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
        """The trial's number, -1 for states of your own, with its start and goal."""
        for name in options:
            if name not in _OPTIONS:
                hint = near(name, _OPTIONS) or f"there are {', '.join(_OPTIONS)}"
                raise OntoError.of("PMZ007", f"a reset has no option `{name}`", hint)
        if "state" in options or "goal" in options:
            if set(options) != {"state", "goal"}:
                raise OntoError.of("PMZ007", "a start without its goal, or with a trial", "give both state and goal")
            start, goal = (np.array(checked_states(options[name])) for name in ("state", "goal"))
            if start.shape != (STATE_DIM,) or goal.shape != (STATE_DIM,):
                message = f"found a state of shape {start.shape} and a goal of shape {goal.shape}"
                raise OntoError.of("PMZ003", message, f"expected ({STATE_DIM},) for either")
            return -1, start, goal
        drawn = int(self.np_random.integers(_FRESH, _TRIALS)) if seed is None else seed % _TRIALS
        number = options.get("trial", drawn)
        if not isinstance(number, (int, np.integer)) or isinstance(number, bool):
            raise OntoError.of("PMZ005", f"there is no trial {number}", "trials are numbered from 0")
        chosen = trial_in(self.maze, int(number))
        return chosen.number, chosen.start, chosen.goal

    def _observation(self) -> Observed:
        if self._observe == "state":
            return {"state": self._state.copy(), "goal": self._goal.copy()}
        return {"pixels": draw(self.maze, self._state[None], self._size)[0], "goal_pixels": self._shown.copy()}

    def _info(self) -> Info:
        place(self._data, self.maze, self._state, self._goal)
        report = self._reporter.report(self._data, self._steps)
        verdict = judge(self._state, self._goal)
        return {
            "success": bool(verdict.success),
            "is_success": bool(verdict.success),
            "judge": "native",
            "state_distance": float(verdict.distance),
            "position_distance": float(verdict.position),
            "velocity_distance": float(verdict.velocity),
            "progress": self._far - float(verdict.position),
            "facts": report.facts,
            "failures": report.failures,
            "task": self._task,
            "language": self.language,
            "trial": self._trial,
            "step": self._steps,
        }
