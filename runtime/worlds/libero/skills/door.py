"""Doors on hinges: push the leaf along its arc with closed fingers, or pull it open by its handle first."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.contact import GripContact, twist_cost
from runtime.worlds.libero.skills.frames import Pose, frame
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.handles import protruding
from runtime.worlds.libero.skills.joints import Articulation
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["pulls", "sweeps"]

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
FRACTIONS = (0.85, 0.7, 0.95, 0.55)  # of the leaf's width from the hinge
DEPTHS = (0.03, 0.06, 0.1)  # metres of the tips below the leaf's upper edge
TILTS = (0.0, 20.0, 40.0)  # degrees that the fingers lean into the push
SIDE, FLAT = 0.0245, 0.0145  # half widths of the closed fingers: closing axis, lateral axis
CLEAR = 0.04
LEVELS = (45.0, 30.0, 60.0, 15.0)  # degrees that the hand is raised above the handle's own direction
AJAR = (0.5, 0.6, 0.4, 0.8)  # radians: wide enough for the fingers to reach behind the leaf
PAD = 0.010  # metres of the tips beyond the middle of what they grip
BACK = 0.05
THICKEST = 0.07
BAND = 0.012  # metres on either side of the finger that count as in its way


def sweeps(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    """Closed fingers beside the leaf, on the side that it has to turn away from."""
    yield from sorted(_beside(world, art), key=lambda contact: contact.cost)


def _beside(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    points = world.points([art.body])
    radii = art.radii(points)
    width, top = float(radii.max()), float(points[:, 2].max())
    for fraction, depth, tilt, turned in itertools.product(FRACTIONS, DEPTHS, TILTS, (False, True)):
        radius = fraction * width
        band = np.abs(radii - radius) < FLAT + BAND
        if not band.any():
            continue
        at = points[band].mean(axis=0)
        way = art.direction(at)
        angle = math.radians(tilt)
        approach = math.sin(angle) * way - math.cos(angle) * UP
        rotation = frame(approach, np.cross(UP, way) if turned else way)
        corners = np.array(list(itertools.product((-SIDE, SIDE), (-FLAT, FLAT), (TIP, -0.05)))) @ rotation.T
        behind = float((points[band] @ way).min())
        position = at + (behind - float(at @ way) - float((corners @ way).max()) - 0.003) * way
        position = np.array([position[0], position[1], top - depth - float(corners[:, 2].min())])
        cost = twist_cost(world, rotation) + 20 * (1 - fraction)
        yield GripContact(Pose(position, rotation), -CLEAR * way, False, 0.0, cost)


def pulls(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    """Grips of the leaf's handle that open it far enough to be swept from behind; the handle turns in the fingers."""
    points = world.points([art.body])
    out = art.direction(points[int(art.radii(points).argmax())])
    handle = protruding(points, out)
    if handle.thickness > THICKEST:
        return
    for ajar, level in itertools.product(AJAR, LEVELS):
        until = art.start + art.sign * ajar
        if art.left(until) <= 0.0:
            continue
        angle = math.radians(level)
        approach = -math.cos(angle) * out - math.sin(angle) * UP
        rotation = frame(approach, handle.thin)
        position = handle.centre - (TIP - PAD) * approach
        yield GripContact(Pose(position, rotation), -BACK * approach, True, 0.0, twist_cost(world, rotation), until)
