"""A plan's question: from where, to which goal, at what cost; and what is predicted of a candidate."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from grounding.observation import Observation
from grounding.world_model.dynamics import Dynamics, History, Imagined
from grounding.world_model.pred import Goal, PredGrounder, Predicted
from onto_compiler.problems import OntoError
from runtime.planning.cem import Budget, Sampling
from runtime.planning.scorers import Scorer

__all__ = ["Question"]


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """One plan to be made. ``horizon`` in macro steps; the most that a mechanism may ask for is ``longest``."""

    dynamics: Dynamics
    grounder: PredGrounder
    scorer: Scorer
    history: History
    goal: Goal
    budget: Budget
    sampling: Sampling
    horizon: int
    longest: int
    begin: torch.Tensor
    actions: int = 2

    @classmethod
    def ask(
        cls,
        dynamics: Dynamics,
        grounder: PredGrounder,
        scorer: Scorer,
        history: History,
        goal: Goal,
        budget: Budget,
        sampling: Sampling,
        horizon: int,
        longest: int,
    ) -> Question:
        """A question whose numbers are finite; raises ``WM010`` where one of history or goal is not."""
        for what, given in (("the picture", history.features), ("the goal's picture", goal.features)):
            if not bool(given.isfinite().all()):
                raise OntoError.of("WM010", f"the features of {what} are not finite", "encode the picture again")
        begin = dynamics.begin(history)
        known = goal.proprio[goal.sensed]
        if not bool(begin.isfinite().all()) or not bool(known.isfinite().all()):
            raise OntoError.of("WM010", "the proprioception of start or goal is not finite", "read the sensors again")
        actions = history.actions.shape[-1]
        return cls(
            dynamics, grounder, scorer, history, goal, budget, sampling, horizon, longest, begin, actions
        )  # fmt: skip

    def imagine(self, actions: torch.Tensor) -> Imagined:
        """What candidates (N, T, A) lead to; T is a multiple of the macro step."""
        macro = self.dynamics.macro
        steps = actions.unflatten(1, (actions.shape[1] // macro, macro))
        return self.dynamics.imagine(self.history.features, self.begin, steps)

    def cost(self, actions: torch.Tensor) -> torch.Tensor:
        """Costs (N,) of candidates (N, T, A)."""
        return self.scorer(self.imagine(actions), self.goal)

    def predicted(self, actions: torch.Tensor) -> Predicted:
        """The facts at the ends of candidates (N, T, A)."""
        return self.grounder.ground(self.imagine(actions), self.goal)

    def observation(self, actions: torch.Tensor) -> Observation:
        """The predicted ABox at the end of one candidate (T, A)."""
        with torch.no_grad():
            return self.predicted(actions[None]).observation(0, step=len(actions))
