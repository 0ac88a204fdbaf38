"""Drawers: pull the handle out, or push the front in with closed fingers."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.contact import GripContact, twist_cost
from runtime.worlds.libero.skills.frames import Pose, axis_angle, frame
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.handles import Handle, protruding
from runtime.worlds.libero.skills.joints import Articulation
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["opens", "pulls", "pushes"]

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
LEVELS = (10.0, 18.0, 26.0, 32.0, 40.0, 50.0)  # degrees that the hand is raised above the handle's own direction
# Degrees that the hand is rolled about its approach: where there is no room for its width above a table, less of the
# handle is between the fingers.
ROLLS = (0.0, 30.0, -30.0, 54.0, -54.0)
TILTS = (45.0, 30.0, 60.0, 15.0, 0.0, 75.0)  # degrees of a pushing finger from the vertical
ALONG = (0.0, 0.02, -0.02)  # metres from the handle's middle
PAD = 0.010  # metres of the tips beyond the middle of what they grip
SIDE, FLAT = 0.0245, 0.0145  # half widths of the closed fingers: closing axis, lateral axis
BELOW = 0.016  # metres of the pushing tips below the handle's middle
CLEAR = 0.03
BACK = 0.05
SLIM = 0.03  # metres
THICKEST = 0.07


def opens(world: SkillWorld, art: Articulation) -> bool:
    """Whether the joint's way leads out of the body that carries the drawer: to where the drawer's handle points."""
    points = world.points([art.body])
    rest = world.points(b for b in world.shapes.bodies if world.model.body_parentid[art.body] == b)
    way = art.sign * art.axis
    if not len(rest):
        return True
    return bool((points @ way).max() > (rest @ way).max())


def pulls(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    """Grips of what protrudes farthest along the joint's way."""
    out = art.sign * art.axis
    handle = protruding(world.points([art.body]), out)
    if handle.thickness > THICKEST:
        return
    for roll, along, level in itertools.product(ROLLS, ALONG, LEVELS):
        angle = math.radians(level)
        approach = -math.cos(angle) * out - math.sin(angle) * UP
        rotation = frame(approach, handle.thin) @ axis_angle(np.array([0.0, 0.0, 1.0]), math.radians(roll))
        position = handle.centre + along * handle.long - (TIP - PAD) * approach
        cost = twist_cost(world, rotation) + 100 * abs(along)
        slim = roll == 0.0 and handle.thickness < SLIM
        yield GripContact(Pose(position, rotation), -BACK * approach, True, 1.0, cost, slim=slim)


def pushes(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    """Closed fingers before the front of the part, from above or slanting."""
    way = art.sign * art.axis
    handle = protruding(world.points([art.body]), -way)
    yield from sorted(_leaning(world, handle, way), key=lambda contact: contact.cost)


def _leaning(world: SkillWorld, handle: Handle, way: Array) -> Iterator[GripContact]:
    front = handle.centre - 0.5 * handle.depth * way
    for along, tilt, across in itertools.product(ALONG, TILTS, (False, True)):
        angle = math.radians(tilt)
        approach = math.sin(angle) * way - math.cos(angle) * UP
        rotation = frame(approach, np.cross(UP, way) if across else way)
        corners = np.array(list(itertools.product((-SIDE, SIDE), (-FLAT, FLAT), (TIP, -0.05)))) @ rotation.T
        foremost = float((corners @ way).max())
        lowest = float(corners[:, 2].min())
        anchor = front + along * handle.long
        position = anchor - (foremost + 0.002) * way
        position = np.array([position[0], position[1], anchor[2] - BELOW - lowest])
        cost = twist_cost(world, rotation) + 100 * abs(along)
        yield GripContact(Pose(position, rotation), -CLEAR * way, False, 1.0, cost)
