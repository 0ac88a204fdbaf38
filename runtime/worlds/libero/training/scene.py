"""The facts required by any task of a suite whose tasks share one scene.

A fact is named by its atom, such as ``on(akita_black_bowl_1, plate_1)``; a negated precondition has the same atom.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from onto_compiler.knowledge import Knowledge
from onto_compiler.required import Fact
from runtime.worlds.libero.simulator.assets import TaskRef, tasks
from runtime.worlds.required import required_of

__all__ = ["SUITE", "SceneFacts", "scene_facts"]

SUITE = "libero_goal"


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """``facts``: the atoms, sorted by name; ``goals``: for each task by its index, the indices of its goal's facts.

    ``needed`` are likewise the facts that a task requires to hold, as goal or precondition. The other facts must not
    hold.
    """

    facts: tuple[Fact, ...]
    goals: Mapping[int, tuple[int, ...]]
    needed: Mapping[int, tuple[int, ...]]

    @property
    def names(self) -> tuple[str, ...]:
        """The atoms as text."""
        return tuple(map(str, self.facts))

    @property
    def positive(self) -> tuple[int, ...]:
        """The indices of facts that some task requires to hold."""
        return tuple(sorted({place for places in self.needed.values() for place in places}))


def scene_facts(knowledge: Knowledge, refs: tuple[TaskRef, ...] | None = None) -> SceneFacts:
    """The facts of the tasks ``refs``, all of :data:`SUITE` where none are named.

    Raises:
        OntoError: ``SIM010`` ff. without LIBERO, ``BDDL`` problems of a task file.
    """
    chosen = tasks(SUITE) if refs is None else refs
    required = {ref.index: required_of(ref, knowledge, ordered=True) for ref in chosen}
    whole = {index: (*abox.facts, *(each.fact for each in abox.preconditions)) for index, abox in required.items()}
    every = {str(_atom(fact)): _atom(fact) for facts in whole.values() for fact in facts}
    names = sorted(every)

    def places(facts: Iterable[Fact]) -> tuple[int, ...]:
        return tuple(names.index(str(_atom(fact))) for fact in facts)

    return SceneFacts(
        tuple(every[name] for name in names),
        {index: places(abox.facts) for index, abox in required.items()},
        {index: places(fact for fact in facts if fact.polarity) for index, facts in whole.items()},
    )


def _atom(fact: Fact) -> Fact:
    return replace(fact, polarity=True, span=None)
