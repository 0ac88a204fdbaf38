"""robosuite's tasks as Gymnasium environments, with typed facts and diagnoses of the goal in ``info``.

The package registers it: ``gymnasium.make("onto_evwm:onto/Robosuite-v0", task="robosuite/Lift")``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError, near
from runtime.worlds.facts import FactReporter
from runtime.worlds.native_import import quiet
from runtime.worlds.required import required_of
from runtime.worlds.robosuite.environment import RobosuiteEnvironment
from runtime.worlds.robosuite.native import INITIAL_STATES
from runtime.worlds.robosuite.world import WORLD
from runtime.worlds.world import task_named

__all__ = ["RobosuiteEnv"]

Observed = dict[str, NDArray[np.float64]]
Info = dict[str, Any]
_OPTIONS = ("state_index", "state")


class RobosuiteEnv(gymnasium.Env[Observed, NDArray[np.float32]]):
    """One task; an action is OSC_POSE's, and a step is a control step of 1/20 s.

    Observations are robosuite's low-dimensional ones under its own names. ``terminated`` is robosuite's success, with a
    reward of 1; ``truncated`` is the horizon, or a simulation that diverged (``info["fault"]``). ``info`` holds
    ``success`` and its ``judge``, robosuite itself, the typed ``facts`` of the goal, and in ``failures`` a diagnosis
    and a route for each that is unmet.
    """

    metadata = {"render_modes": []}  # noqa: RUF012  gymnasium declares it as an instance's

    def __init__(
        self, task: str, *, horizon: int | None = None, scene_seed: int = 0, ontology: Sequence[str] = ()
    ) -> None:
        """Build the environment of ``task`` (``robosuite/INDEX``, ``robosuite/NAME`` or a task file) in some seconds.

        Raises:
            OntoError: ``SIM030`` for a horizon that makes no sense, and as ``onto ground`` for a task.
        """
        if horizon is not None and horizon < 1:
            raise OntoError.of("SIM030", f"horizon is {horizon}", "it counts control steps")
        ref = task_named(task, WORLD.suites, WORLD.tasks)
        knowledge = load_knowledge(*ontology)
        required = required_of(ref, knowledge)
        self._opened = RobosuiteEnvironment(ref, required, knowledge.schema, scene_seed)
        self._reporter = FactReporter(self._opened.scene, required, knowledge)
        self._ref, self.language = ref, required.language
        self.horizon = WORLD.horizon(ref) if horizon is None else horizon
        self._steps = self._index = 0
        seen = self._observe()
        self.observation_space = cast(
            "spaces.Space[Observed]",
            spaces.Dict({name: spaces.Box(-np.inf, np.inf, each.shape, np.float64) for name, each in seen.items()}),
        )
        self.action_space = spaces.Box(-1.0, 1.0, (self._opened.task.env.action_dim,), np.float32)

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Observed, Info]:
        """Start from ``options["state_index"]``, or a flat ``options["state"]``, and let it settle.

        Without either, ``seed`` s starts from initial state s modulo their number, and no seed from the last one again.
        Raises ``SIM030`` for an unknown option, ``SIM017`` for an unknown state, and as ``onto ground`` otherwise.
        """
        super().reset(seed=seed)
        chosen = dict(options or {})
        for name in chosen:
            if name not in _OPTIONS:
                hint = near(name, _OPTIONS) or f"there are {', '.join(_OPTIONS)}"
                raise OntoError.of("SIM030", f"a reset has no option `{name}`", hint)
        index = chosen.get("state_index", self._index if seed is None else seed % INITIAL_STATES)
        self._opened.start(index, chosen.get("state"))
        self._index, self._steps = index, 0
        return self._observe(), self._info() | {"premise": self._reporter.premise(self._opened.data)}

    def step(self, action: NDArray[np.float32]) -> tuple[Observed, float, bool, bool, Info]:
        """Take one control step with ``action`` in [-1, 1]; raises ``SIM021`` for what is no action."""
        given = np.asarray(action, dtype=np.float64)
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            raise OntoError.of("SIM021", f"the action {action} is none of {self.action_space}")
        self._opened.task.step(given)
        self._steps += 1
        info, fault = self._info(), self._opened.task.diverged
        if fault:
            info["fault"] = "MuJoCo met a bad number"
        success = info["success"] and not fault
        return self._observe(), float(success), success, fault or self._steps >= self.horizon, info

    def close(self) -> None:
        """Free the environment."""
        self._opened.close()

    def _observe(self) -> Observed:
        with quiet():
            seen = self._opened.task.env._get_observations(force_update=True)  # noqa: SLF001  the only way
        return {name: np.atleast_1d(np.array(value, dtype=np.float64)) for name, value in seen.items()}

    def _info(self) -> Info:
        report, success = self._reporter.report(self._opened.data, self._steps), self._opened.task.success()
        return {
            "success": success,
            "is_success": success,
            "judge": "native",
            "facts": report.facts,
            "failures": report.failures,
            "task": self._ref.name,
            "suite": self._ref.suite,
            "language": self.language,
            "state_index": self._index,
            "step": self._steps,
        }
