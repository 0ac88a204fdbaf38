"""The order in which to achieve the facts of a goal under dynamics: by declared preconditions, then by priority.

From statuses to steps, without a scene or predicate names. The order is found by symbolic simulation: each step makes
its fact true and the facts that it excludes false, so that a drawer that is opened on the way is also closed again.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from grounding.observation import Observation
from onto_compiler.conflicts import entails, exclude
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.tables import EXPLICITLY_FALSE, SATISFIED, STATUSES
from runtime.loop.diagnosis import by_distance, diagnose, evidence_status
from runtime.loop.records import Diagnosis

__all__ = ["GoalStep", "diagnose_step", "preconditions", "ready", "sequence"]

_SATISFIED, _FALSE = STATUSES.index(SATISFIED), STATUSES.index(EXPLICITLY_FALSE)
_LAST = 1000  # the priority of a fact without a rule
Key = tuple[bool, int]  # whether it is a precondition, and its place among those or among the required facts


@dataclass(frozen=True, slots=True)
class GoalStep:
    """A fact to bring about: ``index`` is its place in ``required.preconditions`` if it is one, else in ``.facts``."""

    fact: Fact
    index: int
    precondition: bool

    def __str__(self) -> str:
        return _named((self.fact,)).strip("`")


def preconditions(required: RequiredABox) -> tuple[tuple[Fact, ...], ...]:
    """The facts that must hold before each of ``required.facts``, in its order."""
    return tuple(
        tuple(each.fact for each in required.preconditions if index in each.before)
        for index in range(len(required.facts))
    )


def ready(
    required: RequiredABox, observed: Observation, conditions: Observation, knowledge: Knowledge
) -> tuple[GoalStep, ...]:
    """The remaining steps, the next one first; empty if the nearest alternative of the goal holds.

    ``observed`` is aligned with ``required.facts`` and ``conditions`` with ``required.preconditions``.

    Raises:
        OntoError: RUN012 if no order achieves every fact.
    """
    facts = evidence_status(required.facts, observed)
    before = evidence_status([each.fact for each in required.preconditions], conditions)
    return sequence(
        required, [int(s) for s in facts], [int(s) for s in before], knowledge, by_distance(required, observed)[0]
    )


def sequence(
    required: RequiredABox,
    facts: Sequence[int],
    conditions: Sequence[int],
    knowledge: Knowledge,
    way: Sequence[int] | None = None,
) -> tuple[GoalStep, ...]:
    """As :func:`ready`, of statuses given as places in :data:`onto_compiler.tables.STATUSES`.

    ``way`` limits the facts; by default all count. A fact comes after its unmet preconditions, and after any unmet fact
    with a precondition that it excludes; then the smaller priority comes first, then the earlier fact.

    Raises:
        OntoError: RUN012 if no order achieves every fact.
    """
    chosen = tuple(range(len(required.facts))) if way is None else tuple(way)
    return _Play(required, knowledge, chosen, list(facts), list(conditions)).steps()


def diagnose_step(
    step: GoalStep, required: RequiredABox, observed: Observation, conditions: Observation, knowledge: Knowledge
) -> Diagnosis:
    """The diagnosis of the fact of ``step``, which must be unmet in its observation (see :func:`ready`).

    Raises:
        OntoError: RUN003 if no diagnosis rule speaks of it.
    """
    if step.precondition:
        facts = [each.fact for each in required.preconditions]
        found = diagnose(facts, conditions, knowledge.tables, (step.index,))[0]
        return replace(found, precondition=True)
    return diagnose(required.facts, observed, knowledge.tables, (step.index,))[0]


@dataclass(slots=True)
class _Play:
    required: RequiredABox
    knowledge: Knowledge
    way: tuple[int, ...]
    facts: list[int]  # statuses during the symbolic simulation
    conditions: list[int]
    done: list[GoalStep] = field(default_factory=list)

    def steps(self) -> tuple[GoalStep, ...]:
        seen: set[Key] = set()
        while (key := self._next()) is not None:
            if key in seen:
                raise self._no_order([self.done[-1].fact, self._fact(key)])
            seen.add(key)
            self._take(key)
        return tuple(self.done)

    def _next(self) -> Key | None:
        unmet = [index for index in self.way if self.facts[index] != _SATISFIED]
        if not unmet:
            return None
        pending = self._pending(unmet)
        free = sorted((index for index in unmet if not self._waits(index, pending)), key=self._rank)
        if not free:
            raise self._no_order([self.required.facts[index] for index in unmet])
        best = [index for index in free if not self._comes_later(self.required.facts[index], unmet)] or free
        found = [self._first(index, free, frozenset()) for index in best]
        return next((key for key in found if not self._comes_later(self._fact(key), unmet)), found[0])

    def _first(self, index: int, free: Sequence[int], above: frozenset[int]) -> Key:
        """The first step towards a required fact: itself, or the fact that achieves its first unmet precondition.

        If another required fact achieves it, that one is taken, since it is needed anyway.
        """
        fact = self.required.facts[index]
        also = (
            other
            for other, each in enumerate(self.required.facts)
            if self.facts[other] != _SATISFIED and entails(fact, each, self.knowledge.schema)
        )
        needing = {index, *also}
        before = [
            place
            for place, each in enumerate(self.required.preconditions)
            if needing & {*each.before} and self.conditions[place] != _SATISFIED
        ]
        if not before:
            return False, index
        place = min(before, key=lambda each: (self._priority(self._fact((True, each)), self.conditions[each]), each))
        above |= {index}
        for other in free:
            if other not in above and entails(
                self.required.facts[other], self._fact((True, place)), self.knowledge.schema
            ):
                return self._first(other, free, above)
        return True, place

    def _comes_later(self, fact: Fact, unmet: Sequence[int]) -> bool:
        """Whether an unmet fact, once achieved, satisfies this one or undoes it."""
        others = (self.required.facts[index] for index in unmet)
        return any(
            entails(each, fact, self.knowledge.schema) or self._undoes(each, fact)
            for each in others
            if each is not fact
        )

    def _undoes(self, one: Fact, other: Fact) -> bool:
        return any(exclude(effect, other, self.knowledge.schema) for effect in self._effects(one))

    def _effects(self, fact: Fact) -> list[Fact]:
        """The fact, and those of the task that it satisfies when achieved."""
        known = (*self.required.facts, *(each.fact for each in self.required.preconditions))
        return [fact, *(each for each in known if entails(fact, each, self.knowledge.schema))]

    def _rank(self, index: int) -> tuple[int, int]:
        return self._priority(self.required.facts[index], self.facts[index]), index

    def _pending(self, unmet: Sequence[int]) -> set[int]:
        """The facts still to achieve: the unmet ones, and satisfied ones that must be undone for one of them."""
        pending = set(unmet)
        while more := {index for index in self.way if index not in pending and self._waits(index, pending)}:
            pending |= more
        return pending

    def _waits(self, index: int, pending: Collection[int]) -> bool:
        """Whether the fact excludes a precondition of another pending fact."""
        fact = self.required.facts[index]
        return any(
            other != index and other in pending and exclude(fact, each.fact, self.knowledge.schema)
            for each in self.required.preconditions
            for other in each.before
        )

    def _take(self, key: Key) -> None:
        fact = self._fact(key)
        self.done.append(GoalStep(fact, key[1], key[0]))
        schema, conditions = self.knowledge.schema, [each.fact for each in self.required.preconditions]
        effects = self._effects(fact)
        for statuses, others in ((self.facts, self.required.facts), (self.conditions, conditions)):
            for place, other in enumerate(others):
                if entails(fact, other, schema):
                    statuses[place] = _SATISFIED
                elif any(exclude(effect, other, schema) for effect in effects):
                    statuses[place] = _FALSE

    def _fact(self, key: Key) -> Fact:
        precondition, index = key
        return self.required.preconditions[index].fact if precondition else self.required.facts[index]

    def _priority(self, fact: Fact, status: int) -> int:
        entry = self.knowledge.tables.diagnosis.get((fact.predicate, fact.polarity, STATUSES[status]))
        return entry.priority if entry is not None else _LAST

    def _no_order(self, facts: Sequence[Fact]) -> OntoError:
        return OntoError.of(
            "RUN012",
            f"{_named(facts)} undo each other or each other's preconditions: no order brings them about",
            "require them of different objects or joints, or correct the core:Precondition that asks for too much",
            self.required.source,
        )


def _named(facts: Sequence[Fact]) -> str:
    return " and ".join(f"`{'' if fact.polarity else 'not '}{fact.native}`" for fact in facts)
