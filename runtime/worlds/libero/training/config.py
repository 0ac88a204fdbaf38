"""What decides a training of LIBERO-Goal's world model, every number of it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["SceneTrainingConfig"]


@dataclass(frozen=True, slots=True)
class SceneTrainingConfig:
    """``demos`` demonstrations of each of the tasks ``indices`` (all without), of trials of ``demo_seed``."""

    encoder: str = "lite0:block7:128"
    seed: int = 0
    demos: int = 40
    demo_seed: int = 0
    indices: tuple[int, ...] = ()
    components: int = 256
    members: int = 3
    motion: int = 5000
    appearance: int = 3000
    estimate: int = 1500
    facts: int = 3000
    events: int = 3000

    @property
    def data(self) -> dict[str, Any]:
        """What a card says of it."""
        return asdict(self)
