"""A planning problem: the initial state, the goal and the cost; and the predictions for candidates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import torch

from grounding.observation import Observation
from grounding.world_model.dynamics import Dynamics, History, Imagined
from grounding.world_model.pred import ObservedGoal, PredGrounder
from onto_compiler.problems import OntoError
from runtime.planning.cem import Budget, Candidate, Judge, Sampling
from runtime.planning.scorers import Scorer

__all__ = ["COPIES", "PlanningProblem"]

COPIES = 16
"""Evaluations that it takes to judge a plan."""
_JITTER = 0.01
"""Standard deviation of the actions of its copies."""


@dataclass(frozen=True, eq=False)
class PlanningProblem:
    """One planning problem; raises ``WM010`` if a number of ``history`` or ``goal`` is not finite.

    A plan has at most ``longest`` macro steps. ``between`` (2,): the midpoint of the path from start to goal in the
    task's layout, None if it is unknown or nothing is in between.
    """

    dynamics: Dynamics
    grounder: PredGrounder
    scorer: Scorer
    history: History
    goal: ObservedGoal
    budget: Budget
    sampling: Sampling
    longest: int
    between: torch.Tensor | None = None

    def __post_init__(self) -> None:
        for what, given in (("the picture", self.history.features), ("the goal's picture", self.goal.features)):
            if not bool(given.isfinite().all()):
                raise OntoError.of("WM010", f"the features of {what} are not finite", "encode the picture again")
        known = self.goal.proprio[self.goal.sensed]
        if not bool(self.begin.isfinite().all()) or not bool(known.isfinite().all()):
            raise OntoError.of("WM010", "the proprioception of start or goal is not finite", "read the sensors again")

    @cached_property
    def begin(self) -> torch.Tensor:
        """The initial proprioception (P,), estimated where it is not sensed."""
        return self.dynamics.begin(self.history)

    @property
    def actions(self) -> int:
        """A."""
        return int(self.history.actions.shape[-1])

    @cached_property
    def _random(self) -> torch.Generator:
        return torch.Generator().manual_seed(0)

    def imagine(self, actions: torch.Tensor) -> Imagined:
        """Predictions for candidates (N, T, A), all from the same initial states; T is a multiple of the macro step.

        Each call samples new initial states of the members, so that no plan survives a search by exploiting one.
        """
        return self._imagined(actions, self.dynamics.apart(self.begin[None], self._random))

    def _imagined(self, actions: torch.Tensor, begin: torch.Tensor) -> Imagined:
        macro = self.dynamics.macro
        steps = actions.unflatten(1, (actions.shape[1] // macro, macro))
        return self.dynamics.imagine(self.history.features, begin, steps)

    def cost(self, actions: torch.Tensor) -> torch.Tensor:
        """Costs (N,) of candidates (N, T, A)."""
        return self.price(self.imagine(actions))

    def price(self, imagined: Imagined) -> torch.Tensor:
        """Costs (N,) of predictions."""
        return self.scorer(imagined, self.goal)

    def judge(self, price: Callable[[Imagined], torch.Tensor] | None = None) -> Judge:
        """Evaluates candidates again: the mean ``price`` of their perturbed copies, by default the problem's cost."""
        priced = price or self.price

        def cost(actions: torch.Tensor) -> torch.Tensor:
            return priced(self._copied(actions)).view(len(actions), COPIES).mean(dim=1)

        return Judge(cost, COPIES)

    def judged(self, found: Candidate) -> tuple[Observation, float]:
        """The predicted facts of a plan and its cost, as means over it and over slightly perturbed copies.

        So a fact that holds only for the exact actions, as after a bounce off a wall in the last step, does not hold.
        """
        with torch.no_grad():
            imagined = self._copied(found.actions[None])
            facts = self.grounder.ground(imagined, self.goal)
            mean = replace(
                facts, margin=facts.margin.mean(dim=0, keepdim=True), score=facts.score.mean(dim=0, keepdim=True)
            )
            return mean.observation(0, step=len(found.actions)), float(self.price(imagined).mean())

    def _copied(self, actions: torch.Tensor) -> Imagined:
        """Predictions for candidates (N, T, A) and slightly perturbed copies: COPIES of the first, then of the next."""
        random = torch.Generator().manual_seed(0)  # all plans are judged by the same copies
        jitter = _JITTER * torch.randn((COPIES, *actions.shape[1:]), generator=random).to(actions)
        jitter[0] = 0.0
        begin = self.dynamics.apart(self.begin.expand(COPIES, -1), random)
        copies = (actions[:, None] + jitter).clamp(-1, 1).flatten(0, 1)
        return self._imagined(copies, begin.repeat(1, len(actions), 1))
