"""What a candidate costs: features, events, and the typed facts of the predicted ABox, each term by its weight.

J = w_f C_feature - S_event and J_onto = w_f C_feature - S_onto of the paper (section 4) are two choices of the active
terms. The ontology declares them (``plan:Score``); :class:`Weights` is one of them as a scorer reads it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import torch

from grounding.world_model.dynamics import Dynamics, Imagined, spread
from grounding.world_model.events import EventHead
from grounding.world_model.pred import ObservedGoal, PredGrounder
from onto_compiler.problems import OntoError, near
from onto_compiler.schema import Score, local_name

__all__ = ["Scorer", "Weighted", "Weights"]

_FIELDS = {
    "feature_gap": "feature",
    "proprioception_gap": "proprio",
    "remaining_way": "remaining",
    "uncertainty": "uncertainty",
    "success": "success",
    "feasibility": "feasibility",
    "consistency": "consistency",
}
_OF_FACTS = {"fact_margin": "margins", "fact_score": "scores"}


class Scorer(Protocol):
    """Costs (N,) of N imagined candidates; lower is better."""

    def __call__(self, imagined: Imagined, goal: ObservedGoal) -> torch.Tensor:
        """One number for each candidate."""


@dataclass(frozen=True, slots=True)
class Weights:
    """The active terms of a score. A term that is 0 or absent is not computed.

    Costs: ``feature`` and ``proprio``, mean squared distances to the goal in units of their scale; ``remaining``, path
    length in metres; ``uncertainty``, of the event head. Rewards: ``success``, ``feasibility``, ``consistency``,
    probabilities of the event head; ``margins`` and ``scores`` by predicate, in the margin's unit and as probabilities.
    """

    feature: float = 0.0
    proprio: float = 0.0
    remaining: float = 0.0
    uncertainty: float = 0.0
    success: float = 0.0
    feasibility: float = 0.0
    consistency: float = 0.0
    margins: Mapping[str, float] = field(default_factory=dict)
    scores: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, score: Score) -> Weights:
        """The weights that ``score`` declares; raises ``PMZ009`` if it weighs a field that no scorer computes."""
        found: dict[str, Any] = {name: {} for name in _OF_FACTS.values()}
        for term in score.terms:
            name = local_name(term.field)
            if name in _FIELDS:
                found[_FIELDS[name]] = term.weight
            elif name in _OF_FACTS and term.predicate is not None:
                found[_OF_FACTS[name]][local_name(term.predicate)] = term.weight
            else:
                known = [*_FIELDS, *_OF_FACTS]
                message = f"the score `{score.name}` weighs `{name}`, which no scorer computes"
                hint = near(name, known) or f"fields: {', '.join(known)}; those of facts name a predicate"
                raise OntoError.of("PMZ009", message, hint)
        return cls(**found)

    @property
    def events(self) -> bool:
        """Whether the event head is needed."""
        return any((self.remaining, self.uncertainty, self.success, self.feasibility, self.consistency))


class Weighted:
    """A :class:`Scorer` by weights, over the ends of candidates; every term is a mean over the dynamics' members."""

    def __init__(self, weights: Weights, dynamics: Dynamics, events: EventHead, grounder: PredGrounder) -> None:
        self.weights, self._dynamics, self._events, self._grounder = weights, dynamics, events, grounder
        names = [local_name(fact.predicate) for fact in grounder.facts]
        self._margins = torch.tensor([float(weights.margins.get(name, 0.0)) for name in names])
        self._scores = torch.tensor([float(weights.scores.get(name, 0.0)) for name in names])

    def __call__(self, imagined: Imagined, goal: ObservedGoal) -> torch.Tensor:
        """Costs (N,)."""
        weights, scale = self.weights, self._dynamics.motion.scale
        features, proprio = imagined.features[:, :, -1], imagined.proprio[:, :, -1]
        cost = torch.zeros(proprio.shape[1], device=proprio.device)
        if weights.feature:
            gap = (features - goal.features) / self._dynamics.feature_scale
            cost = cost + weights.feature * gap.square().mean(dim=(0, -1))
        if weights.proprio:
            gap = torch.where(goal.sensed, (proprio - goal.proprio) / scale, 0.0)
            cost = cost + weights.proprio * gap.square().mean(dim=(0, -1))
        if weights.events:
            doubt = spread(proprio, scale)
            found = self._events(features, proprio, goal.features, goal.proprio, doubt, goal.sensed)
            cost = cost + (
                weights.remaining * found.remaining
                + weights.uncertainty * found.uncertainty
                - weights.success * found.success.sigmoid()
                - weights.feasibility * found.feasibility.sigmoid()
                - weights.consistency * found.consistency.sigmoid()
            ).mean(dim=0)
        if weights.margins or weights.scores:
            facts = self._grounder.ground(imagined, goal)
            cost = cost - facts.margin @ self._margins.to(cost) - facts.score @ self._scores.to(cost)
        return cost
