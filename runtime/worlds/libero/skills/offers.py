"""The skills of the action routes that ship: move a joint; carry an object, or slide a flat one."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass

from onto_compiler.schema import Schema
from runtime.worlds.libero.scene.targets import PlacementTarget, place_of
from runtime.worlds.libero.skills.articulate import joint_skills, widening_skills
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.motion import Action
from runtime.worlds.libero.skills.pick import alike
from runtime.worlds.libero.skills.place import cramped
from runtime.worlds.libero.skills.protocol import SkillRequest
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.slide import lies_flat, slide, slides
from runtime.worlds.libero.skills.transfer import leaving, transfer, transfers
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Carrying", "MovingJoints", "SkillCandidate"]


@dataclass(frozen=True, slots=True, eq=False)
class SkillCandidate:
    """One way to satisfy a fact: ``run`` gives its motion; ``poses`` are the grasps that count as tried with it."""

    run: Callable[[SkillWorld, Reach], Generator[Action, None, None]]
    poses: tuple[Pose, ...]
    note: str


class MovingJoints:
    """Moves a joint to the side that a fact requires."""

    name = "joint"

    def __init__(self, schema: Schema) -> None:
        self._schema = schema

    def candidates(self, request: SkillRequest) -> Iterator[SkillCandidate]:
        """A handle to pull, a knob to twist, a front to push: the best first."""
        for skill in joint_skills(request.world, request.reach, self._schema, request.fact, request.tried):
            yield SkillCandidate(skill.run, (skill.contact.pose,), "handle, knob or front")


class Carrying:
    """Moves an object to the target of a fact, or away from it if the fact must not hold."""

    name = "carry"

    def __init__(self, schema: Schema) -> None:
        self._schema = schema

    def candidates(self, request: SkillRequest) -> Iterator[SkillCandidate]:
        """Pairs of a grasp and a spot, the best first; before them pushes, if it is flat on the target's surface."""
        world, reach = request.world, request.reach
        place = place_of(world.index, request.fact)
        if place is None:
            return
        if not request.fact.polarity:
            yield from self._leaving(request, place)
            return
        if lies_flat(world, place):
            goal = world.site_pose(str(place.site)).position[:2]
            for push in slides(world, reach, place.subject, goal):
                if any(alike(push.start, pose) for pose in request.tried):
                    continue
                note = f"push, hand leaning {push.tilt:.2f} rad"
                yield SkillCandidate(lambda w, _, plan=push: slide(w, plan), (push.start,), note)  # type: ignore[misc]
        holds = request.holds or (lambda _: True)
        for number, plan in enumerate(transfers(world, reach, place, holds, request.tried, request.sharing)):
            if number == 0 and not request.tried and cramped(world, place, plan.spot):
                for skill in widening_skills(world, reach, self._schema, request.fact, request.tried):
                    yield SkillCandidate(skill.run, (skill.contact.pose,), "the drawer further open")
                    break
            note = f"grasp {1000 * plan.grasp.width:.0f} mm wide, let go {1000 * plan.release:.0f} mm above"
            yield SkillCandidate(lambda w, _, plan=plan: transfer(w, plan), (plan.grasp.pose,), note)  # type: ignore[misc]

    def _leaving(self, request: SkillRequest, place: PlacementTarget) -> Iterator[SkillCandidate]:
        """Pairs of a grasp and a free spot, for a relation that must not hold."""
        holds = request.holds or (lambda _: True)
        for plan in leaving(request.world, request.reach, place, holds, request.tried, request.ways):
            away = 1000 * plan.spot.cost
            note = f"grasp {1000 * plan.grasp.width:.0f} mm wide, set aside {away:.0f} mm away"
            yield SkillCandidate(lambda w, _, plan=plan: transfer(w, plan), (plan.grasp.pose,), note)  # type: ignore[misc]
