"""A maze as an open task: a trial's start and goal, grounded, and judged by the published success."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.predicates.planar import target_address
from grounding.scenes import Scene
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from onto_compiler.versions import version_of
from runtime.loop.records import Verification
from runtime.worlds.environment import StateEnvironment
from runtime.worlds.flat_state import FlatStates, write_qpos
from runtime.worlds.pointmaze.grounded import place
from runtime.worlds.pointmaze.maze import STATE_DIM, TARGET, maze_named
from runtime.worlds.pointmaze.trials import PUBLISHED, trial_in
from runtime.worlds.pointmaze.verdict import judge
from runtime.worlds.world import TaskRef

__all__ = ["OpenMaze"]

_FULL = mujoco.mjtState.mjSTATE_INTEGRATION


class _MazeState:
    """The state of one maze, with its target; nothing moves by itself."""

    diverged = False

    def __init__(self, name: str) -> None:
        self.maze = maze_named(name)
        self.data = mujoco.MjData(self.maze.model)

    @property
    def model(self) -> mujoco.MjModel:
        return self.maze.model

    def write_qpos(self, qpos: ArrayLike) -> None:
        write_qpos(self.model, self.data, qpos, self.maze.name)

    def settle(self, steps: int) -> None:
        """A maze is judged without settling, since the ball's velocity is part of the goal."""

    def snapshot(self) -> NDArray[np.float64]:
        saved = np.empty(mujoco.mj_stateSize(self.model, _FULL))
        mujoco.mj_getState(self.model, self.data, saved, _FULL)
        return saved

    def restore(self, saved: Any) -> None:  # noqa: ANN401  the protocol's
        mujoco.mj_setState(self.model, self.data, saved, _FULL)
        mujoco.mj_forward(self.model, self.data)


class OpenMaze(StateEnvironment):
    """What :class:`~runtime.worlds.pointmaze.world.PointMaze` opens."""

    judged = True

    def __init__(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> None:
        """The maze that the task is named after; raises ``PMZ002`` for an unknown one."""
        self._state = _MazeState(required.problem)
        super().__init__(self._state, Scene(self._state.model), required, schema)
        self.seed, self._name = seed, ref.name

    def verify_natively(self) -> Verification:
        """The published success: the ball is nearer to the target than 0.5 m."""
        data, address = self.data, target_address(self.model, TARGET)
        here = np.concatenate([data.qpos, data.qvel])
        return Verification("eval_state", bool(judge(here, data.userdata[address : address + STATE_DIM]).success))

    def settle(self, verification: Verification) -> Verification:
        """The verdict as it is, since nothing settles."""
        return replace(verification, settled=None)

    def start(self, index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Trial ``index``; or a flat ``state`` (5,: time, x, y, vx, vy) towards the goal of trial 0.

        A maze does not settle; ``settle`` is ignored. Raises ``SIM017`` if there is no such trial,
        ``SIM003``, ``SIM004`` for an invalid state.
        """
        del settle
        if state is None and not 0 <= index < PUBLISHED:
            message = f"`{self._name}` has no initial state {index}"
            raise OntoError.of("SIM017", message, f"it has {PUBLISHED} trials, from 0")
        trial = trial_in(self._state.maze, index if state is None else 0)
        begun = trial.start if state is None else FlatStates(self.model, self._name).checked(state)[1:]
        place(self.data, self._state.maze, begun, trial.goal)
        mujoco.mj_forward(self.model, self.data)
        return 0

    def place(self, model: str) -> None:
        """Refuse: the maze's walls are the task's."""
        raise OntoError.of("SIM023", "a model file places nothing in a maze", "leave out --model", model)

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """Nothing: a state of the maze is complete."""
        return ()

    def versions(self) -> dict[str, str]:
        """Versions of the packages that affect physical results."""
        found = {name: version_of(name) for name in ("onto-evwm", "mujoco", "numpy")}
        return {name: version for name, version in found.items() if version is not None}

    def close(self) -> None:
        """Nothing is held."""
