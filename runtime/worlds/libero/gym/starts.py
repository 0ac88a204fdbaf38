"""From which initial state an episode starts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, near
from runtime.worlds.libero.demos.fixtures import fixtures_of
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.fixtures import FixturePoses

__all__ = ["Advance", "Start", "Starts"]

Advance: TypeAlias = int | Literal["random"]
_OPTIONS = ("state_index", "state", "settle", "model")


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """A flat ``state`` (1 + nq + nv,), and which official one that is; -1 for a state of one's own.

    ``settle`` control steps without motion follow it before it is judged. ``fixtures`` stand where a file says, or
    where the scene's seed has placed them.
    """

    index: int
    state: NDArray[np.float64]
    settle: int
    fixtures: FixturePoses | None = None


class Starts:
    """The official initial states of a task; its seeded reset, ``fresh``, where it has none."""

    def __init__(
        self, ref: TaskRef, fresh: NDArray[np.float64], index: int, advance: Advance, settle: int, model: mujoco.MjModel
    ) -> None:
        """Read the states; raises ``SIM017`` where ``index`` is none of them, ``SIM030`` for another ``advance``."""
        if advance != "random" and (not isinstance(advance, int) or isinstance(advance, bool)):
            raise OntoError.of("SIM030", f"advance is `{advance}`", "it is a number of states, or random")
        self._name, self._advance, self._settle = ref.name, advance, settle
        self._model = model
        self._states = initial_states(ref) if ref.initial_states.is_file() else fresh[None]
        self._first = self._official(index)

    def __len__(self) -> int:
        return len(self._states)

    def choose(
        self, last: Start | None, rng: np.random.Generator, seed: int | None, options: Mapping[str, Any]
    ) -> Start:
        """The start of the next episode, ``last`` being that of the present one.

        What ``options`` name goes first, then the trial ``seed``, then ``last``, moved on by ``advance``; a state of
        one's own stays. An official state settles as long as all do, and one's own not at all, unless
        ``options["settle"]`` says how long; ``options["model"]`` is a file that says where fixtures stand. Raises
        ``SIM017``, ``SIM030``, and ``SIM023`` for that file.
        """
        for name in options:
            if name not in _OPTIONS:
                hint = near(name, _OPTIONS) or f"there are {', '.join(_OPTIONS)}"
                raise OntoError.of("SIM030", f"a reset has no option `{name}`", hint)
        start = self._chosen(last, rng, seed, options)
        if "model" in options:
            start = replace(start, fixtures=fixtures_of(str(options["model"]), self._model))
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
        if seed is not None:
            return self._official(seed % len(self))
        if self._advance == "random":
            return self._official(int(rng.integers(len(self))))
        if last is None:
            return self._first
        return last if last.index < 0 else self._official((last.index + self._advance) % len(self))

    def _official(self, index: Any) -> Start:  # noqa: ANN401  whatever a caller of reset gave
        if not isinstance(index, (int, np.integer)) or isinstance(index, bool) or not 0 <= index < len(self):
            raise OntoError.of("SIM017", f"`{self._name}` has no initial state {index}", f"it has {len(self)}, from 0")
        return Start(int(index), self._states[index], self._settle)
