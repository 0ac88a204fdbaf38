"""What a training is asked for, and what trains it: a world's own function, found by entry point."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

__all__ = ["GROUP", "Log", "Stage", "TrainingRequest", "given", "trained_worlds"]

GROUP = "onto_evwm.trainings"
"""Entry points that load a ``Callable[[TrainingRequest], Stage]``, by the name of the world."""

Log = Callable[[str], None]
Stage = Callable[[str, str, str, Log], Mapping[str, float]]
"""Stage, command, commit and what says how far it is, to the metrics of the stage's card."""


@dataclass(frozen=True, slots=True)
class TrainingRequest:
    """``folder`` gets the checkpoints; None leaves a choice to the world. ``demos`` lie there already."""

    folder: Path
    seed: int
    encoder: str | None = None
    threads: int = 0
    demos: Path | None = None
    count: int | None = None  # demonstrations of a task


def trained_worlds() -> dict[str, Any]:
    """The entry point of every world that a model can be trained of, by name; none is imported."""
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name)}


def given(**options: Any) -> dict[str, Any]:  # noqa: ANN401 - of any type
    """Those that are not None, so that defaults stay with what has them."""
    return {name: value for name, value in options.items() if value is not None}
