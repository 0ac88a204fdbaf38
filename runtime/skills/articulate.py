"""Skills for joints: which ways there are to satisfy a fact, told by the joint's type and the part's shape."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass

from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.skills import drawer
from runtime.skills.contact import Contact, actuate, feasible
from runtime.skills.joints import Articulation, articulations
from runtime.skills.motion import Action
from runtime.skills.reach import Reach
from runtime.skills.world import World

__all__ = ["JointSkill", "joint_skills"]


@dataclass(frozen=True, slots=True, eq=False)
class JointSkill:
    """One way to move one joint to where a fact asks it to be."""

    articulation: Articulation
    contact: Contact

    def run(self, world: World, reach_: Reach) -> Generator[Action, None, None]:
        """The actions; raises :class:`~runtime.skills.fault.SkillFault` where it gives up."""
        yield from actuate(world, reach_, self.articulation, self.contact)


def joint_skills(world: World, reach_: Reach, schema: Schema, fact: Fact) -> Iterator[JointSkill]:
    """The ways to satisfy a fact about a joint, the best first; none when it speaks of something else or holds."""
    for art in articulations(world, schema, fact):
        for contact in feasible(world, reach_, art, _contacts(world, art)):
            yield JointSkill(art, contact)


def _contacts(world: World, art: Articulation) -> Iterator[Contact]:
    if art.slides:
        yield from drawer.pulls(world, art) if drawer.opens(world, art) else drawer.pushes(world, art)
