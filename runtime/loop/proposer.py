"""The interface of proposers, for heuristics and learned ones alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.scenes import Scene
from onto_compiler.required import RequiredABox
from runtime.loop.records import Diagnosis, Proposal

__all__ = ["Proposer", "Request"]


@dataclass(frozen=True, slots=True)
class Request:
    """The arguments of P_r(s, A*_g, d): geometry through ``scene``, never a task name.

    ``qpos`` (nq,) and ``qvel`` (nv,) are the current state. ``candidate`` counts what this route already proposed for
    this fact in this episode. ``observe`` grounds the required facts on a scratch copy in which ``qpos`` was written.
    """

    scene: Scene
    qpos: NDArray[np.float64]
    qvel: NDArray[np.float64]
    required: RequiredABox
    diagnosis: Diagnosis
    candidate: int
    observe: Callable[[NDArray[np.float64]], Observation]
    rng: np.random.Generator


class Proposer(Protocol):
    """Generates one proposal per call, or None when it has no further candidate."""

    name: str

    def propose(self, request: Request) -> Proposal | None:
        """Return candidate number ``request.candidate`` for ``request.diagnosis``."""
        ...
