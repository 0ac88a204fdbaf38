"""The tables of docs/pointmaze.md: rows by success and distance, rows against each other, and what was predicted."""

from __future__ import annotations

from typing import Any

from benchmarks.markdown import rate, table
from benchmarks.pointmaze import BLOCKS, COMPARED, SPEED_METRICS, fact_names
from onto_compiler.knowledge import load_knowledge
from onto_compiler.schema import local_name
from runtime.worlds.pointmaze.planning.rows import ROWS

__all__ = ["pointmaze_table"]

Metrics = dict[str, float]
_FALSE = ("false_satisfied", "false_missing")


def pointmaze_table(result: dict[str, Any]) -> str:
    """One line per row; one per comparison; predicted facts; what takes how long."""
    m = result["metrics"]
    names = [name for name in ROWS if f"{name}_n" in m]
    total = (
        f"{m['trials']} trials, {m['training_seeds']} trained models, {m['crashed']} crashed. Distances are means over "
        "trials of the mean over models, intervals are over trials; *of the ceiling*: the distance over that of the "
        "same search on the true dynamics."
    )
    parts = (
        *(_of_rows(names, m), total, _compared(m), _by_block(names, m), _predicted(names, m), _answered(names, m)),
        _speed(m),
    )
    return "\n\n".join(part for part in parts if part)


def _of_rows(names: list[str], m: Metrics) -> str:
    heads = (
        *("row", "episodes", "success after 1", "2", "all plans", "distance [95 %]", "of the ceiling"),
        *("position, m", "velocity, m/s", "evaluations", "planning, s"),
    )
    lines = [
        (
            f"`{name}`",
            f"{m[f'{name}_n']:,}",
            *(f"{m[f'{name}_success_{plans}']:.3f}" for plans in (1, 2)),
            rate(m, f"{name}_success"),
            rate(m, f"{name}_distance"),
            f"{m[f'{name}_distance'] / m['ceiling_distance']:.2f}" if "ceiling_distance" in m else "—",
            *(f"{m[f'{name}_{part}']:.3f}" for part in ("position", "velocity")),
            f"{m[f'{name}_evaluations']:,.0f}",
            f"{m[f'{name}_planning_s']:.2f}",
        )
        for name in names
    ]
    return table(heads, lines)


def _compared(m: Metrics) -> str:
    lines = []
    for name, (one, other) in COMPARED.items():
        gap = name.replace("_vs_", "_minus_")
        if gap in m:
            interval = f"{m[gap]:+.3f} [{m[f'{gap}.low']:+.3f}, {m[f'{gap}.high']:+.3f}]"
            lines.append((f"`{one}` less `{other}`", interval, f"{m[f'{name}_p']:.2g}"))
    return table(("the final distance of", "difference [95 %]", "p (paired, Holm)"), lines) if lines else ""


def _by_block(names: list[str], m: Metrics) -> str:
    heads = ("row", *(f"{block}: {what}" for block in BLOCKS for what in ("success", "distance")))
    lines = [
        (f"`{name}`", *(_shown(m, f"{name}_{block}_{what}") for block in BLOCKS for what in ("success", "distance")))
        for name in names
    ]
    return table(heads, lines)


def _predicted(names: list[str], m: Metrics) -> str:
    """Shares of executed plans whose end was predicted otherwise than the simulator showed, where it was observed."""
    facts = fact_names()
    lines = [
        (f"`{name}`", *(_shown(m, f"{name}_{fact}.{what}") for fact in facts for what in _FALSE))
        for name in names
        if f"{name}_{facts[0]}.{_FALSE[0]}" in m
    ]
    heads = ("row", *(f"`{fact}` {what.replace('_', ' ')}" for fact in facts for what in _FALSE))
    return table(heads, lines) if lines else ""


def _answered(names: list[str], m: Metrics) -> str:
    """Of each predicted failure and each mechanism that answered it: how often, and how often to the better."""
    schema = load_knowledge().schema
    called = {local_name(failure): schema.notations.get(failure, local_name(failure)) for failure in schema.failures}
    kinds = sorted({tuple(name.split(".")[1:3]) for name in m if name.endswith(".answers")})
    rows = [name for name in names if any(f"{name}.{failure}.{mechanism}.answers" in m for failure, mechanism in kinds)]
    lines = [
        (f"`{called[failure]}`", f"`{mechanism}`", *(_share(m, f"{name}.{failure}.{mechanism}") for name in rows))
        for failure, mechanism in kinds
    ]
    return (
        table(("predicted failure", "answered by", *(f"`{name}`: bettered" for name in rows)), lines) if lines else ""
    )


def _share(m: Metrics, name: str) -> str:
    return f"{m[f'{name}.better']:.2f} of {m[f'{name}.answers']:,}" if f"{name}.answers" in m else "—"


def _speed(m: Metrics) -> str:
    return "; ".join(f"`{name}` {m[name]:g}" for name in SPEED_METRICS if name in m)


def _shown(m: Metrics, name: str) -> str:
    return f"{m[name]:.3f}" if name in m else "—"
