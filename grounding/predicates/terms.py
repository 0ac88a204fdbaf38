"""What a grounding function is made of: named terms, each with a signed margin, and how they combine."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import mujoco

from grounding.observation import Evidence
from grounding.plans import Plan

__all__ = ["Condition", "Grounding", "Term", "all_of", "any_of"]


@dataclass(frozen=True, slots=True)
class Term:
    """One condition of a predicate.

    ``holds`` is decided as the native code decides it; ``margin`` (metres or radians) is positive only when it holds
    and negative only when it does not; exactly 0 at equality. ``of`` names the joint or geoms meant, where there are
    several.
    """

    name: str
    margin: float
    holds: bool
    of: str = ""


class Condition(Protocol):
    """A condition that is expensive to measure, and so evaluated last."""

    def __call__(self, data: mujoco.MjData, least: float = ...) -> Term:
        """The term of a forwarded state; where its margin is above ``least``, any margin that is, too."""
        ...


@dataclass(frozen=True, slots=True)
class Grounding:
    """One fact's predicate on one scene, ids resolved: call it for :class:`Evidence`, :meth:`terms` for the breakdown.

    ``contact`` is one more condition, the last. ``plan`` says the same conditions in numbers, for who only wants the
    truth; None if it cannot.
    """

    conditions: Callable[[mujoco.MjData], Sequence[Term]]
    combine: Callable[[Sequence[Term]], Evidence]
    plan: Plan | None = None
    contact: Condition | None = None

    def __call__(self, data: mujoco.MjData) -> Evidence:
        """Truth and margin in ``data``, which must be forwarded and belong to the scene's model.

        A gap is not measured to the end once it is known to be smaller than what another condition lacks.
        """
        conditions = self.conditions(data)
        if self.contact is None:
            return self.combine(conditions)
        return self.combine((*conditions, self.contact(data, min(map(_margin, conditions), default=math.inf))))

    def terms(self, data: mujoco.MjData) -> tuple[Term, ...]:
        """Every condition with its own margin."""
        conditions = tuple(self.conditions(data))
        return conditions if self.contact is None else (*conditions, self.contact(data))


def all_of(terms: Sequence[Term]) -> Evidence:
    """Every term must hold: the smallest margin decides. No term at all: true, without limit."""
    if not terms:
        return Evidence(truth=True, margin=float("inf"))
    least = min(terms, key=_margin)
    return Evidence(all(term.holds for term in terms), least.margin, least.name)


def any_of(terms: Sequence[Term]) -> Evidence:
    """One term must hold: the largest margin decides. No term at all: false, out of reach."""
    if not terms:
        return Evidence(truth=False, margin=float("-inf"))
    most = max(terms, key=_margin)
    return Evidence(any(term.holds for term in terms), most.margin, most.name)


def _margin(term: Term) -> float:
    return term.margin
