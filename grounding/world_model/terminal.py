"""The heads' inputs from a predicted state and its goal, scaled; unsensed coordinates are left out."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn

__all__ = ["Scaling"]


class Scaling(nn.Module):
    """``centre`` and ``scale`` (P,) of the proprioception; ``feature_scale``, the spread of all D features."""

    def __init__(self, centre: Sequence[float], scale: Sequence[float], features: int, feature_scale: float) -> None:
        super().__init__()
        self.features, self.feature_scale, self.size = features, feature_scale, len(centre)
        self.register_buffer("centre", torch.tensor(centre, dtype=torch.float32), persistent=False)
        self.register_buffer("scale", torch.tensor(scale, dtype=torch.float32), persistent=False)

    def proprio(self, proprio: torch.Tensor, sensed: torch.Tensor) -> torch.Tensor:
        """``proprio`` (..., P) with zero for what is not ``sensed``, and which coordinates are (..., 2 P)."""
        scaled = torch.where(sensed, (proprio - self.centre) / self.scale, 0.0)
        return torch.cat([scaled, sensed.to(scaled).expand_as(scaled)], dim=-1)

    def look(self, features: torch.Tensor) -> torch.Tensor:
        """``features`` (..., D), scaled."""
        return features / self.feature_scale
