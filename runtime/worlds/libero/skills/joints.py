"""Articulated parts for skills: the joint of a fact, how far it must move, and the motion of its body."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.required import Fact
from onto_compiler.schema import JointThreshold, Schema
from runtime.worlds.libero.scene.targets import place_of, threshold_of
from runtime.worlds.libero.skills.frames import Pose, axis_angle
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Articulation", "articulation", "articulations", "wider"]

Array = NDArray[np.float64]

# How far past the bound a skill moves a joint, as a safety margin: metres on a slide, radians on a hinge.
MARGIN_SLIDE, MARGIN_HINGE = 0.006, 0.08
NARROW = 0.015  # width of a satisfied side, metres or radians
_PART, _NARROW_PART = 0.5, 0.1  # of a satisfied side that is narrower than twice the margin, and of a narrow one
COASTS = 0.5  # damping times duration over inertia, below which a joint keeps most of its speed
SHORT = 0.004  # metres that a drawer is left from its limit when it is opened as far as it goes
WORTH = 0.008  # metres of opening that are worth a pull
OPENED = "Open"  # the native predicate whose threshold says that an object can be put in
_UNLIMITED = 1e3


@dataclass(frozen=True, slots=True, eq=False)
class Articulation:
    """A hinge or slide and its required motion. Joint positions in metres or radians; ``axis`` is a unit vector.

    ``start`` is the initial position of the joint, ``goal`` the target (``bound`` plus a margin) and ``end`` the limit
    of its range beyond.
    """

    joint: int
    body: int
    slides: bool
    anchor: Array  # (3,) a point on the axis, in the world
    axis: Array  # (3,)
    start: float
    bound: float
    goal: float
    end: float

    @property
    def sign(self) -> float:
        """+1 if the joint position must increase, -1 if it must decrease."""
        return 1.0 if self.goal >= self.bound else -1.0

    def position(self, world: SkillWorld) -> float:
        """The joint's position now."""
        return float(world.data.qpos[self.address(world)])

    def coasting(self, world: SkillWorld, seconds: float) -> float:
        """The joint position after a time without contact, by its inertia and damping.

        A strongly damped joint stops with the hand.
        """
        dof = int(world.model.jnt_dofadr[self.joint])
        decay = float(world.model.dof_damping[dof] / max(world.model.dof_M0[dof], 1e-9))
        return self.position(world) + (self.velocity(world) * seconds if decay * seconds < COASTS else 0.0)

    @property
    def narrow(self) -> bool:
        """Whether the satisfied side ends soon after the bound, so that the joint has to come to rest at its limit."""
        return abs(self.end - self.bound) < NARROW

    def velocity(self, world: SkillWorld) -> float:
        """The joint's velocity now, per second."""
        return float(world.data.qvel[int(world.model.jnt_dofadr[self.joint])])

    def address(self, world: SkillWorld) -> int:
        """Where ``qpos`` holds the joint."""
        return int(world.model.jnt_qposadr[self.joint])

    def left(self, position: float) -> float:
        """The remaining motion to the goal from a joint position; not positive when it is reached."""
        return self.sign * (self.goal - position)

    def displacement(self, before: float, after: float) -> Pose:
        """The motion of the world that takes the body from one joint position to another."""
        if self.slides:
            return Pose((after - before) * self.axis, np.eye(3))
        rotation = axis_angle(self.axis, after - before)
        return Pose(self.anchor - rotation @ self.anchor, rotation)

    def direction(self, point: Array) -> Array:
        """The unit vector (3,) along which ``point`` (3,) of the body starts to move."""
        if self.slides:
            return np.asarray(self.sign * self.axis)
        tangent = np.cross(self.axis, point - self.anchor)
        size = float(np.linalg.norm(tangent))
        return np.asarray(self.sign * tangent / size) if size > 1e-9 else np.zeros(3)

    def radii(self, points: Array) -> Array:
        """Distances (n,) of ``points`` (n, 3) from the axis, in metres."""
        offset = points - self.anchor
        return np.asarray(np.linalg.norm(offset - np.outer(offset @ self.axis, self.axis), axis=1))


def articulation(world: SkillWorld, joint: int, threshold: JointThreshold, *, polarity: bool = True) -> Articulation:
    """The way of one hinge or slide to the side of ``threshold`` that ``polarity`` asks for."""
    model, data = world.model, world.data
    slides = int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
    above = threshold.above == polarity
    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-_UNLIMITED, _UNLIMITED)
    end = float(high if above else low)
    width = abs(end - threshold.bound)
    margin = min(MARGIN_SLIDE if slides else MARGIN_HINGE, (_NARROW_PART if width < NARROW else _PART) * width)
    return Articulation(
        joint,
        int(model.jnt_bodyid[joint]),
        slides,
        np.array(data.xanchor[joint]),
        np.array(data.xaxis[joint]),
        float(data.qpos[model.jnt_qposadr[joint]]),
        threshold.bound,
        threshold.bound + (margin if above else -margin),
        end,
    )


def articulations(world: SkillWorld, schema: Schema, fact: Fact) -> list[Articulation]:
    """The joints on the wrong side, the nearest to its goal first; none if ``fact`` is about something else.

    Also none if any joint suffices and one is on the right side.
    """
    threshold = threshold_of(schema, fact)
    return [] if threshold is None else _missing(world, fact.native.arguments[0], threshold, polarity=fact.polarity)


def wider(world: SkillWorld, schema: Schema, fact: Fact) -> list[Articulation]:
    """The drawers that contain the target of ``fact`` and can be opened further, up to their limit."""
    named = _opening(world, schema, fact)
    found = [replace(art, goal=art.end - art.sign * SHORT) for art in (_moving(world, *named) if named else ())]
    return [art for art in found if art.slides and art.left(art.start) > WORTH]


def _opening(world: SkillWorld, schema: Schema, fact: Fact) -> tuple[str, JointThreshold] | None:
    """The joint that must be open to put an object at the target of ``fact``, and its threshold."""
    place = place_of(world.index, fact)
    if place is None or place.site is None or place.parent is None or not (place.contains and fact.polarity):
        return None
    category = place.parent.rstrip("0123456789").rstrip("_")  # LIBERO numbers the instances of a category
    threshold = schema.thresholds.get((category, OPENED))
    if threshold is None:
        return None
    return (place.site if len(world.index.joints(place.site)) else place.parent), threshold


def _moving(world: SkillWorld, name: str, threshold: JointThreshold, *, polarity: bool = True) -> list[Articulation]:
    free = (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL)
    joints = [int(j) for j in world.index.joints(name) if int(world.model.jnt_type[j]) not in free]
    return [articulation(world, joint, threshold, polarity=polarity) for joint in joints]


def _missing(world: SkillWorld, name: str, threshold: JointThreshold, *, polarity: bool) -> list[Articulation]:
    found = _moving(world, name, threshold, polarity=polarity)
    unmet = [a for a in found if a.sign * (a.start - a.bound) <= 0.0]
    # "Not open" is said of every joint where "open" is said of any.
    if threshold.every_joint != polarity and len(unmet) < len(found):
        return []
    return sorted(unmet, key=lambda a: a.left(a.start))
