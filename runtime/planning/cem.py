"""The cross-entropy method over action sequences, with coloured noise and kept elites (iCEM).

The best of thousands of candidates is partly lucky, for example if it just misses a wall. So the evaluations of the
last iteration may be spent on evaluating the few best candidates again, each from many sampled initial states.

Sources: DINO-WM ``planning/cem.py`` for budget and form; Pinneri et al., "Sample-efficient cross-entropy method for
real-time planning" (2020), for coloured noise, kept elites and returning the best candidate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import torch

__all__ = ["Budget", "Candidate", "Judge", "Sampling", "SamplingDistribution", "coloured", "search"]

Cost = Callable[[torch.Tensor], torch.Tensor]
"""Candidates (N, T, A) to costs (N,); lower is better."""


@dataclass(frozen=True, slots=True)
class Budget:
    """DINO-WM's: ``samples`` candidates in each of ``iterations``, of which ``elites`` shape the next."""

    samples: int = 300
    elites: int = 30
    iterations: int = 10

    @property
    def evaluations(self) -> int:
        """Candidates in all."""
        return self.samples * self.iterations


@dataclass(frozen=True, slots=True, eq=False)
class Judge:
    """Evaluates candidates again: its ``cost`` of a candidate takes ``copies`` evaluations."""

    cost: Cost
    copies: int


@dataclass(frozen=True, slots=True)
class Sampling:
    """How candidates are sampled, the same for every row of a comparison.

    ``deviation`` of the first candidates, by default that of actions uniform in [-1, 1]; ``colour``: the
    exponent with which the noise's power falls with frequency; ``kept`` elites stay in the next iteration; ``momentum``
    is the share of the old mean and deviation that is retained.
    """

    deviation: float = 0.577
    colour: float = 1.0
    kept: int = 5
    momentum: float = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class SamplingDistribution:
    """The sampling distribution of a search: normal with ``mean`` (T, A) and ``deviation`` (T, A)."""

    mean: torch.Tensor
    deviation: torch.Tensor

    @classmethod
    def everywhere(
        cls, steps: int, actions: int, sampling: Sampling, device: str | torch.device = "cpu"
    ) -> SamplingDistribution:
        """Centred on zero actions."""
        mean = torch.zeros(steps, actions, device=device)
        return cls(mean, torch.full_like(mean, sampling.deviation))


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """The best candidate ``actions`` (T, A), its ``cost``, the number of evaluations, and the last ``region``."""

    actions: torch.Tensor
    cost: float
    evaluations: int
    region: SamplingDistribution


def search(
    cost: Cost,
    region: SamplingDistribution,
    budget: Budget,
    sampling: Sampling,
    random: torch.Generator,
    known: Candidate | None = None,
    judge: Judge | None = None,
) -> Candidate:
    """Minimise ``cost`` over actions in [-1, 1], starting from ``region``; ``known`` candidates compete from the start.

    With a ``judge``, the last iteration's evaluations go to the last elites, the mean of the last region and the known
    candidates. The result is the one that the judge finds cheapest, with the judge's cost.
    """
    rounds = budget.iterations - (judge is not None)
    if rounds < 1:
        raise ValueError("a search needs an iteration, and one more where there is a judge")
    best, spent = known, rounds * budget.samples
    elites = region.mean[None][:0] if known is None else known.actions[None]
    for _ in range(rounds):
        noise = coloured((budget.samples, *region.mean.shape), sampling.colour, random).to(region.mean.device)
        candidates = region.mean + region.deviation * noise
        candidates[0] = region.mean
        kept = elites[: sampling.kept]
        candidates[1 : 1 + len(kept)] = kept
        candidates = candidates.clamp(-1, 1)
        costs = cost(candidates)
        order = torch.argsort(costs)[: budget.elites]
        elites = candidates[order]
        if judge is None and (best is None or float(costs[order[0]]) < best.cost):
            best = Candidate(elites[0], float(costs[order[0]]), 0, region)
        region = _towards(region, elites, sampling.momentum)
    if judge is None:
        if best is None:
            raise AssertionError("the first iteration finds one")
        return replace(best, evaluations=spent, region=region)
    others = torch.stack([region.mean.clamp(-1, 1), *([] if known is None else [known.actions])])
    finalists = torch.cat([elites[: max(budget.samples // judge.copies - len(others), 1)], others])
    costs = judge.cost(finalists)
    place = int(costs.argmin())
    return Candidate(finalists[place], float(costs[place]), spent + judge.copies * len(finalists), region)


def coloured(shape: tuple[int, int, int], colour: float, random: torch.Generator) -> torch.Tensor:
    """Normal noise (N, T, A) whose power falls along T with the frequency to the ``colour``; unit variance."""
    if colour == 0:
        return torch.randn(shape, generator=random)
    rows, steps, actions = shape
    weight = torch.fft.rfftfreq(steps)
    weight[0] = weight[1:2].sum() or 1.0
    weight = weight ** (-colour / 2)
    white = torch.fft.rfft(torch.randn((rows, actions, steps), generator=random))
    twice = torch.full_like(weight, 2.0)  # each frequency but the first, and the last of an even number, stands for two
    twice[0] = 1.0
    if steps % 2 == 0:
        twice[-1] = 1.0
    deviation = ((twice * weight.square()).sum() / steps).sqrt()
    return torch.fft.irfft(white * weight / deviation, n=steps).transpose(1, 2)


def _towards(region: SamplingDistribution, elites: torch.Tensor, momentum: float) -> SamplingDistribution:
    """The normal distribution of ``elites`` (K, T, A), a little of ``region`` left."""
    return SamplingDistribution(
        momentum * region.mean + (1 - momentum) * elites.mean(dim=0),
        momentum * region.deviation + (1 - momentum) * elites.std(dim=0),
    )
