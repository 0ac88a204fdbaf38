"""Disturbances of a skill's actions: noise, pushes, misplaced grasps, and objects that slip. All are seeded.

A skill is a closed loop, so that it may recover from a disturbance. The executed action is recorded; the skill's
intended action is stored too, for learning from noisy demonstrations (Laskey et al., "DART: Noise Injection for Robust
Imitation Learning", 2017).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Disturber", "Strength"]

Array = NDArray[np.float64]
OPEN = -1.0
FIRST, LAST = 8, 90  # control steps in which a push may begin


@dataclass(frozen=True, slots=True)
class Strength:
    """The strength of disturbances of severity 1; an action of 1 means 50 mm or 0.5 rad.

    With the gain of the skills, an ``offset`` of 0.3 puts the hand 5 mm beside its target.
    """

    noise: float = 0.15  # standard deviation of the translation's noise
    twist: float = 0.05  # of the rotation's
    memory: float = 0.7  # correlation of the noise from one step to the next
    offset: float = 0.15  # standard deviation of the horizontal offset of an approach
    push: float = 0.6  # the chance of a push in an episode
    shove: float = 0.8  # how hard the push is
    slip: float = 0.2  # the chance that a held object is let go


@dataclass(slots=True)
class Disturber:
    """Disturbs one episode; ``severity`` in [0, 1] scales everything, and 0 leaves the actions unchanged."""

    rng: np.random.Generator
    severity: float
    strength: Strength = field(default_factory=Strength)
    events: list[Mapping[str, Any]] = field(default_factory=list)
    step: int = 0
    _noise: Array = field(default_factory=lambda: np.zeros(6))
    _offset: Array = field(default_factory=lambda: np.zeros(2))
    _push: Array = field(default_factory=lambda: np.zeros(3))
    _pushed: range = range(0)
    _slips: int = 0  # shut steps after which the fingers open
    _open_for: int = 0
    _shut: int = 0

    def __post_init__(self) -> None:
        """Draw what will happen."""
        rng, strength = self.rng, self.strength
        happens = rng.random(2) < self.severity * np.array([strength.push, strength.slip])
        start, length = int(rng.integers(FIRST, LAST)), int(rng.integers(4, 9))
        direction = rng.normal(size=3)
        direction[2] = abs(direction[2])  # not into the table
        slip, gap = int(rng.integers(14, 45)), int(rng.integers(4, 7))
        if happens[0]:
            self._pushed = range(start, start + length)
            self._push = self.severity * strength.shove * direction / np.linalg.norm(direction)
        if happens[1]:
            self._slips, self._open_for = slip, gap
        self._aim()

    def __call__(self, action: Array) -> Array:
        """The executed action (7,) for a skill's ``action`` (7,)."""
        strength, size = self.strength, self.severity
        fresh = self.rng.normal(size=6) * np.repeat([strength.noise, strength.twist], 3) * size
        self._noise = strength.memory * self._noise + np.sqrt(1.0 - strength.memory**2) * fresh
        done = action.copy()
        moving = bool(np.any(action[:6]))
        if moving and size > 0.0:
            done[:6] += self._noise
            if action[6] < 0.0:
                done[:2] += self._offset
        if self.step in self._pushed:
            done[:3] += self._push
            if self.step == self._pushed.start:
                self._note("push", len(self._pushed), self._push)
        done[6] = self._finger(float(action[6]))
        self.step += 1
        return np.clip(done, -1.0, 1.0)

    def _finger(self, wanted: float) -> float:
        if wanted < 0.0:
            if self._shut:
                self._aim()
            self._shut = 0
            return wanted
        self._shut += 1
        if self._open_for and self._shut > self._slips:
            if self._shut == self._slips + 1:
                self._note("slip", self._open_for, None)
            self._open_for -= 1
            return OPEN
        return wanted

    def _aim(self) -> None:
        """Draw the offset of the next approach."""
        self._offset = self.rng.normal(size=2) * self.strength.offset * self.severity
        self._note("offset", 0, self._offset)

    def _note(self, kind: str, steps: int, vector: Array | None) -> None:
        if self.severity > 0.0:
            action = [] if vector is None else np.round(vector, 6).tolist()
            self.events.append({"kind": kind, "step": self.step, "steps": steps, "action": action})
