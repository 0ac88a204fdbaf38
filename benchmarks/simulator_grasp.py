"""Actions that go to an object, close the fingers on it and lift it: what makes and breaks contacts."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.simulator.simulation import Simulation

__all__ = ["grasp_actions"]

GAIN = 20.0  # units of action per metre: robosuite moves 5 cm for a whole unit
PHASES = ((0.12, 35, -1.0), (0.0, 25, -1.0), (0.0, 12, 1.0), (0.2, 28, 1.0))  # metres above it, control steps, gripper
FINGERS = "finger"  # in the names of the gripper's bodies

Floats = NDArray[np.float64]


def grasp_actions(simulation: Simulation, state: Floats, name: str) -> tuple[Floats, int]:
    """OSC_POSE actions (n, 7) for object ``name``, and after how many of them a finger touches it.

    The fingers close along the world's y. They go to the highest part of the object, the one furthest along y where
    several are as high: so a rim is taken on both sides. Nothing here asks whether the object is held in the end.
    """
    simulation.reset_to(state)
    simulation.settle()
    model, data, index = simulation.model, simulation.data, simulation.scene.index
    geoms = index.contact_geoms(name)
    fingers = [g for g in range(model.ngeom) if FINGERS in model.body(int(model.geom_bodyid[g])).name]
    site = simulation.scene.arm.site
    centre = data.xpos[index.root_body(name)].copy()
    where = data.geom_xpos[geoms]
    high = where[where[:, 2] > where[:, 2].max() - 0.005]
    target = high[np.argmax(np.abs(high[:, 1] - centre[1]))].copy()
    actions = [np.array([*np.zeros(6), -1.0])] * 10
    touched = 0
    for above, steps, gripper in PHASES:
        for _ in range(steps):
            error = target + np.array([0.0, 0.0, above]) - data.site_xpos[site]
            action = np.array([*np.clip(GAIN * error, -1.0, 1.0), 0.0, 0.0, 0.0, gripper])
            actions.append(action)
            simulation.step(action)
            touched += _touch(data, fingers, geoms)
    return np.array(actions), touched


def _touch(data: mujoco.MjData, fingers: list[int], geoms: NDArray[np.intp]) -> bool:
    pairs = data.contact.geom
    first, second = np.isin(pairs, fingers), np.isin(pairs, geoms)
    return bool(((first[:, 0] & second[:, 1]) | (first[:, 1] & second[:, 0])).any())
