"""What can be done about a fact: the skills that suit it, as offers that an episode takes one by one."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass

from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.proposers.targets import place_of
from runtime.skills.articulate import joint_skills
from runtime.skills.frames import Pose
from runtime.skills.motion import Action
from runtime.skills.reach import Reach
from runtime.skills.slide import lies_flat, slide, slides
from runtime.skills.transfer import transfer, transfers
from runtime.skills.world import World

__all__ = ["Offer", "offers"]


@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """One way to satisfy a fact: ``run`` gives its motion; ``poses`` are the grasps that count as tried with it."""

    run: Callable[[World, Reach], Generator[Action, None, None]]
    poses: tuple[Pose, ...]
    note: str


def offers(
    world: World,
    reach: Reach,
    schema: Schema,
    fact: Fact,
    holds: Callable[[Pose], bool],
    tried: Sequence[Pose],
    sharing: int = 1,
) -> Iterator[Offer]:
    """The ways to satisfy ``fact``, the best first; none near one of the grasps ``tried``.

    ``holds`` says whether the fact is true with its subject at a pose; ``sharing`` facts speak of the same place.
    """
    place = place_of(world.index, fact)
    if place is None:
        for skill in joint_skills(world, reach, schema, fact, tried):
            yield Offer(skill.run, (skill.contact.pose,), "joint")
        return
    if lies_flat(world, place):
        goal = world.site_pose(str(place.site)).position[:2]
        for push in slides(world, reach, place.subject, goal):
            yield Offer(lambda w, _, plan=push: slide(w, plan), (), f"slide, tilt {push.tilt:.2f}")  # type: ignore[misc]
    for plan in transfers(world, reach, place, holds, tried, sharing):
        note = f"grasp cost {plan.grasp.cost:.2f}, let go {1000 * plan.release:.0f} mm above"
        yield Offer(lambda w, _, plan=plan: transfer(w, plan), (plan.grasp.pose,), note)  # type: ignore[misc]
