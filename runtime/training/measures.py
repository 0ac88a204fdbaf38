"""How good a head is, on data that it was not trained on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["auroc", "calibration_error"]


def auroc(scores: NDArray[np.floating], truth: NDArray[np.bool_]) -> float:
    """The area under the ROC curve of ``scores`` (N,) for ``truth`` (N,): ties count a half; NaN without both kinds."""
    positive = int(truth.sum())
    negative = len(truth) - positive
    if not positive or not negative:
        return float("nan")
    _, place, count = np.unique(scores, return_inverse=True, return_counts=True)
    last = np.cumsum(count)
    rank = (last - (count - 1) / 2)[place]
    return float((rank[truth].sum() - positive * (positive + 1) / 2) / (positive * negative))


def calibration_error(scores: NDArray[np.floating], truth: NDArray[np.bool_], bins: int = 15) -> float:
    """The expected calibration error of probabilities ``scores`` (N,), over ``bins`` of equal width."""
    place = np.minimum((scores * bins).astype(np.int64), bins - 1)
    weight = np.bincount(place, minlength=bins)
    predicted = np.bincount(place, weights=scores, minlength=bins)
    observed = np.bincount(place, weights=truth.astype(np.float64), minlength=bins)
    return float(np.abs(predicted - observed).sum() / max(weight.sum(), 1))
