"""The world model of LIBERO-Goal's scene that ships."""

from __future__ import annotations

from pathlib import Path

__all__ = ["shipped"]

_HERE = Path(__file__).parent / "models"


def shipped(seed: int = 0) -> Path:
    """The folder of checkpoints that ``onto train libero --seed SEED`` made."""
    return _HERE / str(seed)
