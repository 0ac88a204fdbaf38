"""The configuration of the training of LIBERO-Goal's world model."""

from __future__ import annotations

from dataclasses import dataclass

from runtime.training.config import TrainingConfig

__all__ = ["SceneTrainingConfig"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneTrainingConfig(TrainingConfig):
    """``demos`` demonstrations, from trials of seed ``demo_seed``, of each task in ``indices`` (empty: of all tasks).

    ``facts`` and ``events`` are the optimiser steps of the two heads.
    """

    encoder: str = "lite0:block7:128"
    demos: int = 40
    demo_seed: int = 0
    indices: tuple[int, ...] = ()
    components: int = 256
    motion: int = 5000
    appearance: int = 3000
    estimate: int = 1500
    facts: int = 3000
    events: int = 3000
