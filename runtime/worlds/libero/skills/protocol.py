"""The interface of skills: plans, each a motion of the arm that may make one fact true."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.world import SkillWorld

__all__ = ["Skill", "SkillPlan", "SkillRequest"]


@dataclass(frozen=True, slots=True)
class SkillRequest:
    """The fact that a skill must make true, and the present world; never a task name.

    ``holds`` says whether the fact would be true with its first argument at a pose; None if that is unknown.
    ``tried`` are the grasps that failed for this fact already; ``sharing`` facts speak of the same place.
    ``ways`` lead from the other objects of the goal to where it wants them: (2,) and (2,) in the world.
    """

    world: SkillWorld
    reach: Reach
    fact: Fact
    schema: Schema
    holds: Callable[[Pose], bool] | None = None
    tried: Sequence[Pose] = ()
    sharing: int = 1
    ways: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]] = ()


class SkillPlan(Protocol):
    """One way to make a fact true."""

    @property
    def run(self) -> Callable[[SkillWorld, Reach], Generator[NDArray[np.float64], None, None]]:
        """The motion, as actions (7,) of one control step each, in closed loop on the world that is given.

        Raises :class:`~runtime.worlds.libero.skills.fault.SkillFault` if it gives up.
        """
        ...

    @property
    def poses(self) -> Sequence[Pose]:
        """The grasps that count as tried with this plan."""
        ...

    @property
    def note(self) -> str:
        """A short description of the plan, for the record."""
        ...


class Skill(Protocol):
    """The mechanism of one action route."""

    name: str

    def candidates(self, request: SkillRequest) -> Iterator[SkillPlan]:
        """The plans for ``request``, the best first, without those near a tried grasp; empty if it cannot help."""
        ...
