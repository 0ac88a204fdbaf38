"""Paired comparisons: the same trials under two methods."""

from __future__ import annotations

from collections.abc import Mapping
from math import comb

import numpy as np
from numpy.typing import NDArray

__all__ = ["bootstrap", "holm", "mcnemar", "sign_flip"]

_DRAWS = 20_000


def sign_flip(differences: NDArray[np.float64], seed: int = 0) -> float:
    """The two-sided p of a mean difference of zero, by flipping signs at random; never below one in the draws."""
    random = np.random.default_rng(seed)
    observed = abs(differences.mean())
    if not len(differences) or observed == 0:
        return 1.0
    hits = 0
    for _ in range(20):
        signs = random.integers(0, 2, size=(_DRAWS // 20, len(differences))) * 2 - 1
        hits += int((np.abs((signs * differences).mean(axis=1)) >= observed - 1e-12).sum())
    return (hits + 1) / (_DRAWS + 1)


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
