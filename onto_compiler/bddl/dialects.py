"""The dialects of BDDL: one grammar, and what a task file must have depends on the domain that it names.

LIBERO-Plus and LIBERO-PRO write LIBERO's own dialect: what they vary is the scene and the instruction. BEHAVIOR's tasks
name WordNet categories, bind variables by quantifiers, and have no instruction. PointMaze's and robosuite's tasks are
ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

__all__ = ["BEHAVIOR", "DIALECTS", "LIBERO", "POINTMAZE", "ROBOSUITE", "Dialect", "dialect_of"]


@dataclass(frozen=True, slots=True)
class Dialect:
    """``domains`` are the names that mark a task as this dialect's; ``needed`` are the sections that it cannot lack."""

    name: str
    domains: frozenset[str]
    needed: tuple[str, ...]
    supports: tuple[str, ...]  # predicates for what an object rests on, in lower case
    contains: tuple[str, ...]  # predicates for what an object is in
    opposites: tuple[tuple[str, str], ...]  # unary predicates that exclude each other
    places: tuple[str, ...]  # predicates for an object's initial position; none: every fact counts
    tolerant: bool = False  # its own reader accepts mistakes in its published files; so do we, with a warning


LIBERO: Final = Dialect(
    name="LIBERO",
    domains=frozenset({"robosuite"}),
    needed=("problem", "domain", "language", "init", "goal"),
    supports=("on",),
    contains=("in",),
    opposites=(("open", "close"), ("turnon", "turnoff")),
    places=("on", "in"),
)
# Substances have no place of their own (`filled`, `covered`), and what is `future` is made by the robot.
BEHAVIOR: Final = Dialect(
    name="BEHAVIOR",
    domains=frozenset({"igibson", "omnigibson"}),
    needed=("problem", "domain", "init", "goal"),
    supports=("ontop",),
    contains=("inside",),
    opposites=(("folded", "unfolded"),),
    places=(),
    tolerant=True,
)
# A maze says what is in it, and its trials say where: no fact places anything.
POINTMAZE: Final = Dialect(
    name="PointMaze",
    domains=frozenset({"pointmaze"}),
    needed=("problem", "domain", "language", "init", "goal"),
    supports=(),
    contains=(),
    opposites=(),
    places=(),
)
# robosuite places its objects itself, and its tasks are ours: a task file says what the success condition asks for.
ROBOSUITE: Final = Dialect(
    name="robosuite",
    domains=frozenset({"robosuite_suite"}),
    needed=("problem", "domain", "language", "init", "goal"),
    supports=(),
    contains=(),
    opposites=(),
    places=(),
)
DIALECTS: Final = (LIBERO, BEHAVIOR, POINTMAZE, ROBOSUITE)


def dialect_of(domain: str) -> Dialect:
    """The dialect of the tasks of ``domain``; LIBERO's where nobody else claims it."""
    return next((dialect for dialect in DIALECTS if domain.lower() in dialect.domains), LIBERO)
