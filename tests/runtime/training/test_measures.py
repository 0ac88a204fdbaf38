"""AUROC and calibration error, against their definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runtime.training.measures import auroc, calibration_error

CASES = st.lists(st.tuples(st.integers(0, 5), st.booleans()), min_size=1, max_size=40)


@given(CASES)
def test_auroc_is_how_often_a_true_one_scores_higher(cases: list[tuple[int, bool]]):
    scores = np.array([score for score, _ in cases], dtype=np.float64)
    truth = np.array([held for _, held in cases])
    pairs = [(a > b) + 0.5 * (a == b) for a in scores[truth] for b in scores[~truth]]
    found = auroc(scores, truth)
    assert math.isnan(found) if not pairs else found == pytest.approx(np.mean(pairs))


def test_a_calibrated_score_has_no_calibration_error():
    random = np.random.default_rng(0)
    scores = random.random(200_000)
    assert calibration_error(scores, random.random(200_000) < scores) < 0.01
    assert calibration_error(np.full(1000, 0.9), np.arange(1000) < 500) == pytest.approx(0.4)
    assert calibration_error(np.ones(10), np.ones(10, dtype=bool)) == 0.0
