"""G_psi: EV-WM's scores of a predicted final state: progress, consistency, feasibility, uncertainty, and success.

These are about the task as a whole. Which predicate fails, on which arguments and by how much is what
:mod:`grounding.world_model.facts` adds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import nn
from torch.nn import functional

from grounding.world_model.layers import mlp
from grounding.world_model.terminal import Scaling

__all__ = ["ARCHITECTURE", "EventHead", "Events"]

ARCHITECTURE = "events"


@dataclass(frozen=True, slots=True, eq=False)
class Events:
    """The scores of a predicted final state, each of (...).

    ``remaining``: the remaining distance to the target in metres, which progress reduces; ``success``,
    ``consistency`` (features and proprioception tell of one state) and ``feasibility`` (the state is valid) as logits;
    ``uncertainty``: the expected error of the imagined proprioception, in units of its scale.
    """

    remaining: torch.Tensor
    success: torch.Tensor
    consistency: torch.Tensor
    feasibility: torch.Tensor
    uncertainty: torch.Tensor

    @classmethod
    def of(cls, found: torch.Tensor) -> Events:
        """From a head's raw outputs (..., 5); magnitudes become positive."""
        remaining, success, consistency, feasibility, uncertainty = found.unbind(-1)
        return cls(functional.softplus(remaining), success, consistency, feasibility, functional.softplus(uncertainty))


class EventHead(nn.Module):
    """Built as :class:`grounding.world_model.facts.FactHead`."""

    def __init__(
        self, centre: Sequence[float], scale: Sequence[float], features: int, feature_scale: float, width: int = 128
    ) -> None:
        super().__init__()
        self.scaling = Scaling(centre, scale, features, feature_scale)
        self.glimpse = nn.Linear(features, 32)
        self.network = mlp([2 * 32 + 4 * len(centre) + 1, width, width, 5])

    def forward(
        self,
        features: torch.Tensor,
        proprio: torch.Tensor,
        goal_features: torch.Tensor,
        goal_proprio: torch.Tensor,
        spread: torch.Tensor,
        sensed: torch.Tensor,
    ) -> Events:
        """As :meth:`grounding.world_model.facts.FactHead.forward`, to events of (...)."""
        ends = [self.glimpse(self.scaling.look(each)) for each in (features, goal_features)]
        ends += [self.scaling.proprio(each, sensed) for each in (proprio, goal_proprio)]
        rows = proprio.shape[:-1]
        parts = [*(end.expand(*rows, end.shape[-1]) for end in ends), (spread + 1e-3).log().expand(rows)[..., None]]
        return Events.of(self.network(torch.cat(parts, dim=-1)))
