"""The tables of docs/pointmaze.md: rows by success and distance, rows against each other, and what was predicted."""

from __future__ import annotations

from typing import Any

from benchmarks.markdown import rate, table
from benchmarks.pointmaze import BLOCKS, COMPARED, MEASURES, SPEED_METRICS, fact_names
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
        "trials of the mean over models, intervals are over trials; *over its ceiling*: the distance over that of a "
        "search on the true dynamics with the same budget, which is `ceiling` for plans of one budget and "
        "`ceiling_large` for those that may take four."
    )
    parts = (
        *(_of_rows(names, m), total, _compared(m), _told(m), _by_block(names, m), _predicted(names, m)),
        *(_answered(names, m), _by_chance(m), _speed(m)),
    )
    return "\n\n".join(part for part in parts if part)


def _of_rows(names: list[str], m: Metrics) -> str:
    heads = (
        *("row", "episodes", "success after 1", "2", "all plans", "distance [95 %]", "over its ceiling"),
        *("position, m", "velocity, m/s", "evaluations", "planning, s"),
    )
    lines = [
        (
            f"`{name}`",
            f"{m[f'{name}_n']:,}",
            *(f"{m[f'{name}_success_{plans}']:.3f}" for plans in (1, 2)),
            rate(m, f"{name}_success"),
            rate(m, f"{name}_distance"),
            _over_ceiling(name, m),
            *(f"{m[f'{name}_{part}']:.3f}" for part in ("position", "velocity")),
            f"{m[f'{name}_evaluations']:,.0f}",
            f"{m[f'{name}_planning_s']:.2f}",
        )
        for name in names
    ]
    return table(heads, lines)


def _over_ceiling(name: str, m: Metrics) -> str:
    ceiling = "ceiling_large" if ROWS[name].extended else "ceiling"
    known = f"{ceiling}_distance" in m
    return f"{m[f'{name}_distance'] / m[f'{ceiling}_distance']:.2f} (`{ceiling}`)" if known else "—"


_SUFFIXES = {measure: "" if measure == "distance" else f"_{measure}" for measure in MEASURES}
_TITLES = {"first_plan": "success after one plan", "position": "position, m", "velocity": "velocity, m/s"}
_MORE_IS_BETTER = {"first_plan"}


def _gaps(m: Metrics) -> dict[str, str]:
    """The comparisons that were made: the start of their metrics by name."""
    gaps = {name: name.replace("_vs_", "_minus_") for name in COMPARED}
    return {name: gap for name, gap in gaps.items() if gap in m}


def _compared(m: Metrics) -> str:
    lines = []
    for name, gap in _gaps(m).items():
        one, other = COMPARED[name]
        cells = []
        for measure, suffix in _SUFFIXES.items():
            interval = f"[{m[f'{gap}{suffix}.low']:+.3f}, {m[f'{gap}{suffix}.high']:+.3f}]"
            cells.append(f"{m[f'{gap}{suffix}']:+.3f} {interval} p {m[f'{name}{suffix}_p']:.2g}")
            if measure == "distance":
                models = (m[key] for key in sorted(m) if key.startswith(f"{gap}.model_"))
                cells.append(", ".join(f"{gap_of:+.3f}" for gap_of in models))
        lines.append((f"`{one}` less `{other}`", *cells))
    titles = [_TITLES.get(measure, measure) for measure in MEASURES]
    return table(("[95 %], p (Holm)", titles[0], "the same by model", *titles[1:]), lines) if lines else ""


def _told(m: Metrics) -> str:
    """What the intervals say: where they include zero, and where the first row is the worse one."""
    open_, worse = [], []
    for measure, suffix in _SUFFIXES.items():
        for name, gap in _gaps(m).items():
            one, other = COMPARED[name]
            low, high = (m[f"{gap}{suffix}.{end}"] for end in ("low", "high"))
            if low <= 0 <= high:
                open_.append((measure, f"`{one}` and `{other}`"))
            elif (low > 0) != (measure in _MORE_IS_BETTER):
                worse.append((measure, f"`{one}` than `{other}`"))
    if not _gaps(m):
        return ""
    return (
        "Models and trials are both resampled, so that the intervals speak of other trained models too; p is adjusted "
        f"for the comparisons of a column. No difference is shown in {_listed(open_)}. Worse is, in {_listed(worse)}."
    )


def _listed(found: list[tuple[str, str]]) -> str:
    by_measure: dict[str, list[str]] = {}
    for measure, pair in found:
        by_measure.setdefault(_TITLES.get(measure, measure).partition(",")[0], []).append(pair)
    return "; in ".join(f"{measure}: {', '.join(pairs)}" for measure, pairs in by_measure.items()) or "nothing"


def _by_chance(m: Metrics) -> str:
    start, end = "random_search_", ".bettered"
    rates = {key[len(start) : -len(end)]: m[key] for key in m if key.startswith(start) and key.endswith(end)}
    ruled = rates.pop("by_rule", None)
    if ruled is None:
        return ""
    others = ", ".join(
        f"`{name}` {share:.3f} of {m[f'{start}{name}.answered']:,}"
        for name, share in sorted(rates.items(), key=lambda item: -item[1])
    )
    return (
        f"Of the mechanisms that were drawn at random, those that the rules name first for the failure bettered the "
        f"plan in {ruled:.3f} of {m[f'{start}by_rule.answered']:,}; whatever failed: {others}."
    )


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
