"""The world models that ship: PointMaze, one for each training seed."""

from __future__ import annotations

from pathlib import Path

__all__ = ["SEEDS", "shipped"]

SEEDS = (0, 1, 2)
_HERE = Path(__file__).parent / "models"


def shipped(seed: int) -> Path:
    """The folder of checkpoints that ``onto train pointmaze --seed SEED`` made."""
    return _HERE / str(seed)
