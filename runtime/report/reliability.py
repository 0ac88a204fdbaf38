"""How often a predicted fact holds, by the score that it was predicted with; and that as a drawing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from onto_compiler.html import Html, element

__all__ = ["Reliability", "reliability", "reliability_diagram"]

_SIDE, _EDGE, _LARGEST = 180.0, 24.0, 9.0


@dataclass(frozen=True, slots=True, eq=False)
class Reliability:
    """Of each bin that holds a prediction: mean ``score``, ``share`` that held, and ``count``; ``error`` is the ECE."""

    score: NDArray[np.float64]
    share: NDArray[np.float64]
    count: NDArray[np.int64]
    error: float


def reliability(score: NDArray[np.float64], held: NDArray[np.bool_], bins: int = 10) -> Reliability:
    """Bin predictions (N,) by their score, 0 to 1, in ``bins`` of equal width; NaN as the error of none at all."""
    place = np.clip((score * bins).astype(np.int64), 0, bins - 1)
    count = np.bincount(place, minlength=bins)
    full = count > 0
    number = np.maximum(count, 1)
    mean = np.bincount(place, weights=score, minlength=bins) / number
    share = np.bincount(place, weights=held.astype(np.float64), minlength=bins) / number
    error = float((count * np.abs(mean - share)).sum() / len(score)) if len(score) else float("nan")
    return Reliability(mean[full], share[full], count[full], error)


def reliability_diagram(found: Reliability, label: str) -> Html:
    """An SVG: score to the right, share that held upwards; a disc's area is how many predictions it stands for."""

    def x(value: float) -> float:
        return _EDGE + value * (_SIDE - 2 * _EDGE)

    def y(value: float) -> float:
        return _SIDE - x(value)

    low, high = x(0.0), x(1.0)
    wide = high - low
    parts = [
        f'<rect class="frame" x="{low:g}" y="{low:g}" width="{wide:g}" height="{wide:g}"/>',
        f'<line class="axis" x1="{low:g}" y1="{high:g}" x2="{high:g}" y2="{low:g}"/>',
    ]
    most = max(found.count.tolist(), default=1)
    for score, share, count in zip(found.score.tolist(), found.share.tolist(), found.count.tolist(), strict=True):
        radius = max(_LARGEST * (count / most) ** 0.5, 1.5)
        parts.append(f'<circle class="bin" cx="{x(score):.1f}" cy="{y(share):.1f}" r="{radius:.1f}"/>')
    for value in (0, 1):
        parts.append(f'<text x="{x(value):g}" y="{_SIDE - 10:g}" text-anchor="middle">{value}</text>')
        parts.append(f'<text x="{low - 6:g}" y="{y(value) + 4:g}" text-anchor="end">{value}</text>')
    parts.append(f'<text x="{_SIDE / 2:g}" y="{_SIDE - 10:g}" text-anchor="middle">score</text>')
    return element("svg", Html("".join(parts)), viewBox=f"0 0 {_SIDE:g} {_SIDE:g}", role="img", aria_label=label)
