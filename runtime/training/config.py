"""What the training configurations of all worlds share."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["TrainingConfig"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingConfig:
    """Everything that determines a training; each world adds its data and its defaults.

    ``components`` are kept by the projection, ``members`` are the networks of the dynamics ensemble, and ``motion``,
    ``appearance`` and ``estimate`` are the optimiser steps of its parts.
    """

    encoder: str
    seed: int = 0
    components: int
    members: int = 3
    motion: int
    appearance: int
    estimate: int

    @property
    def data(self) -> dict[str, Any]:
        """The values by name, as a checkpoint's card records them."""
        return asdict(self)
