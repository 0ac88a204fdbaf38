"""The mechanisms that improve a plan with a typed failure, one for each plan route that the ontology declares.

Each spends about one budget of candidates (the longer horizon two, as it predicts twice as many steps) and returns its
best, or None if it has none. The best plan so far competes within each, so that none returns a worse one.
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
"""The cost of one unit of a margin's deficit; that of the diagnosed fact counts twice."""
_DESCENTS, _STEPS, _RATE = 16, 56, 0.05
"""Plans that are optimised at once, and the gradient steps; a gradient counts as three evaluations."""
_OFF = 0.05
"""Standard deviation of the noise on actions during gradient descent."""


def resample_around_margin(
    question: PlanningProblem, best: Candidate, diagnosis: Diagnosis, random: torch.Generator
) -> Candidate | None:
    """Sample candidates close to the best plan; their score includes the margins' deficits."""
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
    """Gradient descent on cost and deficits through the dynamics, from the best plan and from plans around it.

    Noise on each step favours wide minima: a model's errors make narrow ones.
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
    """Plan to the midpoint of the path through the free cells, then on to the goal; None if no cell is in between."""
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
    """Search again without restriction, whatever failed: the baseline of guided search."""
    del diagnosis
    region = SamplingDistribution.everywhere(
        len(best.actions), question.actions, question.sampling, best.actions.device
    )
    with torch.no_grad():
        return search(question.cost, region, question.budget, question.sampling, random, best, question.judge())


def _urging(question: PlanningProblem, diagnosis: Diagnosis) -> Callable[[Imagined], torch.Tensor]:
    """The problem's cost plus the deficits of the observed margins, that of the diagnosed fact counted twice.

    Without the others, a plan would improve one fact at the expense of another.
    """
    sign, least = (torch.from_numpy(each) for each in requirement(question.grounder.facts))
    weight = _URGENT * torch.from_numpy(question.grounder.observed).float()
    weight[diagnosis.index] *= 2

    def price(imagined: Imagined) -> torch.Tensor:
        margin = question.grounder.ground(imagined, question.goal).margin
        lack = (least.to(margin) - sign.to(margin) * margin).clamp(min=0)
        return question.price(imagined) + lack @ weight.to(margin)

    return price
