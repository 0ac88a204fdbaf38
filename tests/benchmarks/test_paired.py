"""Paired comparisons, against what is known of them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.paired import bootstrap, crossed, holm, mcnemar


def test_no_difference_is_not_significant():
    assert crossed(np.zeros((3, 20))) == (0.0, 0.0, 1.0)
    p = [crossed(np.random.default_rng(seed).normal(size=(1, 40)))[2] for seed in range(60)]
    assert np.mean(np.array(p) < 0.05) < 0.17


def test_a_difference_of_every_model_and_trial_is_significant():
    low, high, p = crossed(np.full((3, 40), -0.3) + np.random.default_rng(0).normal(scale=0.01, size=(3, 40)))
    assert low < -0.3 < high < -0.29
    assert p < 1e-3


def test_a_difference_that_one_model_lacks_is_less_certain_than_its_trials_alone_say():
    random = np.random.default_rng(0)
    of_models = np.array([[-0.04], [0.01], [-0.05]]) + random.normal(scale=0.1, size=(3, 400))
    low, high, p = crossed(of_models)
    assert bootstrap(of_models.mean(axis=0))[1] < 0.0 < high
    assert p > 0.05
    assert low < of_models.mean() < high


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
