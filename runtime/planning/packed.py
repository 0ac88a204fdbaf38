"""Networks with weights in oneDNN's layout: the same function, faster where MKL is slow.

Torch uses MKL for 32-bit matrix products, which on other makers' processors uses half of the vector width; and it
evaluates a network layer by layer, all ensemble members at once, so that activations leave the cache. Here each member
goes through all of its layers before the next one does. A search evaluates one frozen network hundreds of times
without gradients, so that packing pays off at once. The original layers are used when a gradient is needed, and where
torch or the device lacks the operator.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import torch
from torch import nn
from torch.nn import functional

from grounding.world_model.layers import EnsembleLinear

__all__ = ["pack"]

_ROWS = 300
"""Rows at once that the packing is chosen for; any number may be given."""
_LEAST = 64 * 64
"""Weights of a layer from which on packing pays."""
_CLOSE = 1e-4
_Network = TypeVar("_Network", bound=nn.Module)
_Layer = Callable[[torch.Tensor], torch.Tensor]


def pack(network: _Network) -> _Network:
    """Pack the networks of a frozen ``network`` that hold a large layer in place, and return it."""
    for parent in list(network.modules()):
        for name, child in list(parent.named_children()):
            if isinstance(child, nn.Sequential) and _pays(child):
                setattr(parent, name, _packed(child))
    return network


class _Packed(nn.Module):
    """``chain``, linear layers with :class:`torch.nn.SiLU` between them, and packed copies of their weights."""

    def __init__(self, chain: nn.Sequential, operators: Any) -> None:  # noqa: ANN401 - torch's own type
        super().__init__()
        self.chain = chain
        layers = [_members(each) for each in _linear(chain)]
        self._alone = isinstance(chain[0], nn.Linear)
        self._members = [
            [_layer(operators, *each[member], last=each is layers[-1]) for each in layers]
            for member in range(len(layers[0]))
        ]

    def forward(self, rows: torch.Tensor) -> torch.Tensor:
        """As ``chain``."""
        if torch.is_grad_enabled():
            found: torch.Tensor = self.chain(rows)
            return found
        given = [rows] if self._alone else rows
        ends = [_through(member, each.contiguous()) for member, each in zip(self._members, given, strict=True)]
        return ends[0] if self._alone else torch.stack(ends)


def _through(layers: list[_Layer], rows: torch.Tensor) -> torch.Tensor:
    for layer in layers:
        rows = layer(rows)
    return rows


def _layer(operators: Any, weight: torch.Tensor, bias: torch.Tensor, *, last: bool) -> _Layer:  # noqa: ANN401
    """One layer of one member, the SiLU after it included: ``weight`` (O, I) and ``bias`` (O,)."""
    if weight.numel() < _LEAST:

        def plain(rows: torch.Tensor) -> torch.Tensor:
            found = functional.linear(rows, weight, bias)
            return found if last else functional.silu(found)

        return plain
    packed = operators._reorder_linear_weight(weight, _ROWS)  # noqa: SLF001 - it has no other name
    after = "none" if last else "swish"

    def fused(rows: torch.Tensor) -> torch.Tensor:
        found: torch.Tensor = operators._linear_pointwise(rows, packed, bias, after, [], "")  # noqa: SLF001 - as above
        return found

    return fused


def _members(layer: nn.Linear | EnsembleLinear) -> list[tuple[torch.Tensor, torch.Tensor]]:
    """Of each member, weight (O, I) and bias (O,)."""
    weight, bias = layer.weight.detach(), layer.bias.detach()
    if isinstance(layer, nn.Linear):
        return [(weight, bias)]
    return [(each.T.contiguous(), off.flatten()) for each, off in zip(weight, bias, strict=True)]


def _linear(chain: nn.Sequential) -> list[nn.Linear | EnsembleLinear]:
    return [each for each in chain if isinstance(each, nn.Linear | EnsembleLinear)]


def _pays(chain: nn.Sequential) -> bool:
    """Whether ``chain`` lies on the CPU, is made as :mod:`grounding.world_model.layers` does, and has a large layer."""
    layers = _linear(chain)
    between = [each for place, each in enumerate(chain) if place % 2]
    made = layers == list(chain[::2]) and all(isinstance(each, nn.SiLU) for each in between)
    return (
        made
        and all(each.bias is not None and each.weight.device.type == "cpu" for each in layers)
        and any(each.weight.shape[-1] * each.weight.shape[-2] >= _LEAST for each in layers)
    )


def _packed(chain: nn.Sequential) -> nn.Module:
    """``chain`` packed, or itself where that is not possible or does not give the same."""
    first = _linear(chain)[0]
    try:
        packed = _Packed(chain, torch.ops.mkldnn)
        alone = isinstance(first, nn.Linear)
        members, inputs = (1, first.in_features) if isinstance(first, nn.Linear) else first.weight.shape[:2]
        rows = torch.linspace(-1, 1, 3 * inputs).unflatten(0, (3, inputs))
        rows = rows if alone else rows.expand(members, 3, inputs)
        with torch.no_grad():
            same = torch.allclose(packed(rows), chain(rows), rtol=_CLOSE, atol=_CLOSE)
    except (AttributeError, RuntimeError):  # a torch that was built without it
        return chain
    return packed if same else chain
