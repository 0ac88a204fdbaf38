"""Diagnosis-guided search: while the best plan's predicted facts miss the goal, the rules say what to try (plan level).

Algorithm 1 of the paper on predictions: a plan whose facts all hold is retained, which is no success. Plans are
compared by, in this order, fewer false facts, fewer steps, smaller deficits of the margins and lower cost, as
:meth:`PlanningProblem.judged` has them. A longer plan uses the time of another observation and another plan, so it
must make more facts true. The control conditions differ in one thing: the mechanism is drawn at random, whatever the
diagnosis.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import torch

from grounding.observation import Observation
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, FIRST, REPEAT, STATUSES
from runtime.loop.diagnosis import diagnose_goal, evidence_status, lack, select, unmet
from runtime.loop.records import Diagnosis, RouteDecision
from runtime.loop.routing import route_or_none
from runtime.planning.cem import Candidate
from runtime.planning.mechanisms import Mechanism
from runtime.planning.problem import COPIES, PlanningProblem

__all__ = ["MechanismTrial", "SearchResult", "improve", "standing"]

LEVEL = "plan"
_PATIENCE = 2
"""Routes that may fail for a fact before the next unmet fact is tried."""


@dataclass(frozen=True, slots=True, eq=False)
class MechanismTrial:
    """One attempt to improve a plan: whether its plan replaced the best one, and the prediction for it.

    ``before``: the prediction for the best plan before it, which was diagnosed.
    """

    before: Observation
    diagnosis: Diagnosis
    decision: RouteDecision | None
    mechanism: str
    evaluations: int
    better: bool
    observation: Observation | None


@dataclass(frozen=True, slots=True, eq=False)
class SearchResult:
    """The best plan, whether all its required facts are predicted to hold, and the attempts."""

    found: Candidate
    observation: Observation
    retained: bool
    evaluations: int
    tried: tuple[MechanismTrial, ...]


def improve(
    question: PlanningProblem,
    first: Candidate,
    required: RequiredABox,
    knowledge: Knowledge,
    mechanisms: Mapping[str, Mechanism],
    allowance: int,
    random: torch.Generator,
    instead: Mapping[str, Mechanism] | None = None,
) -> SearchResult:
    """Improve ``first`` until its predicted facts hold, no route is left, or ``allowance`` evaluations are spent.

    A fact without evidence is skipped: no predicted plan gives evidence of it.

    ``mechanisms`` are by the local name of their route. With ``instead``, one of its mechanisms is drawn at random in
    place of the one that the rules choose: a control condition with the same budget and acceptance rule.
    """
    best, (seen, price) = first, question.judged(first)
    spent, tried = COPIES, list[MechanismTrial]()
    refused = dict[int, list[str]]()  # of each fact, the routes that did not improve the best plan
    while spent < allowance:
        found = [each for each in diagnose_goal(required, seen, knowledge.tables) if each.status != ABSENT]
        if not found:
            break
        left = [diagnosis for diagnosis in found if len(refused.get(diagnosis.index, ())) < _PATIENCE]
        if not left:
            if not any(each.evaluations for each in tried[-_PATIENCE * len(found) :]):
                break
            refused.clear()
            continue
        diagnosis = select(left)
        earlier = refused.setdefault(diagnosis.index, [])
        status, previous = (REPEAT, earlier[-1]) if earlier else (FIRST, None)
        decision = None if instead else route_or_none(diagnosis, knowledge, status, previous, level=LEVEL)
        choices = _shuffled(instead, random) if instead else [local_name(decision.route)] if decision else []
        name, answer = _first(choices, instead or mechanisms, question, best, diagnosis, random)
        if answer is None:
            tried.append(MechanismTrial(seen, diagnosis, decision, name, 0, better=False, observation=None))
            earlier += [decision.route] if decision else [""] * _PATIENCE
            continue
        spent += answer.evaluations + COPIES
        there, cost = question.judged(answer)
        better = _rank(required, answer, there, cost) < _rank(required, best, seen, price)
        tried.append(
            MechanismTrial(seen, diagnosis, decision, name, answer.evaluations, better=better, observation=there)
        )
        if better:
            best, seen, price = answer, there, cost
            refused.clear()
        else:
            earlier.append(decision.route if decision else "")
    return SearchResult(best, seen, not unmet(required, seen), spent, tuple(tried))


def _rank(required: RequiredABox, plan: Candidate, seen: Observation, cost: float) -> tuple[int, int, float, float]:
    """The key by which plans are compared, lower is better: their observed facts, and their cost."""
    false, lacking = standing(required, seen)
    return false, len(plan.actions), lacking, cost


def standing(required: RequiredABox, seen: Observation) -> tuple[int, float]:
    """Over the observed facts: how many are explicitly false, and the sum of their margins' deficits."""
    false = evidence_status(required.facts, seen) == STATUSES.index(EXPLICITLY_FALSE)
    missing = lack(required.facts, seen)[seen.observed]
    return int(false.sum()), float(np.nansum(missing))


def _shuffled(names: Iterable[str], random: torch.Generator) -> list[str]:
    known = sorted(names)
    return [known[int(place)] for place in torch.randperm(len(known), generator=random)]


def _first(
    names: Sequence[str],
    mechanisms: Mapping[str, Mechanism],
    question: PlanningProblem,
    best: Candidate,
    diagnosis: Diagnosis,
    random: torch.Generator,
) -> tuple[str, Candidate | None]:
    """The first of ``names`` with a result, and that result; the last of them if none has one."""
    name = ""
    for name in names:
        mechanism = mechanisms.get(name)
        answer = mechanism(question, best, diagnosis, random) if mechanism else None
        if answer is not None:
            return name, answer
    return name, None
