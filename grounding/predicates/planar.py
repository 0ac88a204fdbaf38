"""Predicates of a body that slides in the plane: at a target, at its velocity, free of walls.

The body moves by two slide joints along x and y, and its state is theirs: ``(x, y, vx, vy)``. A target is a state of
the same joints. It is no part of MuJoCo's physics and stands in ``data.userdata``, four numbers from the address that
the model's custom numeric ``NAME_state`` gives. Tolerances are the TBox's (``core:tolerance``).

Source of ``at_target``: DINO-WM ``env/pointmaze/point_maze_wrapper.py``, ``eval_state``.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.predicates.arguments import tolerance_of, two_names, unsuited
from grounding.predicates.terms import Grounding, Term, all_of
from grounding.scenes import Scene
from onto_compiler.problems import OntoError
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["apart", "at_target", "clearance", "free_of", "target_address", "velocity_matches"]

_WIDTH = 4
_PARALLEL = 1e-9


def at_target(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground ``AtTarget(agent, target)``: their distance is below the tolerance, metres.

    Raises ``SIM001`` for an unknown agent; ``SIM006`` if it does not slide in the plane, where the model holds no
    state of the target, or where the predicate has no tolerance.
    """
    agent, target = two_names(fact)
    tolerance, address = tolerance_of(fact, schema), target_address(scene.model, target, fact)
    places, _ = _slides(scene, agent, fact)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        margin = tolerance - float(apart(data.userdata[address : address + 2], data.qpos[places]))
        return (Term("distance", margin, margin > 0.0),)

    return Grounding(terms, all_of)


def velocity_matches(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground ``VelocityMatches(agent, target)``: their velocities differ by less than the tolerance, metres per second.

    Raises as :func:`at_target`.
    """
    agent, target = two_names(fact)
    tolerance, address = tolerance_of(fact, schema), target_address(scene.model, target, fact)
    _, speeds = _slides(scene, agent, fact)

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        margin = tolerance - float(apart(data.userdata[address + 2 : address + 4], data.qvel[speeds]))
        return (Term("velocity", margin, margin > 0.0),)

    return Grounding(terms, all_of)


def free_of(scene: Scene, fact: Fact, schema: Schema) -> Grounding:
    """Ground ``FreeOf(agent, wall)``: the agent reaches into no box of the wall by more than the tolerance, metres.

    The agent is round, and the boxes stand along the axes. Raises ``SIM001`` for unknown names, ``SIM006`` for other
    shapes and where the predicate has no tolerance.
    """
    agent, wall = two_names(fact)
    tolerance = tolerance_of(fact, schema)
    model = scene.model
    ball, boxes = scene.contact_geoms(agent), scene.contact_geoms(wall)
    round_ = [int(model.geom_type[geom]) == mujoco.mjtGeom.mjGEOM_SPHERE for geom in ball]
    square = [int(model.geom_type[geom]) == mujoco.mjtGeom.mjGEOM_BOX for geom in boxes]
    if round_ != [True] or not square or not all(square):
        raise unsuited(fact, f"`{fact.grounded_by}` is of a sphere and boxes, which `{agent}` and `{wall}` are not")
    sphere, radius, halves = int(ball[0]), float(model.geom_size[ball[0], 0]), model.geom_size[boxes, :2]

    def terms(data: mujoco.MjData) -> Sequence[Term]:
        middles = data.geom_xpos[boxes, :2]
        rects = np.concatenate([middles - halves, middles + halves], axis=1)
        margin = tolerance + (float(clearance(data.geom_xpos[sphere, :2], rects)) - radius)
        return (Term("clearance", margin, margin > 0.0),)

    return Grounding(terms, all_of)


def apart(first: NDArray[np.floating], second: NDArray[np.floating]) -> NDArray[np.float64]:
    """The distance of points, or velocities, (..., 2) from others (..., 2): (...).

    It is numpy's norm of each difference alone, to the last bit, which its norm along an axis is not.
    """
    gap = np.subtract(first, second, dtype=np.float64)
    return np.asarray(np.sqrt(np.vecdot(gap, gap)))


def clearance(points: NDArray[np.float64], boxes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed distance from ``points`` (..., 2) to the nearest of ``boxes`` (K, 4: low x, y, high x, y): (...), metres.

    Within a box it is minus the way to that box's nearest side.
    """
    place = points[..., None, :]
    outside = np.maximum(boxes[:, :2] - place, place - boxes[:, 2:])
    beyond = np.maximum(outside, 0.0)
    way = np.sqrt(beyond[..., 0] ** 2 + beyond[..., 1] ** 2)
    return np.asarray((way + np.minimum(outside.max(axis=-1), 0.0)).min(axis=-1))


def target_address(model: mujoco.MjModel, target: str, fact: Fact | None = None) -> int:
    """Where ``data.userdata`` holds the state of ``target``; raises ``SIM006`` if the model has no room for it."""
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, f"{target}_state")
    address = int(model.numeric_data[model.numeric_adr[found]]) if found >= 0 else -1
    if not 0 <= address <= model.nuserdata - _WIDTH:
        message = f"the scene holds no state of `{target}`"
        hint = f"name the address in userdata of its four numbers by a custom numeric `{target}_state`"
        raise OntoError.of("SIM006", message, hint) if fact is None else unsuited(fact, message, hint)
    return address


def _slides(scene: Scene, agent: str, fact: Fact) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where ``qpos`` and ``qvel`` hold the agent's x and y, each (2,)."""
    model = scene.model
    scene.root_body(agent)
    joints = scene.joints(agent)
    axes = np.eye(3)[:2]
    sliding = len(joints) == 2 and all(model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_SLIDE)
    if not sliding or np.abs(model.jnt_axis[joints] - axes).max() > _PARALLEL:
        raise unsuited(fact, f"`{fact.grounded_by}` is of what slides along x and y, which `{agent}` does not")
    return model.jnt_qposadr[joints].astype(np.intp), model.jnt_dofadr[joints].astype(np.intp)
