"""H_omega: the truth score and the margin of each required fact, from a predicted state and the goal's observation.

A relation between two things is read as a distance: each predicate has a place for the state and for the goal in a
small space that it learns, and its margin shrinks with the gap between them. What depends on the state alone is added.
The score is the margin weighed by the model's uncertainty: the larger the ensemble's spread, the nearer to a half.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn
from torch.nn import functional

from grounding.world_model.layers import mlp
from grounding.world_model.terminal import Scaling

__all__ = ["ARCHITECTURE", "FactHead"]

ARCHITECTURE = "facts"
_SOFT = 1e-4
"""Squared length that keeps the gradient of a distance finite where it is zero."""
_SHARPEST = 0.01
"""The least doubt, in the margin's unit."""


class FactHead(nn.Module):
    """``facts``: the local names of the predicates that it speaks of, in the order of its columns."""

    def __init__(
        self,
        facts: Sequence[str],
        centre: Sequence[float],
        scale: Sequence[float],
        features: int,
        feature_scale: float,
        width: int = 64,
        places: int = 6,
    ) -> None:
        super().__init__()
        self.facts, self.places = tuple(facts), places
        self.scaling = Scaling(centre, scale, features, feature_scale)
        proprio, count = 2 * len(centre), len(self.facts)
        self.glimpse = nn.Linear(features, 32)
        self.straight = nn.Linear(proprio, count * places, bias=False)
        self.bent = mlp([32 + proprio, width, count * places], zero=True)
        self.alone = mlp([proprio, width, width, count], zero=True)
        self.offset = nn.Parameter(torch.full((count,), 0.5))
        self.doubt = mlp([proprio + 1, width // 2, count])

    def forward(
        self,
        features: torch.Tensor,
        proprio: torch.Tensor,
        goal_features: torch.Tensor,
        goal_proprio: torch.Tensor,
        spread: torch.Tensor,
        sensed: torch.Tensor,
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Margins and logits of the scores (..., F).

        ``features`` (..., D), ``proprio`` (..., P), the goal's either alike or of one row; ``spread`` (...) as of
        :func:`grounding.world_model.dynamics.spread`; ``sensed`` (..., P) or (P,).
        """
        known = self.scaling.proprio(proprio, sensed)
        gap = self._place(features, known) - self._place(goal_features, self.scaling.proprio(goal_proprio, sensed))
        distance = (gap.square().sum(dim=-1) + _SOFT).sqrt()
        margin = self.offset - distance + self.alone(known)
        doubtful = (spread + 1e-3).log().expand(known.shape[:-1])[..., None]
        doubt = functional.softplus(self.doubt(torch.cat([known, doubtful], dim=-1)))
        return margin, margin / (doubt + _SHARPEST)

    def _place(self, features: torch.Tensor, known: torch.Tensor) -> torch.Tensor:
        """Where each predicate sees a state (..., F, places)."""
        glimpse = self.glimpse(self.scaling.look(features))
        place = self.straight(known) + self.bent(torch.cat([glimpse, known], dim=-1))
        return place.unflatten(-1, (len(self.facts), self.places))
