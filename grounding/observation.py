"""The observed ABox as arrays aligned with the required facts (paper, section 3: phi_sim and phi_pred)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Evidence", "Observation", "stack"]


@dataclass(frozen=True, slots=True)
class Evidence:
    """What one grounding function found for one atom.

    ``truth`` is the native predicate's own value. ``margin`` is signed, positive when satisfied, in the predicate's
    unit, NaN if none is defined; ``limit`` names the term that decides it (``contact``, ``x``, ``height`` ...).
    """

    truth: bool
    margin: float = float("nan")
    limit: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """Arrays of equal length; entry i is for required fact i.

    ``source`` is ``"sim"`` or ``"pred"``; ``observed`` is False if the grounder has no evidence at all; ``score`` is
    a world model's probability that the fact holds (NaN from a simulator).
    """

    source: str
    step: int
    observed: NDArray[np.bool_]
    truth: NDArray[np.bool_]
    margin: NDArray[np.float64]
    score: NDArray[np.float64]
    limit: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.truth)


def stack(source: str, step: int, evidence: Sequence[Evidence | None]) -> Observation:
    """Align ``evidence`` (None: nothing observed) into one :class:`Observation`."""
    nan = float("nan")
    return Observation(
        source=source,
        step=step,
        observed=np.array([e is not None for e in evidence], dtype=np.bool_),
        truth=np.array([e is not None and e.truth for e in evidence], dtype=np.bool_),
        margin=np.array([nan if e is None else e.margin for e in evidence], dtype=np.float64),
        score=np.full(len(evidence), nan),
        limit=tuple("" if e is None else e.limit for e in evidence),
    )
