"""The environment step of the dynamics: proprioception and action to the next proprioception, by an ensemble.

Contact makes motion jump, and a model that takes five environment steps at once blurs it: so this one takes each of
them. Sines of the position let the networks bend where a wall begins. The members differ in their beginnings and in
the order of their data, so how far they spread says how little is known.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import nn

from grounding.world_model.layers import EnsembleLinear, ensemble_mlp

__all__ = ["Motion"]


class Motion(nn.Module):
    """``centre``, ``scale``, ``bound`` (P,): a coordinate's middle, its spread, and where the environment clips it.

    The first ``places`` coordinates are positions; ``waves`` sines and cosines of each are read beside the
    coordinates, the longest with a period of four ``scale``.
    """

    def __init__(
        self,
        centre: Sequence[float],
        scale: Sequence[float],
        bound: Sequence[float],
        actions: int,
        places: int = 2,
        members: int = 3,
        width: int = 192,
        depth: int = 3,
        waves: int = 6,
    ) -> None:
        super().__init__()
        self.members, self.places = members, places
        size = len(centre)
        self.register_buffer("centre", torch.tensor(centre, dtype=torch.float32), persistent=False)
        self.register_buffer("scale", torch.tensor(scale, dtype=torch.float32), persistent=False)
        self.register_buffer("bound", torch.tensor(bound, dtype=torch.float32), persistent=False)
        self.register_buffer("waves", torch.arange(1, waves + 1) * (math.pi / 2), persistent=False)
        self.linear = EnsembleLinear(members, size + actions, size)
        nn.init.zeros_(self.linear.weight)
        nn.init.zeros_(self.linear.bias)
        self.network = ensemble_mlp(members, [size + actions + 2 * places * waves, *[width] * depth, size])

    def forward(self, proprio: torch.Tensor, action: torch.Tensor) -> torch.Tensor:
        """One environment step: ``proprio`` (M, B, P) and ``action`` (M, B, A) to the next (M, B, P)."""
        begin = torch.minimum(torch.maximum(proprio, -self.bound), self.bound)
        scaled = (begin - self.centre) / self.scale
        plain = torch.cat([scaled, action], dim=-1)
        angles = (scaled[..., : self.places, None] * self.waves).flatten(-2)
        change = self.linear(plain) + self.network(torch.cat([plain, angles.sin(), angles.cos()], dim=-1))
        return begin + change * self.scale

    def path(self, begin: torch.Tensor, actions: torch.Tensor) -> torch.Tensor:
        """All environment steps: ``begin`` (M, B, P) and ``actions`` (B, T, A) to (M, B, T + 1, P)."""
        shared = actions.expand(self.members, *actions.shape)
        states = [begin]
        for step in range(actions.shape[1]):
            states.append(self(states[-1], shared[:, :, step]))
        return torch.stack(states, dim=2)
