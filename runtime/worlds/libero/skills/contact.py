"""One way to move an articulated part: grip or push it at a pose, and follow it along its joint."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose, nearest_twin, turn
from runtime.worlds.libero.skills.joints import Articulation
from runtime.worlds.libero.skills.motion import CLOSED, OPEN, Action, action_towards, close, grip, reach
from runtime.worlds.libero.skills.reach import OPEN as WIDE
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.route import glide, loose, route, travel
from runtime.worlds.libero.skills.transit import transit
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["GripContact", "actuate", "drive", "feasible", "reachable"]

Array = NDArray[np.float64]

LEAD_SLIDE, LEAD_HINGE, LEAD_TWIST = 0.06, 0.12, 0.5  # how far the gripper's goal is ahead: metres of its path, radians
OVERSHOOT = 0.05  # metres of the gripper's way beyond the joint's limit, so that it presses
STEPS = 90
AWAY = 0.07  # metres; fingers that open then do not touch the part
EARLY = 0.022  # metres before the end of the way
ASIDE = 0.006  # metres beside the way
LETTING_GO = 0.3  # seconds, in which a heavy knob turns on
BLOCKED = 0.011  # metres that a grip may be short of its place
STALLED = 14
PROGRESS = 1e-4  # of the joint's way, metres or radians a step
BACK_GAIN = 20.0  # of an action, per radian
RESTING, CALM, STILL = 12, 3, 1e-3  # steps at most and at rest, and the speed (m/s or rad/s) that counts as none
RELEASE = 5  # steps to open the fingers
DEEP = 0.016  # metres that the IK's collision model may see the gripper inside what it touches
SLACK = 0.006  # metres that a pushing gripper must be free to go on


@dataclass(frozen=True, slots=True, eq=False)
class GripContact:
    """``pose`` of the gripper at the part as it stands; ``approach`` (3,) is the way from there back to free space.

    ``grips`` closes the fingers on the part, otherwise closed fingers push. ``follows`` is the share of the part's turn
    that the gripper makes. ``until`` is where the joint is released before its goal, to continue with another contact.
    ``slim``: the gripped part is so thin that the open fingers may start to close on the way.
    """

    pose: Pose
    approach: Array
    grips: bool
    follows: float
    cost: float
    until: float | None = None
    slim: bool = False

    @property
    def before(self) -> Pose:
        """The pose from which the contact is approached."""
        return self.pose.moved(self.approach)


def target(art: Articulation, contact: GripContact, start: float, position: float) -> Pose:
    """Where the gripper is when the joint, at ``start`` while it stood at ``contact.pose``, is at ``position``."""
    moved = art.displacement(start, position) @ contact.pose
    if contact.follows >= 1.0 or art.slides:
        return moved
    turned = art.displacement(start, start + contact.follows * (position - start)).rotation
    return Pose(moved.position, turned @ contact.pose.rotation)


def feasible(
    world: SkillWorld, reach_: Reach, art: Articulation, contacts: Iterable[GripContact]
) -> Iterator[GripContact]:
    """The ``contacts`` that the arm can reach, from before the contact until the joint is at its goal.

    First those that touch nothing else; then those that would push movable objects aside.
    """
    every = list(contacts)
    touches = {art.body: DEEP}
    found = False
    for allowed in (touches, touches | loose(world)):
        if found:
            return
        for contact in every:
            rotation = nearest_twin(contact.pose.rotation, world.eef.rotation)
            for twin in (rotation, rotation * np.array([-1.0, -1.0, 1.0])):
                tried = replace(contact, pose=Pose(contact.pose.position, twin))
                if _reached(world, reach_, art, tried, allowed):
                    found = True
                    yield tried
                    break


def _reached(
    world: SkillWorld, reach_: Reach, art: Articulation, contact: GripContact, touches: Mapping[int, float]
) -> bool:
    start = art.position(world)
    aperture = WIDE if contact.grips else 0.0
    at = reach_.solve(contact.before, reach_.begin(), aperture=aperture, touches=touches)
    if not at.feasible:
        return False
    last = art.end if art.narrow else art.goal if contact.until is None else contact.until
    for part in (0.0, 0.5, 1.0):
        position = start + part * (last - start)
        reach_.begin({art.address(world): position})
        pose = target(art, contact, start, position)
        if part and not contact.grips:
            pose = pose.moved(SLACK * art.direction(pose.position))
        at = reach_.solve(pose, at.joints, aperture=aperture, touches=touches)
        if not at.feasible:
            return False
    return True


def reachable(
    world: SkillWorld, reach_: Reach, art: Articulation, contacts: Iterable[GripContact]
) -> Iterator[tuple[GripContact, list[Pose]]]:
    """The ``contacts`` that are :func:`feasible` and have a free path, with that path.

    If none has a free path, all are given in their order, with the path from above.
    """
    barred = []
    for contact in feasible(world, reach_, art, contacts):
        ways = route(world, reach_, contact.before, aperture=WIDE if contact.grips else 0.0)
        if ways is None:
            barred.append(contact)
        else:
            yield contact, ways
    yield from ((contact, []) for contact in barred)


def actuate(
    world: SkillWorld, art: Articulation, contact: GripContact, ways: Sequence[Pose] = ()
) -> Generator[Action, None, None]:
    """Follow ``ways`` to ``contact``, move the joint past its bound, release and withdraw.

    Raises :class:`SkillFault` if that fails.
    """
    fingers = OPEN if contact.grips else CLOSED
    arrived = (
        travel(world, ways, fingers, near=0.012 if contact.grips else 0.008)
        if ways
        else transit(world, contact.before, fingers)
    )
    if not (yield from arrived):
        raise SkillFault("unreachable", "the gripper did not come to where the part is to be touched")
    if contact.grips:
        yield from glide(world, contact.pose, OPEN, near=0.004, turned=0.06, until=lambda: _closing(world, contact))
        yield from glide(world, contact.pose, CLOSED, near=0.004, turned=0.06, most=6)
        short = float(np.linalg.norm(world.eef.position - contact.pose.position))
        if short > BLOCKED:
            yield from withdraw(world, contact)
            raise SkillFault("blocked", f"the gripper stopped {1000 * short:.0f} mm before the handle")
        if not (yield from close(world, contact.pose, least=6)):
            raise SkillFault("lost", "the fingers closed beside the handle")
        held = replace(contact, pose=world.eef)
        done = yield from drive(world, art, held)
    else:
        done = yield from drive(world, art, contact)
    yield from withdraw(world, contact)
    if not done:
        raise SkillFault("missed", f"the joint stands at {art.position(world):.4f}, its bound is {art.bound:.4f}")


def _closing(world: SkillWorld, contact: GripContact) -> bool:
    """Whether the fingers can begin to close on the way: they need some steps for it, and are wide open still."""
    left = contact.pose.position - world.eef.position
    ahead = float(left @ contact.pose.rotation[:, 2])
    return contact.slim and ahead < EARLY and float(np.linalg.norm(left)) < np.hypot(ahead, ASIDE)


def drive(world: SkillWorld, art: Articulation, contact: GripContact) -> Generator[Action, None, bool]:
    """Follow the joint with the gripper a little ahead of it; True when the goal, or at least the bound, is passed."""
    start = art.position(world)
    reference = contact.pose.position
    radius = 1.0 if art.slides else max(float(art.radii(reference[None])[0]), 0.02)
    lead = LEAD_SLIDE if art.slides else min(LEAD_TWIST, LEAD_HINGE / radius)
    beyond = art.end + art.sign * OVERSHOOT / radius
    aim = art.goal if contact.until is None else contact.until
    best, idle = np.inf, 0
    for _ in range(STEPS):
        now = art.position(world)
        left = art.sign * (aim - now)
        if left <= 0.0 or (not art.narrow and art.sign * (aim - art.coasting(world, LETTING_GO)) <= 0.0):
            yield from _rest(world, art, contact)
            break
        idle = 0 if left < best - PROGRESS else idle + 1
        best = min(best, left)
        if idle > STALLED:
            break
        ahead = now + art.sign * lead
        ahead = min(ahead, beyond) if art.sign > 0 else max(ahead, beyond)
        goal = target(art, contact, start, ahead)
        yield action_towards(world, goal, CLOSED)
    return art.sign * (art.coasting(world, LETTING_GO) - (art.bound if contact.until is None else aim)) > 0.0


def _rest(world: SkillWorld, art: Articulation, contact: GripContact) -> Generator[Action, None, None]:
    """Wait where the satisfied side is so narrow that the joint's limit may throw it back out.

    A joint that is held is turned back from its limit into the middle of that side; what was pushed comes apart slowly.
    """
    if not art.narrow:
        return
    middle, calm = 0.5 * (art.bound + art.end), 0
    for _ in range(RESTING):
        action = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, CLOSED])
        if contact.grips and not art.slides:
            action[3:6] = np.clip(BACK_GAIN * (middle - art.position(world)), -1.0, 1.0) * art.axis
        yield action
        calm = calm + 1 if abs(art.velocity(world)) < STILL else 0
        if calm >= CALM:
            return


def withdraw(world: SkillWorld, contact: GripContact) -> Generator[Action, None, None]:
    """Release, and withdraw without touching the part again."""
    if contact.grips:
        yield from grip(world, OPEN, RELEASE)
        yield from reach(world, world.eef.backed(0.07), OPEN, near=0.02, steps=10)
    else:
        away = contact.approach / np.linalg.norm(contact.approach)
        leave = world.eef.backed(0.02)
        yield from reach(world, leave.moved(AWAY * away), CLOSED, near=0.02, steps=10)


def twist_cost(world: SkillWorld, rotation: Array) -> float:
    """Steps that the arm needs to turn to ``rotation``, roughly."""
    return turn(world.eef.rotation, nearest_twin(rotation, world.eef.rotation)) / 0.11
