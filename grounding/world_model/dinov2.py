"""DINOv2's ViT-S/14, into which the published weights load as they are.

The names below are those of the published state dict. The weights (88 MB) are not packaged: they are looked for where
``ONTO_EVWM_DINOV2`` points (the file, or its folder), then in the folder ``weights`` of the user's cache. Source:
``dinov2/models/vision_transformer.py`` and ``dinov2/hub/backbones.py`` of ``facebookresearch/dinov2``. Pictures are
normalised as in its training, with ImageNet's mean and deviation (DINO-WM uses 0.5 for both).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import nn
from torch.nn import functional

from grounding.world_model.checkpoint import fill
from grounding.world_model.frozen import FrozenNetwork, parse_options
from grounding.world_model.weights import read_weights
from onto_compiler.cache import cache_folder
from onto_compiler.problems import OntoError

__all__ = ["PLACE", "VisionTransformer", "dinov2"]

PLACE = "ONTO_EVWM_DINOV2"

_FILES = ("dinov2_vits14_pretrain.safetensors", "dinov2_vits14_pretrain.pth")
_URL = "https://dl.fbaipublicfiles.com/dinov2/dinov2_vits14/dinov2_vits14_pretrain.pth"
_PATCH = 14  # pixels
_GRID = 37  # patches along a side of the pictures of its training
_OFFSET = 0.1  # added to the number of patches before positions are interpolated, as upstream does against rounding
_SIZE = 196  # DINO-WM's: 14 by 14 patches
_SIZES = range(_PATCH, 519, _PATCH)
_BATCH = 8
_MEAN = (123.675, 116.28, 103.53)
_DEVIATION = (58.395, 57.12, 57.375)


class _Patches(nn.Module):
    """A vector for each patch."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.proj = nn.Conv2d(3, width, _PATCH, _PATCH)

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """Vectors (B, P, width), patches in rows, of pictures (B, 3, S, S)."""
        return self.proj(pictures).flatten(2).transpose(1, 2)


class _Attention(nn.Module):
    """Self-attention over all tokens."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Tokens (B, T, width) to the same."""
        batch, count, width = tokens.shape
        parts = self.qkv(tokens).reshape(batch, count, 3, self.heads, width // self.heads)
        queries, keys, values = parts.permute(2, 0, 3, 1, 4)
        found = functional.scaled_dot_product_attention(queries, keys, values)
        return self.proj(found.transpose(1, 2).reshape(batch, count, width))


class _Mlp(nn.Module):
    """Two layers on each token alone."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.fc1 = nn.Linear(width, 4 * width)
        self.fc2 = nn.Linear(4 * width, width)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Tokens (B, T, width) to the same."""
        return self.fc2(functional.gelu(self.fc1(tokens)))


class _Scale(nn.Module):
    """A factor for each channel."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.gamma = nn.Parameter(torch.ones(width))

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Tokens (B, T, width) to the same."""
        return tokens * self.gamma


class _Block(nn.Module):
    """Attention, then the layers of each token; both normalised before, scaled after, and added."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.norm1 = nn.LayerNorm(width, eps=1e-6)
        self.attn = _Attention(width, heads)
        self.ls1 = _Scale(width)
        self.norm2 = nn.LayerNorm(width, eps=1e-6)
        self.mlp = _Mlp(width)
        self.ls2 = _Scale(width)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        """Tokens (B, T, width) to the same."""
        tokens = tokens + self.ls1(self.attn(self.norm1(tokens)))
        return tokens + self.ls2(self.mlp(self.norm2(tokens)))


class VisionTransformer(nn.Module):
    """ViT-S/14 with the defaults; its features are the class token (``kind`` cls) or the tokens of the patches."""

    def __init__(self, kind: str = "patch", width: int = 384, depth: int = 12, heads: int = 6) -> None:
        super().__init__()
        self.kind = kind
        self.cls_token = nn.Parameter(torch.zeros(1, 1, width))
        self.pos_embed = nn.Parameter(torch.zeros(1, 1 + _GRID * _GRID, width))
        self.mask_token = nn.Parameter(torch.zeros(1, width))  # of the training alone; the published file has it
        self.patch_embed = _Patches(width)
        self.blocks = nn.ModuleList([_Block(width, heads) for _ in range(depth)])
        self.norm = nn.LayerNorm(width, eps=1e-6)
        self.register_buffer("mean", torch.tensor(_MEAN).reshape(3, 1, 1), persistent=False)
        self.register_buffer("deviation", torch.tensor(_DEVIATION).reshape(3, 1, 1), persistent=False)

    def positions(self, side: int) -> torch.Tensor:
        """What is added to the tokens (1, 1 + side * side, width) of ``side`` by ``side`` patches."""
        if side == _GRID:
            return self.pos_embed
        patches = self.pos_embed[:, 1:].reshape(1, _GRID, _GRID, -1).permute(0, 3, 1, 2)
        factor = (side + _OFFSET) / _GRID
        found = functional.interpolate(patches, scale_factor=(factor, factor), mode="bicubic")
        return torch.cat([self.pos_embed[:, :1], found.flatten(2).transpose(1, 2)], dim=1)

    def forward(self, pictures: torch.Tensor) -> torch.Tensor:
        """Features (B, D) of pictures (B, 3, S, S) with values from 0 to 255, S a multiple of 14."""
        patches = self.patch_embed((pictures - self.mean) / self.deviation)
        tokens = torch.cat([self.cls_token.expand(len(patches), -1, -1), patches], dim=1)
        tokens = tokens + self.positions(pictures.shape[-1] // _PATCH)
        for block in self.blocks:
            tokens = block(tokens)
        tokens = self.norm(tokens)
        return tokens[:, 0] if self.kind == "cls" else tokens[:, 1:].flatten(1)


def dinov2(options: Sequence[str] = (), device: str = "cpu") -> FrozenNetwork:
    """The encoder ``dinov2[:patch|:cls][:SIZE]``: normalised last tokens of pictures of SIZE (196) pixels.

    Raises:
        OntoError: ``WM007`` for an unknown option, ``WM008`` if there are no weights or they cannot be read,
            ``WM004`` if they are those of another network.
    """
    kind, size = parse_options("dinov2", options, ("patch", "cls"), _SIZES)
    kind, size = kind or "patch", size or _SIZE
    path = _file()
    network = fill(VisionTransformer(kind), read_weights(path), path)
    side, width = size // _PATCH, network.cls_token.shape[-1]
    shape = (width,) if kind == "cls" else (side, side, width)
    return FrozenNetwork(f"dinov2:{kind}:{size}", size, shape, network, device, _BATCH)


def _file() -> Path:
    """Where the weights are; an environment variable that names none is a mistake, not a reason to look elsewhere."""
    named, cache = os.environ.get(PLACE), cache_folder()
    place = Path(named) if named else None if cache is None else cache / "weights"
    if place is not None and place.is_file():
        return place
    found = [] if place is None else [place / name for name in _FILES if (place / name).is_file()]
    if not found:
        message = f"the weights of `dinov2` ({_FILES[-1]}) are not in {place or 'a cache folder, and there is none'}"
        raise OntoError.of("WM008", message, f"fetch {_URL} and set {PLACE} to the file or its folder")
    return found[0]
