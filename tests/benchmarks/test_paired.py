"""Paired comparisons, against what is known of them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.paired import bootstrap, holm, mcnemar, sign_flip


def test_no_difference_is_not_significant():
    assert sign_flip(np.zeros(20)) == 1.0
    p = [sign_flip(np.random.default_rng(seed).normal(size=40), seed) for seed in range(200)]
    assert 0.01 < np.mean(np.array(p) < 0.05) < 0.11


def test_a_difference_of_every_pair_is_as_rare_as_its_signs():
    assert sign_flip(np.ones(5)) == pytest.approx(2 / 2**5, rel=0.15)
    assert sign_flip(np.full(40, -0.3)) < 1e-4


def test_the_interval_of_a_mean_holds_it_nineteen_times_in_twenty():
    held = 0
    for seed in range(100):
        low, high = bootstrap(np.random.default_rng(seed).exponential(size=80), seed)
        held += low < 1.0 < high
    assert held >= 86


def test_holm_adjusts_in_order_and_never_below_a_smaller_one():
    found = holm({"a": 0.01, "b": 0.04, "c": 0.03})
    assert found == pytest.approx({"a": 0.03, "b": 0.06, "c": 0.06})
    assert holm({"a": 0.9, "b": 0.8})["a"] == 1.0


@pytest.mark.parametrize(
    ("one", "other", "p"), [(0, 0, 1.0), (6, 0, 2 / 64), (5, 5, 1.0), (1, 7, 18 / 256), (7, 1, 18 / 256)]
)
def test_discordant_pairs_are_as_rare_as_heads_of_a_coin(one, other, p):
    assert mcnemar(one, other) == pytest.approx(p)
