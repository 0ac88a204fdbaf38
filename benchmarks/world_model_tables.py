"""The tables of LIBERO-Goal's world model: each fact by the source of its prediction, each predicate, and the rest."""

from __future__ import annotations

from typing import Any

from benchmarks.markdown import table

__all__ = ["WAYS", "world_model_libero_table"]

WAYS = ("imagined", "seen", "still")
"""The source of a prediction: the model's imagination, the final state itself, or the truth at the start."""

_UNITS = {"m": (1000, "mm"), "rad": (1000, "mrad")}


def world_model_libero_table(result: dict[str, Any]) -> str:
    """One line per fact; one per predicate; a note on events, counts and windows of altered actions."""
    m = result["metrics"]
    units = {row["fact"]: row["unit"] for row in result["rows"] if row.get("fact")}
    return "\n\n".join((_by_fact(m, units), _by_predicate(m, units), _note(m)))


def _by_fact(m: dict[str, float], units: dict[str, str]) -> str:
    heads = (
        *("fact after 25 steps", "true", "begins to hold", "AUROC [95 %]", "of the end as seen", "persistence"),
        *("its own tasks", "persistence", "and false before", "persistence"),
        *("margin error", "as seen", "persistence", "ECE"),
    )
    lines = []
    for name, unit in units.items():
        factor, symbol = _UNITS.get(unit, (1, unit))
        errors = (f"{factor * m[f'{name}.{way}_mae']:.1f} {symbol}" for way in WAYS)
        low, high = (m.get(f"{name}.imagined_auroc.{side}") for side in ("low", "high"))
        span = "" if low is None or high is None else f" [{low:.3f}, {high:.3f}]"
        lines.append(
            (
                f"`{name}`",
                *(f"{m[f'{name}.{count}']:.0f}" for count in ("positives", "onsets")),
                f"{_rank(m, f'{name}.imagined_auroc')}{span}",
                *(_rank(m, f"{name}.{way}_auroc") for way in WAYS[1:]),
                *(
                    _rank(m, f"{name}.{way}_{key}_auroc")
                    for key in ("own", "own_onset")
                    for way in ("imagined", "still")
                ),
                *errors,
                f"{m[f'{name}.imagined_ece']:.3f}",
            )
        )
    return table(heads, lines)


def _by_predicate(m: dict[str, float], units: dict[str, str]) -> str:
    heads = (
        *("predicate", "true", "AUROC", "of the end as seen", "persistence", "ECE"),
        *("true, altered", "AUROC, altered", "of the end as seen", "persistence"),
    )
    lines = []
    for predicate in sorted({name.partition("(")[0] for name in units}):
        cells = []
        for prefix in ("", "altered."):
            cells.append(f"{m.get(f'{prefix}{predicate}.positives', 0):.0f}")
            cells += [_rank(m, f"{prefix}{predicate}.{way}_auroc") for way in WAYS]
            cells += [f"{m[f'{predicate}.imagined_ece']:.3f}"] if not prefix else []
        lines.append((f"`{predicate}`", *cells))
    return table(heads, lines)


def _note(m: dict[str, float]) -> str:
    events = (
        f" Of the events, success is ranked with an AUROC of {_rank(m, 'event.success_auroc')} (ECE "
        f"{m['event.success_ece']:.3f}), feasibility with {_rank(m, 'event.feasibility_auroc')}; the time until the "
        f"goal holds is told within {m['event.remaining_mae_s']:.2f} s."
        if "event.success_ece" in m
        else ""
    )
    return (
        f"{m['windows']:,.0f} windows of {m['demonstrations']:.0f} demonstrations, and {m['altered_windows']:,.0f} of "
        f"actions that leave one; {m['crashed']:.0f} crashed. Of {m['facts_ranked']:.0f} facts with 30 positives or "
        f"more, the lowest AUROC is {_rank(m, 'auroc_min')} (persistence {_rank(m, 'still_auroc_min')}; of the end as "
        f"seen {_rank(m, 'seen_auroc_min')}), among the windows of its own tasks {_rank(m, 'imagined_own_auroc_min')} "
        f"({_rank(m, 'still_own_auroc_min')}; {_rank(m, 'seen_own_auroc_min')}), and in those of altered actions "
        f"{_rank(m, 'altered.imagined_auroc_min')} ({_rank(m, 'altered.still_auroc_min')}; "
        f"{_rank(m, 'altered.seen_auroc_min')}).{events}"
    )


def _rank(m: dict[str, float], name: str) -> str:
    return f"{m[name]:.3f}" if name in m else "—"
