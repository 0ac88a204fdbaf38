"""Whether a fact holds, as each part of the program answers it: one meaning, or a name in the list of differences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from grounding.observation import Evidence, Observation, stack
from onto_compiler.knowledge import Knowledge, load_knowledge
from onto_compiler.rdf import MAN
from onto_compiler.required import Entity, Fact, NativeAtom, RequiredABox

__all__ = ["PARTS", "differing", "expected", "random_case"]

Answers = tuple[bool, ...]


def expected(facts: Sequence[Fact], observation: Observation) -> Answers:
    """Satisfaction in the paper's words (section 3), one fact at a time and without an array."""
    return tuple(_holds(fact, observation, index) for index, fact in enumerate(facts))


def _holds(fact: Fact, observation: Observation, index: int) -> bool:
    if not observation.observed[index]:
        return False
    margin = float(observation.margin[index])
    signed = margin if fact.polarity else -margin
    if fact.threshold < 0 and not isnan(signed) and signed >= fact.threshold:
        return True
    agrees = bool(observation.truth[index]) == fact.polarity
    return agrees and (isnan(signed) or signed >= fact.threshold)


@dataclass(frozen=True, slots=True)
class _FixedGrounder:
    """Observes what it is given, whatever the state."""

    observation: Observation

    @property
    def planned(self) -> tuple[bool, ...]:
        """As of grounding functions that state their conditions as numbers: truth is the sign of the margin."""
        margin, truth = self.observation.margin, self.observation.truth
        return tuple(bool(each) for each in np.isnan(margin) | ((margin >= 0) == truth))

    def observe(self, _data: object = None, _step: int = 0) -> Observation:
        return self.observation

    def pattern(self, _data: object = None) -> bytes:
        return self.observation.truth.tobytes()


def _required(facts: Sequence[Fact]) -> RequiredABox:
    return RequiredABox("generated", "", "generated", tuple(facts), premise=tuple(facts))


def _without(indices: Sequence[int], count: int) -> Answers:
    return tuple(index not in set(indices) for index in range(count))


def _loop(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.loop.diagnosis import diagnose_goal, unmet  # noqa: PLC0415 - each part is imported where it is asked

    required = _required(facts)
    found = [each.index for each in diagnose_goal(required, seen, knowledge.tables)]
    if list(unmet(required, seen)) != found:
        return ()
    return _without(found, len(facts))


def _monitor(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.loop.monitor import GoalMonitor  # noqa: PLC0415

    monitor = GoalMonitor(_required(facts), cast(Any, _FixedGrounder(seen)), knowledge.tables)
    whole = all(seen.observed)  # a simulator has evidence of every fact, and by truth alone a monitor asks no more
    if not whole and all(fact.threshold == 0.0 for fact in facts):
        return expected(facts, seen)
    answers = tuple(bool(each) for each in monitor.satisfied(cast(Any, None)))
    return answers if answers == _without([u.index for u in monitor.unmet(cast(Any, None))], len(facts)) else ()


def _info(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.worlds.facts import fact_rows  # noqa: PLC0415

    return tuple(bool(row["satisfied"]) for row in fact_rows(facts, seen, knowledge.schema))


def _audit(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.worlds.libero.audit.measures import MEASURES, StateEvidence  # noqa: PLC0415

    none = cast(Any, None)
    evidence = StateEvidence(none, none, _required(facts), seen, seen, knowledge.schema)
    answers = tuple(bool(reading.holds) for reading in MEASURES["initial_fact"](evidence))
    (goal,) = MEASURES["goal"](evidence)
    return answers if goal.holds == (not all(answers)) else ()


def _planners(facts: Sequence[Fact], seen: Observation, _knowledge: Knowledge) -> Answers:
    from runtime.planning.guided import standing  # noqa: PLC0415

    alone = [standing(_required([fact]), _one(seen, index)) for index, fact in enumerate(facts)]
    observed = (bool(each) for each in seen.observed)
    return tuple(there and false == 0 and lacking == 0 for there, (false, lacking) in zip(observed, alone, strict=True))


def _proposers(facts: Sequence[Fact], seen: Observation, _knowledge: Knowledge) -> Answers:
    from runtime.worlds.libero.proposers.candidates import StateCandidate, ranked  # noqa: PLC0415

    def offered(index: int) -> bool:
        request = SimpleNamespace(
            required=_required(facts), diagnosis=SimpleNamespace(index=index), qpos=np.zeros(1), observe=lambda _: seen
        )
        return any(True for _ in ranked(cast(Any, request), [[StateCandidate(np.ones(1), "")]]))

    return tuple(offered(index) for index in range(len(facts)))


def _skills(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.worlds.libero.skills.order import ready  # noqa: PLC0415

    steps = ready(_required(facts), seen, stack("sim", 0, []), knowledge)
    return _without([step.index for step in steps], len(facts))


def _trace(facts: Sequence[Fact], seen: Observation, knowledge: Knowledge) -> Answers:
    from runtime.trace.narrate import premise_sentence  # noqa: PLC0415

    def sentence(index: int, fact: Fact) -> str:
        episode = SimpleNamespace(required=_required([fact]), premise=_one(seen, index))
        return premise_sentence(cast(Any, episode), knowledge.schema)

    return tuple("does not hold" not in sentence(index, fact) for index, fact in enumerate(facts))


def _one(seen: Observation, index: int) -> Observation:
    part = slice(index, index + 1)
    arrays = (seen.observed[part], seen.truth[part], seen.margin[part], seen.score[part])
    return Observation(seen.source, seen.step, *arrays, seen.limit[part])


PARTS: Mapping[str, Callable[[Sequence[Fact], Observation, Knowledge], Answers]] = {
    "audit": _audit,
    "info of environments": _info,
    "loop": _loop,
    "monitor": _monitor,
    "planners": _planners,
    "proposers": _proposers,
    "skills": _skills,
    "trace": _trace,
}
"""Whatever decides that a fact holds; each is asked through the function that the program itself calls."""


def random_case(rng: np.random.Generator) -> tuple[tuple[Fact, ...], Observation]:
    """One to four facts on different objects, of any polarity, threshold and tolerance, and what is seen of them."""
    count = int(rng.integers(1, 5))
    facts = tuple(
        Fact(
            MAN + "on",
            (Entity(f"bowl_{index}", MAN + "Object"), Entity(f"plate_{index}", MAN + "Object")),
            NativeAtom("On", (f"bowl_{index}", f"plate_{index}")),
            "on_object",
            bool(rng.integers(2)),
            float(rng.choice([0.0, 0.01, -0.02])),
        )
        for index in range(count)
    )
    margins = rng.choice([float("nan"), 0.0, 0.01, -0.01, 0.015, -0.015, 0.03, -0.03], size=count)
    evidence = [Evidence(bool(rng.integers(2)), float(margin)) if rng.random() > 0.15 else None for margin in margins]
    return facts, stack("sim", 0, evidence)


def differing(cases: int, seed: int) -> dict[str, int]:
    """How often each part of :data:`PARTS` differed from :func:`expected`; those that never did are left out."""
    knowledge, rng = load_knowledge(), np.random.default_rng(seed)
    found: dict[str, int] = {}
    for _ in range(cases):
        facts, seen = random_case(rng)
        wanted = expected(facts, seen)
        for name, part in PARTS.items():
            if part(facts, seen, knowledge) != wanted:
                found[name] = found.get(name, 0) + 1
    return found
