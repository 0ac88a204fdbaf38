"""Altered actions from the middle of a demonstration, as training data with failures.

Demonstrations succeed. A model trained on them alone predicts success for any actions, also for those of a planner that
lead nowhere. Each alteration below breaks another part of the demonstration.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["KINDS", "LENGTH", "altered"]

KINDS = ("noisy", "other", "open", "shut", "slow", "wander")
"""Noise on the hand's motion; actions from another time; a hand that opens or closes; a hand that stops short or turns
back; random motion."""
LENGTH = 50
"""Control steps."""
_MEMORY = 0.8
"""Correlation of noise from one step to the next."""

Actions = NDArray[np.float64]


def altered(actions: Actions, rng: np.random.Generator) -> tuple[int, str, Actions]:
    """Where to leave a demonstration of ``actions`` (T, 7), a multiple of 5; the kind, and actions (LENGTH, 7).

    Half of the time it is within the 40 steps before the fingers first or last move, where most is decided.
    """
    total = len(actions)
    moves = np.flatnonzero(np.diff(np.sign(actions[:, 6]))) + 1
    left = int(rng.integers(max(total - 10, 1)))
    if len(moves) and rng.random() < 0.5:
        left = int(rng.choice(moves[[0, -1]])) - int(rng.integers(40))
    left = max(left, 0) // 5 * 5
    kind = str(rng.choice(KINDS))
    future = np.zeros((LENGTH, 7))
    future[:, 6] = actions[-1, 6]
    rest = actions[left : left + LENGTH]
    future[: len(rest)] = rest
    begin = int(rng.integers(LENGTH // 2))
    if kind == "noisy":
        future[:, :6] += _noise(rng, (0.5, 0.5, 0.5, 0.15, 0.15, 0.15))
    elif kind == "other":
        start = int(rng.integers(max(total - LENGTH, 1)))
        some = actions[start : start + LENGTH]
        future[: len(some)] = some
    elif kind in {"open", "shut"}:
        future[begin:, 6] = -1.0 if kind == "open" else 1.0
    elif kind == "slow":
        future[:, :6] *= rng.uniform(-1.0, 0.6)
    else:
        future[:, :6] = _noise(rng, (0.8, 0.8, 0.8, 0.1, 0.1, 0.1))
        if rng.random() < 0.5:
            future[begin:, 6] = rng.choice([-1.0, 1.0])
    return left, kind, np.clip(future, -1.0, 1.0)


def _noise(rng: np.random.Generator, deviation: tuple[float, ...]) -> Actions:
    fresh = rng.standard_normal((LENGTH, len(deviation)))
    found = np.empty_like(fresh)
    found[0] = fresh[0]
    for step in range(1, LENGTH):
        found[step] = _MEMORY * found[step - 1] + np.sqrt(1 - _MEMORY**2) * fresh[step]
    return found * np.array(deviation, dtype=np.float64)
