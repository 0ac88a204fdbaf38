"""Registered measures: each turns the scene's states before and after settling into readings by subject.

The ontology says which reading is a failure. A measure whose kind has no tolerance decides itself (``holds``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from math import atan2, hypot

import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.diagnosis import by_distance, satisfied, surplus, unmet
from runtime.wording import atom, unit_of
from runtime.worlds.libero.audit.scene_state import SceneState

__all__ = ["DECIDING", "MEASURES", "Reading", "StateEvidence"]


@dataclass(frozen=True, slots=True)
class Reading:
    """The value of one measure for ``subject``.

    ``value`` is a magnitude, for which the kind of failure has a tolerance; or, if ``holds`` is not None, a signed
    margin, positive when satisfied. ``fact`` is the index of its fact, ``limit`` the deciding term.
    """

    subject: str
    value: float
    holds: bool | None = None
    unit: str = ""
    limit: str = ""
    fact: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class StateEvidence:
    """One initial state: the scene when it is set and after settling, and the facts observed after settling.

    ``premise`` and ``goal`` are aligned with those facts of ``required``, which are all that can be grounded.
    """

    before: SceneState
    after: SceneState
    required: RequiredABox
    premise: Observation
    goal: Observation
    schema: Schema


def _displacement(stage: StateEvidence) -> Iterator[Reading]:
    """Metres between the positions before and after, seen from above."""
    for name, (before, _, after, _) in _poses(stage):
        yield Reading(name, hypot(after[0] - before[0], after[1] - before[1]))


def _fall(stage: StateEvidence) -> Iterator[Reading]:
    """Metres by which the origin fell; negative if it rose."""
    for name, (before, _, after, _) in _poses(stage):
        yield Reading(name, float(before[2] - after[2]))


def _tilt(stage: StateEvidence) -> Iterator[Reading]:
    """Radians by which the angle changed between the vertical and the axis of the object that was nearest to it.

    Which axis of its own an asset has upright differs, and a turn about the vertical must not count.
    """
    for name, (_, first, _, second) in _poses(stage):
        axis = int(np.argmax(np.abs(first[2])))
        yield Reading(name, float(np.arccos(np.clip(first[:, axis] @ second[:, axis], -1.0, 1.0))))


def _turn(stage: StateEvidence) -> Iterator[Reading]:
    """Radians of the whole rotation's part about the vertical: the twist of its quaternion."""
    for name, (_, first, _, second) in _poses(stage):
        rotation = second @ first.T
        yield Reading(name, abs(atan2(rotation[1, 0] - rotation[0, 1], rotation[0, 0] + rotation[1, 1])))


def _hinge(stage: StateEvidence) -> Iterator[Reading]:
    """Radians between the positions of a hinge before and after."""
    for name, before in stage.before.hinges.items():
        yield Reading(name, abs(stage.after.hinges[name] - before))


def _slide(stage: StateEvidence) -> Iterator[Reading]:
    """Metres between the positions of a slide before and after."""
    for name, before in stage.before.slides.items():
        yield Reading(name, abs(stage.after.slides[name] - before))


def _overlap(stage: StateEvidence) -> Iterator[Reading]:
    """Metres of the deepest contact of each two objects or fixtures when the state is set."""
    return (Reading(pair, depth) for pair, depth in stage.before.depths.items())


def _sunk(stage: StateEvidence) -> Iterator[Reading]:
    """Metres of the deepest contact of each object with table, floor or robot when the state is set."""
    return (Reading(pair, depth) for pair, depth in stage.before.sunk.items())


def _penetration(stage: StateEvidence) -> Iterator[Reading]:
    """Metres of the deepest contact of each pair, of whatever kind, after settling."""
    return (Reading(pair, depth) for pair, depth in (*stage.after.depths.items(), *stage.after.sunk.items()))


def _initial_fact(stage: StateEvidence) -> Iterator[Reading]:
    """The signed margin of each declared initial fact, above what its binding requires or tolerates."""
    facts = stage.required.premise
    holds, margins = satisfied(facts, stage.premise), surplus(facts, stage.premise)
    for index, fact in enumerate(facts):
        unit, limit = unit_of(fact, stage.schema), stage.premise.limit[index]
        yield Reading(atom(fact, stage.schema), float(margins[index]), bool(holds[index]), unit, limit, index)


def _goal(stage: StateEvidence) -> Iterator[Reading]:
    """Minus the smallest margin of the nearest alternative of the goal: positive while the goal does not hold yet."""
    facts, observation = stage.required.facts, stage.goal
    way = by_distance(stage.required, observation)[0]
    margins = surplus(facts, observation)
    worst = min(way, key=lambda index: float(margins[index]))
    subject = " and ".join(atom(facts[index], stage.schema) for index in way)
    still_to_do = bool(unmet(stage.required, observation))
    lacking, unit = -float(margins[worst]), unit_of(facts[worst], stage.schema)
    yield Reading(subject, lacking, still_to_do, unit, observation.limit[worst])


Pose = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def _poses(stage: StateEvidence) -> Iterator[tuple[str, Pose]]:
    for name, before in stage.before.poses.items():
        yield name, tuple(chain(before, stage.after.poses[name]))  # type: ignore[misc]  # two and two arrays


MEASURES: Mapping[str, Callable[[StateEvidence], Iterator[Reading]]] = {
    "displacement": _displacement,
    "fall": _fall,
    "goal": _goal,
    "hinge": _hinge,
    "initial_fact": _initial_fact,
    "overlap": _overlap,
    "penetration": _penetration,
    "slide": _slide,
    "sunk": _sunk,
    "tilt": _tilt,
    "turn": _turn,
}
"""By name, as ``audit:measuredBy`` gives it."""
DECIDING = frozenset({"goal", "initial_fact"})
"""The measures that decide themselves whether a reading is a failure."""
