"""Tables in Markdown, and the line under each that says how its figures were made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

__all__ = ["origin", "rate", "table"]


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with one line of ``heads``, and as many cells in each of ``rows``.

    Raises:
        ValueError: where a row has more or fewer cells, which Markdown would drop or leave empty.
    """
    lines = [tuple(heads), ("---",) * len(heads), *map(tuple, rows)]
    if odd := [line for line in lines if len(line) != len(heads)]:
        raise ValueError(f"{odd[0]} under {tuple(heads)}")
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rate(metrics: Mapping[str, float], name: str) -> str:
    """A rate with its interval."""
    return f"{metrics[name]:.3f} [{metrics[f'{name}.low']:.3f}, {metrics[f'{name}.high']:.3f}]"


def origin(result: Mapping[str, Any]) -> str:
    """Command, commit, date, seeds and machine of a result; before it, how its parts came about that were run apart."""
    runs: dict[str, list[str]] = {}
    for name, part in result.get("parts", {}).items():
        on = f" on {_processors(part)}" if "cpu" in part else ""
        run = f"`{part['command']}` at commit `{part['commit'][:12]}` on {part['date'][:10]}{on}"
        runs.setdefault(run, []).append(f"`{name}`")
    parts = "; ".join(f"{', '.join(names)}: {run}" for run, names in runs.items())
    machine = result["machine"]
    versions = ", ".join(f"{name} {number}" for name, number in machine["versions"].items())
    made = (
        f"Made by `{result['command']}` at commit `{result['commit'][:12]}` on {result['date'][:10]}, seed "
        f"{', '.join(map(str, result['seeds']))}; {_processors(machine)}, {machine['cores']} cores; {versions}."
    )
    return f"{parts}.\n\n{made}" if parts else made


def _processors(machine: Mapping[str, Any]) -> str:
    return " and ".join(machine[kind] for kind in ("cpu", "gpu") if kind in machine)
