"""A predicate's conditions as numbers that compiled code can read: ids of one scene, bounds, and a contact.

A plan never decides what the predicate means: :mod:`grounding.compiled` leaves every state near a bound to the
grounding function that the plan stands beside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Box", "Disc", "Joints", "Plan", "Sides", "SiteBox"]

Bounds = tuple[float, float, float]
Sides = tuple[NDArray[np.intp], NDArray[np.intp]]
"""The geoms of either side, of which two must meet."""


@dataclass(frozen=True, slots=True)
class Box:
    """``low < xmat @ (origin - site) < high`` in every coordinate (metres), and the contact where there is one."""

    body: int
    site: int
    low: Bounds
    high: Bounds
    contact: Sides | None = None


@dataclass(frozen=True, slots=True)
class SiteBox:
    """``-half < origin - site < half`` with ``half = abs(xmat @ size)``, ``sink`` metres deeper below (metres)."""

    body: int
    site: int
    size: Bounds
    sink: float


@dataclass(frozen=True, slots=True)
class Disc:
    """Origin of ``upper`` not below that of ``lower``, nearer than ``radius`` from above, and the contact."""

    upper: int
    lower: int
    radius: float
    contact: Sides


@dataclass(frozen=True, slots=True)
class Joints:
    """``sign * (qpos - bound) > 0`` for every joint, or for any (radians or metres)."""

    addresses: tuple[int, ...]
    sign: float
    bound: float
    every: bool


Plan = Box | SiteBox | Disc | Joints
