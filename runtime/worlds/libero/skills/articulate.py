"""Skills for joints: the ways to satisfy a fact, by the joint's type and the part's shape."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.worlds.libero.skills import door, drawer, knob
from runtime.worlds.libero.skills.contact import GripContact, actuate, reachable
from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose, nearest_twin, turn
from runtime.worlds.libero.skills.joints import Articulation, articulations, wider
from runtime.worlds.libero.skills.motion import Action
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["JointSkill", "joint_skills", "widening_skills"]

SAME, SAME_TURN = 0.008, 0.1  # metres, radians: contacts that differ by less are the same
KNOB = 0.08  # metres; what turns and is wider is a door


@dataclass(frozen=True, slots=True, eq=False)
class JointSkill:
    """One way to move one joint to where a fact asks it to be; ``ways`` lead the free gripper to the ``contact``."""

    articulation: Articulation
    contact: GripContact
    ways: list[Pose]

    def run(self, world: SkillWorld, reach_: Reach) -> Generator[Action, None, None]:
        """The actions; raises :class:`~runtime.worlds.libero.skills.fault.SkillFault` where it gives up."""
        art = self.articulation
        yield from actuate(world, art, self.contact, self.ways)
        if self.contact.until is None:
            return
        art = replace(art, start=art.position(world))
        for contact, ways in reachable(world, reach_, art, door.sweeps(world, art)):
            yield from actuate(world, art, contact, ways)
            return
        raise SkillFault("unreachable", "the opened part cannot be reached from behind")


def joint_skills(
    world: SkillWorld, reach_: Reach, schema: Schema, fact: Fact, tried: Sequence[Pose] = ()
) -> Iterator[JointSkill]:
    """The ways to satisfy a fact about a joint, the best first; none if it holds or is about something else.

    Ways near one of the gripper poses ``tried`` are left out.
    """
    yield from _skills(world, reach_, articulations(world, schema, fact), tried)


def widening_skills(
    world: SkillWorld, reach_: Reach, schema: Schema, fact: Fact, tried: Sequence[Pose] = ()
) -> Iterator[JointSkill]:
    """The ways to open a drawer further, if the target of a fact about an object is in it."""
    yield from _skills(world, reach_, wider(world, schema, fact), tried)


def _skills(
    world: SkillWorld, reach_: Reach, joints: Sequence[Articulation], tried: Sequence[Pose]
) -> Iterator[JointSkill]:
    for art in joints:
        fresh = (c for c in _contacts(world, art) if not any(_alike(c.pose, pose) for pose in tried))
        for contact, ways in reachable(world, reach_, art, fresh):
            yield JointSkill(art, contact, ways)


def _alike(a: Pose, b: Pose) -> bool:
    return bool(
        np.linalg.norm(a.position - b.position) < SAME
        and turn(nearest_twin(a.rotation, b.rotation), b.rotation) < SAME_TURN
    )


def _contacts(world: SkillWorld, art: Articulation) -> Iterator[GripContact]:
    if art.slides:
        yield from drawer.pulls(world, art) if drawer.opens(world, art) else drawer.pushes(world, art)
    elif float(art.radii(world.points([art.body])).max()) < KNOB:
        yield from knob.twists(world, art)
    else:
        yield from door.sweeps(world, art)
        yield from door.pulls(world, art)
