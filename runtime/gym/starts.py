"""From which initial state an episode starts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, near
from runtime.simulator.assets import TaskRef, initial_states

__all__ = ["Advance", "Starts"]

Advance: TypeAlias = int | Literal["random"]
_OPTIONS = ("state_index", "state")


class Starts:
    """The official initial states of a task (its seeded reset, ``fresh``, where it has none), and whose turn it is."""

    def __init__(self, ref: TaskRef, fresh: NDArray[np.float64], index: int, advance: Advance) -> None:
        """Read the states; raises ``SIM017`` where ``index`` is none of them, ``SIM030`` for another ``advance``."""
        self._name = ref.name
        self._states = initial_states(ref) if ref.initial_states.is_file() else fresh[None]
        self._own: NDArray[np.float64] | None = None
        if advance != "random" and not isinstance(advance, int):
            raise OntoError.of("SIM030", f"advance is `{advance}`", "it is a number of states, or random")
        self._advance = advance
        self._first = True
        self.index = self._checked(index)
        """The official state that the present episode started from; -1 for a state that was given whole."""

    def __len__(self) -> int:
        return len(self._states)

    def choose(self, rng: np.random.Generator, seed: int | None, options: Mapping[str, Any]) -> NDArray[np.float64]:
        """The flat state (1 + nq + nv,) for the next episode.

        What ``options`` name goes first, then the trial ``seed``, then the state of the last episode, moved on by
        ``advance``. Raises ``SIM017``, ``SIM030``.
        """
        for name in options:
            if name not in _OPTIONS:
                hint = near(name, _OPTIONS) or f"there are {', '.join(_OPTIONS)}"
                raise OntoError.of("SIM030", f"a reset has no option `{name}`", hint)
        if "state" in options:
            self.index, self._own = -1, np.array(options["state"], dtype=np.float64)
        elif "state_index" in options:
            self.index, self._own = self._checked(options["state_index"]), None
        elif seed is not None:
            self.index, self._own = seed % len(self), None
        elif self._advance == "random":
            self.index, self._own = int(rng.integers(len(self))), None
        elif not self._first and self._own is None:
            self.index = (self.index + int(self._advance)) % len(self)
        self._first = False
        return self._states[self.index] if self._own is None else self._own

    def _checked(self, index: Any) -> int:  # noqa: ANN401  whatever a caller of reset gave
        if not isinstance(index, (int, np.integer)) or isinstance(index, bool) or not 0 <= index < len(self):
            raise OntoError.of("SIM017", f"`{self._name}` has no initial state {index}", f"it has {len(self)}, from 0")
        return int(index)
