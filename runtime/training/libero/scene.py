"""What is asked of a suite whose tasks share one scene: the facts that any of its tasks requires.

A fact is named by its atom, such as ``on(akita_black_bowl_1, plate_1)``: a negated precondition asks for the same atom.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from onto_compiler.knowledge import Knowledge
from onto_compiler.required import Fact, RequiredABox
from runtime.episodes import required_of
from runtime.simulator.assets import TaskRef, tasks

__all__ = ["SUITE", "SceneFacts", "scene_facts"]

SUITE = "libero_goal"


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """``facts``: the atoms, sorted by name; ``goals``: of each task by its index, the places of its goal's facts.

    ``needed`` names, in the same way, all that a task's required ABox asks for: goal and preconditions. ``positive``
    are the places of what some task asks to hold; the others are asked not to hold.
    """

    facts: tuple[Fact, ...]
    goals: Mapping[int, tuple[int, ...]]
    needed: Mapping[int, tuple[int, ...]]
    positive: tuple[int, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The atoms as text."""
        return tuple(map(str, self.facts))


def scene_facts(knowledge: Knowledge, refs: tuple[TaskRef, ...] | None = None) -> SceneFacts:
    """The facts of the tasks ``refs``, all of :data:`SUITE` where none are named.

    Raises:
        OntoError: ``SIM010`` ff. without LIBERO, ``BDDL`` problems of a task file.
    """
    chosen = tasks(SUITE) if refs is None else refs
    required = {ref.index: required_of(ref, knowledge, ordered=True) for ref in chosen}
    goals = {index: tuple(map(_atom, abox.facts)) for index, abox in required.items()}
    before = {index: tuple(_atom(each.fact) for each in abox.preconditions) for index, abox in required.items()}
    every = {str(fact): fact for found in (*goals.values(), *before.values()) for fact in found}
    names = sorted(every)
    place = {name: number for number, name in enumerate(names)}
    return SceneFacts(
        tuple(every[name] for name in names),
        {index: tuple(place[str(fact)] for fact in found) for index, found in goals.items()},
        {index: tuple(place[str(fact)] for fact in (*goals[index], *before[index])) for index in goals},
        tuple(sorted({place[str(fact)] for abox in required.values() for fact in _asked_to_hold(abox)})),
    )


def _asked_to_hold(required: RequiredABox) -> list[Fact]:
    every = [*required.facts, *(each.fact for each in required.preconditions)]
    return [fact for fact in every if fact.polarity]


def _atom(fact: Fact) -> Fact:
    return replace(fact, polarity=True, span=None)
