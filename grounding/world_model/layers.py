"""Layers that the networks of a world model are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import nn

__all__ = ["EnsembleLinear", "ensemble_mlp", "mlp"]


class EnsembleLinear(nn.Module):
    """``members`` linear layers side by side: (M, B, I) to (M, B, O), each member its own weights."""

    def __init__(self, members: int, inputs: int, outputs: int) -> None:
        super().__init__()
        bound = 1 / math.sqrt(inputs)
        self.weight = nn.Parameter(torch.empty(members, inputs, outputs).uniform_(-bound, bound))
        self.bias = nn.Parameter(torch.empty(members, 1, outputs).uniform_(-bound, bound))

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """``rows`` (M, B, I) to (M, B, O)."""
        return torch.baddbmm(self.bias, rows, self.weight)


def ensemble_mlp(members: int, widths: Sequence[int]) -> nn.Sequential:
    """SiLU networks side by side, (M, B, widths[0]) to (M, B, widths[-1]); the last layer begins at zero."""
    layers: list[nn.Module] = []
    for inputs, outputs in pairwise(widths):
        layers += [EnsembleLinear(members, inputs, outputs), nn.SiLU()]
    last = layers[-2]
    nn.init.zeros_(last.weight)
    nn.init.zeros_(last.bias)
    return nn.Sequential(*layers[:-1])


def mlp(widths: Sequence[int], *, zero: bool = False) -> nn.Sequential:
    """A SiLU network (..., widths[0]) to (..., widths[-1]); ``zero`` lets its last layer begin at zero."""
    layers: list[nn.Module] = []
    for inputs, outputs in pairwise(widths):
        layers += [nn.Linear(inputs, outputs), nn.SiLU()]
    if zero:
        nn.init.zeros_(layers[-2].weight)
        nn.init.zeros_(layers[-2].bias)
    return nn.Sequential(*layers[:-1])
