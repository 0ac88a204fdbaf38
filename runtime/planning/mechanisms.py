"""What a typed failure of a plan is answered with: one mechanism for each plan route that the ontology declares.

Each spends about one budget of candidates (a longer horizon two, being imagined twice as far) and returns its best, or
None if it has none to offer. The best plan so far competes within each, so that none returns a worse one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import torch

from grounding.world_model.dynamics import Imagined
from runtime.loop.diagnosis import requirement
from runtime.loop.records import Diagnosis
from runtime.planning.cem import Candidate, SamplingDistribution, search
from runtime.planning.problem import PlanningProblem

__all__ = ["Mechanism", "again", "longer_horizon", "match_velocity", "resample_around_margin", "waypoint"]

Mechanism = Callable[[PlanningProblem, Candidate, Diagnosis, torch.Generator], Candidate | None]

_NARROW = 0.2
"""Standard deviation of the candidates around a plan that is nearly right."""
_URGENT = 1.0
"""What a unit of a margin's lack adds to a candidate's cost; of the diagnosed one it adds twice as much."""
_DESCENTS, _STEPS, _RATE = 16, 56, 0.05
"""Plans that are descended at once, and for how many steps; a gradient counts as three evaluations."""
_OFF = 0.05
"""Standard deviation of what actions are off by while they are descended."""


def resample_around_margin(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Draw candidates narrowly around the best plan, scored with what margins lack on top."""
    region = SamplingDistribution(best.actions, torch.full_like(best.actions, _NARROW))
    urgent = _urging(question, diagnosis)
    with torch.no_grad():
        return search(
            lambda actions: urgent(question.imagine(actions)),
            region, question.budget, question.sampling, random, best, question.judge(urgent),
        )  # fmt: skip


def match_velocity(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Descend the gradient of cost and lack through the dynamics, from the best plan and from plans around it.

    Each step is taken a little off, so that what is found is wide: where a model is wrong it is so in narrow places.
    """
    urgent = _urging(question, diagnosis)

    def noise(scale: float) -> torch.Tensor:
        return scale * torch.randn((_DESCENTS, *best.actions.shape), generator=random).to(best.actions)

    plans = (best.actions + noise(0.5 * _NARROW)).clamp(-1, 1)
    plans[0] = best.actions
    plans.requires_grad_(requires_grad=True)
    optimiser = torch.optim.Adam([plans], lr=_RATE)
    for step in range(_STEPS):
        for group in optimiser.param_groups:
            group["lr"] = _RATE * (1 - step / _STEPS) + 0.05 * _RATE
        optimiser.zero_grad()
        urgent(question.imagine(plans + noise(_OFF))).sum().backward()
        optimiser.step()
        with torch.no_grad():
            plans.clamp_(-1, 1)
    ends, judge = plans.detach(), question.judge(urgent)
    with torch.no_grad():
        costs = judge.cost(ends)
    place = int(costs.argmin())
    return Candidate(ends[place], float(costs[place]), (3 * _STEPS + judge.copies) * _DESCENTS, best.region)


def longer_horizon(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Plan over twice the steps, the best plan first; None where fewer are left."""
    del diagnosis
    steps, macro = len(best.actions), question.dynamics.macro
    if 2 * steps > question.longest * macro:
        return None
    with torch.no_grad():
        wide = SamplingDistribution.everywhere(2 * steps, question.actions, question.sampling, best.actions.device)
        region = SamplingDistribution(torch.cat([best.actions, torch.zeros_like(best.actions)]), wide.deviation)
        found = search(question.cost, region, question.budget, question.sampling, random, judge=question.judge())
        return replace(found, evaluations=2 * found.evaluations)  # of plans that are twice as long


def waypoint(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Go to the middle of the way through the free cells first, then on; None if no cell lies between."""
    del diagnosis
    if question.between is None:
        return None
    macro, place = question.dynamics.macro, question.between
    half = len(best.actions) // macro // 2 * macro
    budget = replace(question.budget, iterations=max(question.budget.iterations // 2, 1))

    def away(actions: torch.Tensor) -> torch.Tensor:
        there = question.imagine(actions).proprio[:, :, -1, : place.numel()]
        return (there - place).norm(dim=-1).mean(dim=0)

    def onward(actions: torch.Tensor) -> torch.Tensor:
        return question.cost(torch.cat([there.actions.expand(len(actions), -1, -1), actions], dim=1))

    with torch.no_grad():
        device = best.actions.device
        start = SamplingDistribution.everywhere(half, question.actions, question.sampling, device)
        there = search(away, start, budget, question.sampling, random)
        rest = SamplingDistribution.everywhere(len(best.actions) - half, question.actions, question.sampling, device)
        on = search(onward, rest, budget, question.sampling, random)
        spent = there.evaluations + on.evaluations
        return Candidate(torch.cat([there.actions, on.actions]), on.cost, spent, best.region)


def again(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Search everywhere once more, whatever failed: what a guided search is compared with."""
    del diagnosis
    region = SamplingDistribution.everywhere(
        len(best.actions), question.actions, question.sampling, best.actions.device
    )
    with torch.no_grad():
        return search(question.cost, region, question.budget, question.sampling, random, best, question.judge())


def _urging(question: PlanningProblem, diagnosis: Diagnosis) -> Callable[[Imagined], torch.Tensor]:
    """The question's cost, and on top what observed margins lack of what is required, the diagnosed one's twice over.

    Were the others left out, a plan would be bettered in one fact by giving up another.
    """
    sign, least = (torch.from_numpy(each) for each in requirement(question.grounder.facts))
    weight = _URGENT * torch.from_numpy(question.grounder.observed).float()
    weight[diagnosis.index] *= 2

    def price(imagined: Imagined) -> torch.Tensor:
        margin = question.grounder.ground(imagined, question.goal).margin
        lack = (least.to(margin) - sign.to(margin) * margin).clamp(min=0)
        return question.price(imagined) + lack @ weight.to(margin)

    return price
