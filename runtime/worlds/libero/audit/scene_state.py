"""The measured state of a scene at one step of an audit: poses, joints, and penetration depths."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.scenes import Scene

__all__ = ["SceneReader", "SceneState"]

_HINGE, _SLIDE = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
Poses = Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]


@dataclass(frozen=True, slots=True, eq=False)
class SceneState:
    """Everything by name.

    ``poses`` are each movable object's position (3,) in metres and its axes as columns (3, 3); ``hinges`` are in
    radians, ``slides`` in metres. The deepest contacts in metres are by pair, ``a, b``: ``depths`` between two
    objects or fixtures, ``sunk`` between one and anything else (table, floor, robot).
    """

    poses: Poses
    hinges: Mapping[str, float]
    slides: Mapping[str, float]
    depths: Mapping[str, float]
    sunk: Mapping[str, float]


class SceneReader:
    """Reads moments of one scene; every name is resolved at construction."""

    def __init__(self, scene: Scene) -> None:
        self._objects = {name: scene.root_body(name) for name in scene.entities if scene.free_joint(name) is not None}
        self._hinges, self._slides = _addresses(scene, _HINGE), _addresses(scene, _SLIDE)
        self._owners = _owners(scene)
        self._entities = frozenset(scene.entities)

    def read(self, data: mujoco.MjData) -> SceneState:
        """Copy the values from ``data``, a forwarded state of the scene."""
        poses = {n: (data.xpos[b].copy(), data.xmat[b].reshape((3, 3)).copy()) for n, b in self._objects.items()}
        hinges = {name: float(data.qpos[address]) for name, address in self._hinges.items()}
        slides = {name: float(data.qpos[address]) for name, address in self._slides.items()}
        return SceneState(poses, hinges, slides, *self._contacts(data))

    def _contacts(self, data: mujoco.MjData) -> tuple[dict[str, float], dict[str, float]]:
        depths: dict[str, float] = {}
        sunk: dict[str, float] = {}
        for distance, pair in zip(data.contact.dist, data.contact.geom, strict=True):
            first, second = sorted(self._owners[geom] for geom in pair)  # no scene of LIBERO has a flex, geom -1
            if distance < 0 and first != second:
                deepest = depths if {first, second} <= self._entities else sunk
                key = f"{first}, {second}"
                deepest[key] = max(deepest.get(key, 0.0), -float(distance))
        return depths, sunk


def _addresses(scene: Scene, kind: mujoco.mjtJoint) -> dict[str, int]:
    """Where ``qpos`` holds each joint of that kind that belongs to an entity."""
    model = scene.model
    joints = [int(joint) for name in scene.entities for joint in scene.joints(name)]
    chosen = [joint for joint in joints if model.jnt_type[joint] == kind]
    return {_name(model, mujoco.mjtObj.mjOBJ_JOINT, joint): int(model.jnt_qposadr[joint]) for joint in chosen}


def _owners(scene: Scene) -> list[str]:
    """By geom: the entity that it belongs to, or else the body below the world that carries it (robot, table)."""
    model = scene.model
    entity = {int(body): name for name in scene.entities for body in scene.bodies(name)}
    roots = model.body_rootid
    return [
        entity.get(int(body)) or _name(model, mujoco.mjtObj.mjOBJ_BODY, int(roots[body])) or "world"
        for body in model.geom_bodyid
    ]


def _name(model: mujoco.MjModel, kind: mujoco.mjtObj, index: int) -> str:
    return mujoco.mj_id2name(model, kind, index) or ""
