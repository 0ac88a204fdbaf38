"""Paired comparisons: the same trials under two methods."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray

__all__ = ["bootstrap", "crossed", "holm", "mcnemar"]

_DRAWS = 20_000


def crossed(differences: NDArray[np.float64], seed: int = 0) -> tuple[float, float, float]:
    """The 95 % interval of the mean of ``differences`` (models, trials), and the two-sided p that it is zero.

    Models and trials are both resampled, each independently of the other, as two random effects that are crossed: the
    figures speak of other models too. With few models the interval is rather too narrow than too wide.

    Source: A. B. Owen, The pigeonhole bootstrap, Annals of Applied Statistics 1 (2007) 386-411.
    """
    of_models, of_trials = _resampled(*differences.shape, seed)
    means = (of_models * (of_trials @ differences.T)).sum(axis=1) / differences.size
    low, high = np.quantile(means, [0.025, 0.975])
    beyond = min(int((means <= 0).sum()), int((means >= 0).sum()))
    return float(low), float(high), min(1.0, 2 * (beyond + 1) / (_DRAWS + 1))


@lru_cache(maxsize=1)
def _resampled(models: int, trials: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How often each draw takes each model, (draws, models), and each trial, (draws, trials)."""
    random = np.random.default_rng(seed)
    drawn = (random.multinomial(count, np.full(count, 1 / count), size=_DRAWS) for count in (models, trials))
    of_models, of_trials = (each.astype(np.float64) for each in drawn)
    return of_models, of_trials


def mcnemar(only_one: int, only_other: int) -> float:
    """The exact two-sided p that of two methods either succeeds alone as often: the binomial test of discordant pairs.

    Source: Q. McNemar, Psychometrika 12 (1947) 153-157, with the exact distribution.
    """
    discordant = only_one + only_other
    tail = sum(comb(discordant, fewer) for fewer in range(min(only_one, only_other) + 1))
    return min(1.0, 2.0 * tail / float(2**discordant))


def bootstrap(values: NDArray[np.float64], seed: int = 0) -> tuple[float, float]:
    """The 95 % percentile interval of the mean of ``values``."""
    random = np.random.default_rng(seed)
    means = [values[random.integers(len(values), size=(500, len(values)))].mean(axis=1) for _ in range(20)]
    low, high = np.quantile(np.concatenate(means), [0.025, 0.975])
    return float(low), float(high)


def holm(p: Mapping[str, float]) -> dict[str, float]:
    """Holm's adjustment of p values by name, for all of them together."""
    order = sorted(p, key=lambda name: p[name])
    found, largest = {}, 0.0
    for place, name in enumerate(order):
        largest = max(largest, min(1.0, (len(order) - place) * p[name]))
        found[name] = largest
    return found
