"""A request for training, and the world's function that carries it out, found by entry point."""

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
"""From stage, command, commit and log to the metrics of the stage's card."""


@dataclass(frozen=True, slots=True)
class TrainingRequest:
    """``folder`` is for the checkpoints, ``demos`` has existing demonstrations; None leaves a choice to the world."""

    folder: Path
    seed: int
    encoder: str | None = None
    threads: int = 0
    demos: Path | None = None
    count: int | None = None  # demonstrations of a task


def trained_worlds() -> dict[str, Any]:
    """The entry points of all worlds with a training, by name; none is imported."""
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name)}


def given(**options: Any) -> dict[str, Any]:  # noqa: ANN401 - of any type
    """The options that are not None, so that defaults are defined in one place."""
    return {name: value for name, value in options.items() if value is not None}
