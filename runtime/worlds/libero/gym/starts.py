"""The initial state of an episode."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, near
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.libero.demos.fixtures import fixtures_of
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["Advance", "Start", "Starts"]

Advance: TypeAlias = int | Literal["random"]
SEEDS = 2**32
"""The number of seeds of numpy's global generator, which LIBERO draws from."""
_OPTIONS = ("state_index", "state", "settle", "model")


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A flat ``state`` (1 + nq + nv,) and its official index; -1 for a state of your own.

    ``settle`` control steps without motion follow before it is judged. ``fixtures`` are the poses from a file, or those
    of the scene's seed. ``seed`` is that of the reset, if a task has no official states.
    """

    index: int
    state: NDArray[np.float64]
    settle: int
    fixtures: FixturePoses | None = None
    seed: int | None = None


class Starts:
    """The official initial states of a task; where it has none, LIBERO's seeded resets, one for each seed.

    ``fresh`` is the one of the scene's own seed.
    """

    def __init__(
        self, ref: TaskRef, scene: CompiledScene, fresh: NDArray[np.float64], index: int, advance: Advance, settle: int
    ) -> None:
        """Read the states; raises ``SIM017`` if ``index`` is none of them, ``SIM030`` for another ``advance``."""
        if advance != "random" and (not isinstance(advance, int) or isinstance(advance, bool)):
            raise OntoError.of("SIM030", f"advance is `{advance}`", "it is a number of states, or random")
        self._name, self._advance, self._settle = ref.name, advance, settle
        self._scene = scene
        self._seeded = not ref.initial_states.is_file()
        self._native: NativeTask | None = None
        self._states = fresh[None] if self._seeded else initial_states(ref)
        self._first = self._official(index)

    def __len__(self) -> int:
        return len(self._states)

    def choose(
        self, last: Start | None, rng: np.random.Generator, seed: int | None, options: Mapping[str, Any]
    ) -> Start:
        """The start of the next episode; ``last`` is that of the present one.

        The ``options`` take precedence, then ``seed``, then ``last``, changed by ``advance``; a state of your own is
        repeated. An official state settles for the default number of steps, your own not at all, unless
        ``options["settle"]`` says how long; ``options["model"]`` is a file with the fixtures' poses. Raises ``SIM017``,
        ``SIM030``, and ``SIM023`` for that file.
        """
        for name in options:
            if name not in _OPTIONS:
                hint = near(name, _OPTIONS) or f"there are {', '.join(_OPTIONS)}"
                raise OntoError.of("SIM030", f"a reset has no option `{name}`", hint)
        start = self._chosen(last, rng, seed, options)
        if "model" in options:
            start = replace(start, fixtures=fixtures_of(str(options["model"]), self._scene.model))
        if "settle" not in options:
            return start
        steps = options["settle"]
        if not isinstance(steps, (int, np.integer)) or isinstance(steps, bool) or steps < 0:
            raise OntoError.of("SIM030", f"settle is `{steps}`", "it counts control steps: 0, 1, 2, ...")
        return replace(start, settle=int(steps))

    def _chosen(
        self, last: Start | None, rng: np.random.Generator, seed: int | None, options: Mapping[str, Any]
    ) -> Start:
        if "state" in options:
            return Start(-1, np.array(options["state"], dtype=np.float64), 0)
        if "state_index" in options:
            return self._official(options["state_index"])
        return self._next(last, rng) if seed is None else self._trial(seed)

    def _next(self, last: Start | None, rng: np.random.Generator) -> Start:
        """The default start after ``last``."""
        if self._advance == "random":
            return self._trial(int(rng.integers(SEEDS if self._seeded else len(self))))
        if last is None:
            return self._first
        if last.index < 0 or not self._advance:
            return last
        return self._trial((last.index if last.seed is None else last.seed) + self._advance)

    def close(self) -> None:
        """Free the native environment that draws seeded starts."""
        if self._native is not None:
            self._native.close()
            self._native = None

    def _trial(self, number: int) -> Start:
        """Official state ``number`` modulo their count; without any, LIBERO's reset with that seed."""
        if not self._seeded:
            return self._official(number % len(self))
        seed = number % SEEDS
        if self._native is None:
            self._native = NativeTask(self._scene.bddl, self._scene.seed)
        native = self._native
        native.reset_seeded(seed)
        state = np.concatenate(([native.data.time], native.data.qpos, native.data.qvel))
        fixtures = FixturePoses(native.model.body_pos.copy(), native.model.body_quat.copy())
        return Start(0, state, self._settle, fixtures, seed)

    def _official(self, index: Any) -> Start:  # noqa: ANN401  whatever a caller of reset gave
        if not isinstance(index, (int, np.integer)) or isinstance(index, bool) or not 0 <= index < len(self):
            raise OntoError.of("SIM017", f"`{self._name}` has no initial state {index}", f"it has {len(self)}, from 0")
        return Start(int(index), self._states[index], self._settle, seed=self._scene.seed if self._seeded else None)
