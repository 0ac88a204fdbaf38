"""A chart of a fact's margin along a trial: simulated step by step, and as the plans predicted it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from onto_compiler.html import Html, element

__all__ = ["margin_chart"]

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP = 320, 120, 38, 18, 8
_LETTER = 11.0
"""The height of a label."""


def margin_chart(
    true: NDArray[np.float64],
    predicted: Sequence[tuple[NDArray[np.int64], NDArray[np.float64]]],
    unit: str,
    label: str,
    required: float = 0.0,
) -> Html:
    """An SVG of the ``true`` margin (T + 1,) after each step and of each plan's ``predicted`` steps and margins.

    The satisfied side of what is ``required`` is shaded.
    """
    shown = np.concatenate([true, *(margins for _, margins in predicted), [0.0, required]])
    low, high = float(shown.min()), float(shown.max())
    room = 0.05 * max(high - low, 1e-6)
    low, high = low - room, high + room
    last = max(len(true) - 1, *(int(steps.max()) for steps, _ in predicted if len(steps)), 1)

    def x(step: float) -> float:
        return _LEFT + step / last * (_WIDTH - _LEFT - 6)

    def y(margin: float) -> float:
        return _TOP + (high - margin) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)

    def line(steps: Sequence[float], margins: Sequence[float], kind: str) -> str:
        points = " ".join(f"{x(step):.1f},{y(margin):.1f}" for step, margin in zip(steps, margins, strict=True))
        return f'<polyline class="{kind}" points="{points}"/>'

    limit = y(required)
    parts = [
        f'<rect class="side" x="{_LEFT}" y="{_TOP}" width="{_WIDTH - _LEFT - 6}" height="{limit - _TOP:.1f}"/>',
        f'<line class="axis" x1="{_LEFT}" y1="{y(0.0):.1f}" x2="{_WIDTH - 6}" y2="{y(0.0):.1f}"/>',
        line(range(len(true)), true.tolist(), "executed"),
    ]
    for steps, margins in predicted:
        parts.append(line(steps.tolist(), margins.tolist(), "imagined"))
        parts += [
            f'<circle class="guess" cx="{x(step):.1f}" cy="{y(margin):.1f}" r="3"/>'
            for step, margin in zip(steps.tolist(), margins.tolist(), strict=True)
        ]
    ends = [margin for margin in (low + room, high - room) if abs(y(margin) - y(0.0)) > _LETTER]
    for margin in (*ends, 0.0):
        parts.append(f'<text x="{_LEFT - 4}" y="{y(margin) + 3:.1f}" text-anchor="end">{margin:.2g}</text>')
    for step in (0, last):
        anchor = "start" if step == 0 else "end"
        parts.append(f'<text x="{x(step):.1f}" y="{_HEIGHT - 4}" text-anchor="{anchor}">step {step}</text>')
    parts.append(f'<text x="{(x(0) + x(last)) / 2:.1f}" y="{_HEIGHT - 4}" text-anchor="middle">{unit}</text>')
    return element("svg", Html("".join(parts)), viewBox=f"0 0 {_WIDTH} {_HEIGHT}", role="img", aria_label=label)
