"""The picture itself, averaged over tiles: the baseline that a learned encoder has to beat."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from grounding.world_model.encoder import Features, Pictures, checked
from onto_compiler.problems import OntoError, clipped

__all__ = ["Pixels", "pixels"]


@dataclass(frozen=True, slots=True)
class Pixels:
    """Means over ``grid`` by ``grid`` tiles of a picture of ``size`` pixels, per colour, from 0 to 1."""

    size: int = 64
    grid: int = 16

    @property
    def name(self) -> str:
        """``pixels:GRID:SIZE``."""
        return f"pixels:{self.grid}:{self.size}"

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, colours."""
        return (self.grid, self.grid, 3)

    @property
    def identity(self) -> str:
        """A digest of the name: there are no weights."""
        return hashlib.sha256(self.name.encode()).hexdigest()

    def encode(self, pictures: Pictures) -> Features:
        """Features (N, grid * grid * 3) of ``pictures`` (N, S, S, 3); raises ``WM009`` for another form."""
        side = self.size // self.grid
        tiles = checked(pictures, self.size, self.name).reshape(len(pictures), self.grid, side, self.grid, side, 3)
        # Whole numbers below 2**24 are exact in float32, so that the sum does not depend on its order.
        means: Features = tiles.sum(axis=(2, 4), dtype=np.float32) / np.float32(255 * side * side)
        return means.reshape(len(pictures), self.grid * self.grid * 3)


def pixels(options: Sequence[str] = (), device: str = "cpu") -> Pixels:  # noqa: ARG001 - numpy has one device
    """The encoder ``pixels[:GRID[:SIZE]]``; raises ``WM007`` where GRID does not divide SIZE."""
    numbers = [int(option) for option in options if option.isascii() and option.isdigit() and len(option) < 5]
    grid, size, *more = [*numbers, *(16, 64)[len(numbers) :]]
    if len(numbers) != len(options) or more or not 0 < grid <= size or size % grid:
        message = f"`{clipped(':'.join(('pixels', *options)))}` is not an encoder"
        raise OntoError.of("WM007", message, "`pixels:GRID:SIZE`: two numbers, of which the first divides the second")
    return Pixels(size, grid)
