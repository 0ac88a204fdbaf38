"""Networks whose weights lie as oneDNN wants them: the same function, in half the time on processors with AVX-512.

Torch gives products of 32-bit matrices to MKL, which on processors of other makers than its own uses half of their
width. A search asks one frozen network hundreds of times and never for a gradient, so that packing pays at once. Where
a gradient is asked for, and where torch or the device has no such operator, the layers are as they were.
"""

from __future__ import annotations

from typing import Any, TypeVar

import torch
from torch import nn

from grounding.world_model.layers import EnsembleLinear

__all__ = ["pack"]

_ROWS = 300
"""Rows at once that the packing is chosen for; any number may be given."""
_LEAST = 64 * 64
"""Weights of a layer from which on packing pays."""
_CLOSE = 1e-4
_Network = TypeVar("_Network", bound=nn.Module)


def pack(network: _Network) -> _Network:
    """Pack the large linear layers of a frozen ``network`` in place, and return it."""
    for parent in list(network.modules()):
        for name, child in list(parent.named_children()):
            if isinstance(child, nn.Linear | EnsembleLinear) and child.weight.device.type == "cpu":
                setattr(parent, name, _packed(child))
    return network


class _Packed(nn.Module):
    """``layer``, with a packed copy of the weights (O, I) of each of its members."""

    def __init__(self, layer: nn.Linear | EnsembleLinear, operators: Any) -> None:  # noqa: ANN401 - torch's own type
        super().__init__()
        self.layer, self._apply = layer, operators._linear_pointwise  # noqa: SLF001 - it has no other name
        alone = isinstance(layer, nn.Linear)
        self._biases = [layer.bias.detach()] if alone else list(layer.bias.detach().flatten(1))
        weights = [layer.weight.detach()] if alone else [each.T.contiguous() for each in layer.weight.detach()]
        self._weights = [operators._reorder_linear_weight(each, _ROWS) for each in weights]  # noqa: SLF001 - as above

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """As ``layer``."""
        if torch.is_grad_enabled():
            found: torch.Tensor = self.layer(rows)
            return found
        if len(self._weights) == 1:
            return self._one(rows.contiguous(), 0)
        return torch.stack([self._one(each, member) for member, each in enumerate(rows.contiguous())])

    def _one(self, rows: torch.Tensor, member: int) -> torch.Tensor:
        found: torch.Tensor = self._apply(rows, self._weights[member], self._biases[member], "none", [], "")
        return found


def _packed(layer: nn.Linear | EnsembleLinear) -> nn.Module:
    """``layer`` packed, or itself where that does not pay, is not possible or does not give the same."""
    outputs, inputs = layer.weight.shape[-2:]
    if outputs * inputs < _LEAST or layer.bias is None:
        return layer
    try:
        packed = _Packed(layer, torch.ops.mkldnn)
        rows = torch.linspace(-1, 1, 3 * inputs if isinstance(layer, nn.Linear) else 3 * outputs)
        rows = rows.unflatten(0, (3, -1)).expand(*layer.weight.shape[:-2], 3, -1)
        with torch.no_grad():
            same = torch.allclose(packed(rows), layer(rows), rtol=_CLOSE, atol=_CLOSE)
    except (AttributeError, RuntimeError):  # a torch that was built without it
        return layer
    return packed if same else layer
