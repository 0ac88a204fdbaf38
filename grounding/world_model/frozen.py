"""An encoder that is a torch network: pictures go through in small batches, features come back as numpy arrays."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch

from grounding.world_model.checkpoint import checksum
from grounding.world_model.device import device_named
from grounding.world_model.encoder import Features, Pictures, checked
from onto_compiler.problems import OntoError, clipped

__all__ = ["FrozenNetwork", "parse_options"]

_MORE = 32  # batches of a CPU in one of a GPU


@dataclass(frozen=True, eq=False)
class FrozenNetwork:
    """An :class:`~grounding.world_model.encoder.Encoder` around ``network``.

    ``network`` maps float32 (B, 3, S, S) with values from 0 to 255 to (B, D). ``batch`` is how many pictures it is
    given at once on a CPU, where a batch whose activations fit the cache is several times as fast as a large one; a GPU
    is given many times as many.

    Raises:
        OntoError: ``WM012``, where torch has no such ``device``.
    """

    name: str
    size: int
    shape: tuple[int, ...]
    network: torch.nn.Module
    device: str
    batch: int

    def __post_init__(self) -> None:
        object.__setattr__(self, "device", device_named(self.device))
        self.network.eval().requires_grad_(requires_grad=False).to(self.device, memory_format=torch.channels_last)

    @property
    def identity(self) -> str:
        """A SHA-256 over the name and the weights in use."""
        return hashlib.sha256(f"{self.name} {checksum(self.network.state_dict())}".encode()).hexdigest()

    def encode(self, pictures: Pictures) -> Features:
        """Features (N, D) of ``pictures`` (N, S, S, 3); raises ``WM009`` if they have another form."""
        given = torch.from_numpy(np.ascontiguousarray(checked(pictures, self.size, self.name)))
        features = np.empty((len(given), int(np.prod(self.shape))), dtype=np.float32)
        step = self.batch if self.device == "cpu" else self.batch * _MORE
        # TF32 would round to ten bits, and other algorithms of cuDNN give other digits each time.
        exact = torch.backends.cudnn.flags(enabled=True, benchmark=False, deterministic=True, allow_tf32=False)
        with torch.inference_mode(), exact:
            for start in range(0, len(given), step):
                part = given[start : start + step].to(self.device).permute(0, 3, 1, 2)
                found = self.network(part.to(torch.float32, memory_format=torch.channels_last))
                features[start : start + step] = found.cpu().numpy()
        return features


def parse_options(
    family: str, options: Sequence[str], kinds: Sequence[str], sizes: range
) -> tuple[str | None, int | None]:
    """The kind of features (one of ``kinds``) and the size of pictures among ``options``, None where not given.

    Raises:
        OntoError: ``WM007`` if an option is neither of ``kinds`` nor a size of ``sizes``.
    """
    kind: str | None = None
    size: int | None = None
    for option in options:
        if option in kinds and kind is None:
            kind = option
        elif option.isascii() and option.isdigit() and len(option) < 5 and int(option) in sizes and size is None:
            size = int(option)
        else:
            message = f"`{clipped(option)}` is not an option of the encoder `{family}`"
            many = f"{sizes.start}, {sizes.start + sizes.step}, … {sizes[-1]} pixels"
            hint = f"`{family}[:KIND][:SIZE]` has the kinds {', '.join(kinds)}, at {many}"
            raise OntoError.of("WM007", message, hint)
    return kind, size
