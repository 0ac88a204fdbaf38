"""Press down an object that leans on the front of a drawer, so that it lies flat and the drawer can be closed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.scene.targets import PlacementTarget
from runtime.worlds.libero.skills.frames import Pose, frame, nearest_twin
from runtime.worlds.libero.skills.grasping import TIP
from runtime.worlds.libero.skills.motion import CLOSED, Motion, action_towards, reach
from runtime.worlds.libero.skills.transit import transit
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["inward", "leans", "press"]

Array = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
LEANING = 0.15  # rad
RAISED = 0.006  # metres below the top, that count as the raised side
INSIDE = 0.010  # metres from there, along the way in, to where it is pressed
ABOVE = 0.03  # metres, before the press
DEEP = 0.05  # metres of pressing at most
STROKE = 0.02  # metres that each step asks for
CREEP = 0.01
STEPS = 35


def inward(world: SkillWorld, place: PlacementTarget) -> Array | None:
    """The direction (3,) in which the drawer of ``place`` closes; None if it is in no drawer."""
    if place.site is None or not place.contains:
        return None
    model, data = world.model, world.data
    body = int(model.site_bodyid[world.index.site(place.site)])
    for joint in world.index.joints(place.site):
        if int(model.jnt_bodyid[joint]) == body:
            way = -float(data.qpos[model.jnt_qposadr[joint]]) * data.xaxis[joint]
            size = float(np.linalg.norm(way))
            return np.asarray(way / size) if size > 1e-3 else None
    return None


def leans(world: SkillWorld, entity: str, rotation: Array) -> bool:
    """Whether an entity does not stand as in ``rotation``: the axis that is vertical there has tilted."""
    axis = int(np.argmax(np.abs(rotation[2])))
    upright = float(world.pose(entity).rotation[2, axis] * np.sign(rotation[2, axis]))
    return bool(upright < np.cos(LEANING))


def press(world: SkillWorld, entity: str, direction: Array, rotation: Array) -> Motion:
    """Press the raised side of ``entity`` down, a little along ``direction``; True if it stands as in ``rotation``."""
    cloud = world.cloud(entity)
    raised = cloud[cloud[:, 2] > cloud[:, 2].max() - RAISED].mean(axis=0)
    down = nearest_twin(frame(-UP, np.cross(UP, direction)), world.eef.rotation)
    start = Pose(raised + INSIDE * direction + (TIP + ABOVE) * UP, down)
    yield from transit(world, start, CLOSED)
    for _ in range(STEPS):
        now = world.eef
        if not leans(world, entity, rotation) or now.position[2] < start.position[2] - ABOVE - DEEP:
            break
        goal = np.array([*start.position[:2], now.position[2] - STROKE]) + CREEP * direction
        yield action_towards(world, Pose(goal, down), CLOSED, 0.6)
    yield from reach(world, world.eef.moved(0.10 * UP), CLOSED, near=0.02, steps=20)
    return bool(not leans(world, entity, rotation))
