"""A margin before and after as a small drawing: the threshold in the middle, the satisfied side shaded."""

from __future__ import annotations

from math import isfinite

from onto_compiler.html import Html, element
from runtime.wording import amount

__all__ = ["margin_bar"]

_WIDTH, _HEIGHT, _EDGE = 320, 46, 14
_LINE = 18  # y of the axis


def margin_bar(before: float, after: float, threshold: float, unit: str, *, polarity: bool, met: bool) -> Html:
    """An SVG of two margins in ``unit`` around ``threshold``; an empty string where neither is defined.

    ``polarity`` says on which side the fact is satisfied, ``met`` whether it is in the end (a margin alone does not).
    """
    shown = [value for value in (before, after) if isfinite(value)]
    if not shown:
        return Html("")
    limit = threshold if polarity else -threshold
    reach = max(*(abs(value - limit) for value in shown), 1e-9)

    def x(value: float) -> float:
        return _WIDTH / 2 + (value - limit) / reach * (_WIDTH / 2 - _EDGE)

    middle = _WIDTH / 2
    start = middle if polarity else 0
    parts = [
        f'<rect class="side" x="{start:g}" y="4" width="{middle:g}" height="28" rx="4"/>',
        f'<line class="axis" x1="0" y1="{_LINE}" x2="{_WIDTH}" y2="{_LINE}"/>',
        f'<line class="zero" x1="{middle:g}" y1="2" x2="{middle:g}" y2="34"/>',
    ]
    if len(shown) == 2:
        parts.append(f'<line class="way" x1="{x(before):.1f}" y1="{_LINE}" x2="{x(after):.1f}" y2="{_LINE}"/>')
    if isfinite(before):
        parts.append(f'<circle class="before" cx="{x(before):.1f}" cy="{_LINE}" r="6"/>')
    if isfinite(after):
        tone = "after" if met else "after bad"
        parts.append(f'<circle class="{tone}" cx="{x(after):.1f}" cy="{_LINE}" r="5.5"/>')
    bound = "0" if threshold == 0 else amount(limit, unit)
    for anchor, place, value in (("start", 0, -reach), ("end", _WIDTH, reach)):
        label = amount(limit + value, unit)
        parts.append(f'<text x="{place}" y="{_HEIGHT - 1}" text-anchor="{anchor}">{label}</text>')
    parts.append(f'<text x="{middle:g}" y="{_HEIGHT - 1}" text-anchor="middle">{bound}</text>')
    description = f"margin before {amount(before, unit)}, after {amount(after, unit)}, threshold {bound}"
    return element("svg", Html("".join(parts)), viewBox=f"0 0 {_WIDTH} {_HEIGHT}", role="img", aria_label=description)
