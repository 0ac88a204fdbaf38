"""Knobs: pinch the grip of a small part that turns about an upright axis, and twist it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.contact import GripContact, twist_cost
from runtime.worlds.libero.skills.frames import Pose, frame
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.handles import Handle, protruding
from runtime.worlds.libero.skills.joints import Articulation
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["twists"]

Array = NDArray[np.float64]

# Degrees of the approach from the axis, along the grip, away from the arm where positive. Upright hands near the base
# stretch the wrist into its singularity, where OSC turns joints 5 and 7 against each other until one is at its limit.
LEANS = (-30.0, -40.0, -20.0, 0.0, 15.0, 30.0, 45.0)
TOP = 0.018  # metres of the part below its top that are gripped
PADS = (0.012, 0.016, 0.008)  # metres of the tips below the top
BACK = 0.05
SLIM = 0.03
WIDEST = 0.072


def twists(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    """Grips across the thinner side of what stands out of the part along its axis."""
    up = art.axis if art.axis[2] >= 0.0 else -art.axis
    handle = protruding(world.points([art.body]), up, TOP)
    if handle.thickness > WIDEST:
        return
    yield from sorted(_grips(world, art, handle, up), key=_cost)


def _grips(world: SkillWorld, art: Articulation, handle: Handle, up: Array) -> Iterator[GripContact]:
    top = art.anchor + ((handle.centre - art.anchor) @ up + 0.5 * handle.depth) * up
    forward = handle.long * (1.0 if handle.long @ (art.anchor - world.base) >= 0.0 else -1.0)
    for pad, lean in itertools.product(PADS, LEANS):
        angle = math.radians(lean)
        approach = math.sin(angle) * forward - math.cos(angle) * up
        rotation = frame(approach, handle.thin)
        position = top - pad * up - TIP * approach
        cost = 0.5 * abs(lean - LEANS[0]) + 0.3 * twist_cost(world, rotation) + 300 * abs(pad - PADS[0])
        yield GripContact(Pose(position, rotation), -BACK * approach, True, 1.0, cost, slim=handle.thickness < SLIM)


def _cost(contact: GripContact) -> float:
    return contact.cost
