"""Training data of the networks: trajectories, and the features of the picture at each macro step."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.world_model.encoder import Encoder, Features, Pictures

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = ["HORIZON", "Frames", "Piece", "encoded", "generator_of", "segments"]

HORIZON = 5
"""Macro steps of a training segment, as many as a plan has."""

_CHUNK = 512

Indices = NDArray[np.int64]
Row = TypeVar("Row", np.float64, np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """``states`` (B, H + 1, P) and ``features`` (B, H + 1, D) at macro steps, ``actions`` (B, H, macro, A) between."""

    states: torch.Tensor
    features: torch.Tensor
    actions: torch.Tensor


@dataclass(frozen=True, slots=True, eq=False)
class Frames:
    """``states`` (N, T + 1, P), ``actions`` (N, T, A) by environment steps; ``features`` (N, K + 1, D) by macro.

    They are in main memory; batches drawn from them are on ``device``.
    """

    states: NDArray[np.float32]
    actions: NDArray[np.float32]
    features: Features
    device: str = "cpu"

    @property
    def macro(self) -> int:
        """Environment steps of a macro step."""
        return int(self.actions.shape[1] // (self.features.shape[1] - 1))

    @property
    def marks(self) -> NDArray[np.float32]:
        """States (N, K + 1, P) at the macro steps."""
        return self.states[:, :: self.macro]

    def piece(self, which: Indices, mark: Indices, horizon: int = HORIZON) -> Piece:
        """``horizon`` macro steps of the trajectories ``which`` (B,), each from macro step ``mark`` (B,)."""
        row, marks = which[:, None], mark[:, None] + np.arange(horizon + 1)
        steps = mark[:, None] * self.macro + np.arange(horizon * self.macro)
        return Piece(
            self.tensor(self.marks[row, marks]),
            self.tensor(np.asarray(self.features[row, marks])),
            self.tensor(self.actions[row, steps]).unflatten(1, (horizon, self.macro)),
        )

    def tensor(self, values: NDArray[Any]) -> torch.Tensor:
        """``values`` on :attr:`device`."""
        return torch.from_numpy(values).to(self.device)

    def past(self, which: Indices, mark: Indices, length: int, age: Indices) -> tuple[torch.Tensor, torch.Tensor]:
        """Proprioception (B, K, P) and actions (B, K - 1, macro, A) of the ``length`` K macro steps up to ``mark``.

        As :class:`~grounding.world_model.dynamics.History` has them: NaN for what an episode of ``age`` (B,) macro
        steps, at least one, has no memory of.
        """
        marks = np.maximum(mark[:, None] + np.arange(1 - length, 1), 0)
        missing = torch.from_numpy(np.arange(length)[None] < length - age[:, None])
        proprio = torch.from_numpy(self.marks[which[:, None], marks])
        proprio[missing] = torch.nan
        steps = marks[:, :-1, None] * self.macro + np.arange(self.macro)
        actions = torch.from_numpy(self.actions[which[:, None, None], steps])
        actions[missing[:, :-1]] = torch.nan
        return proprio.to(self.device), actions.to(self.device)


def generator_of(random: torch.Generator) -> np.random.Generator:
    """A numpy generator seeded from ``random``."""
    return np.random.default_rng(int(torch.randint(2**62, (), generator=random)))


def encoded(
    states: NDArray[Row],
    draw: Callable[[NDArray[Row]], Pictures],
    encoder: Encoder,
    path: Path,
    source: DataclassInstance,
    log: Callable[[str], None],
) -> Features:
    """Features (N, D) of the pictures that ``draw`` makes of ``states`` (N, P), read from ``path`` if they are there.

    ``source``, a dataclass with JSON values, identifies the states: features of other states are computed again.
    ``path`` is a memory map that is filled in pieces; a JSON file beside it records the progress, from which an
    interrupted run resumes.
    """
    width = int(np.prod(encoder.shape))
    key = hashlib.sha256(json.dumps([asdict(source), len(states), encoder.identity]).encode()).hexdigest()
    note = path.with_suffix(".json")
    path.parent.mkdir(parents=True, exist_ok=True)
    shape, done = (len(states), width), _done(note, key)
    held = _opened(path, shape) if done else None
    if held is None:
        held, done = np.lib.format.open_memmap(path, mode="w+", dtype=np.float32, shape=shape), 0
    while done < len(states):
        rows = slice(done, min(done + _CHUNK, len(states)))
        held[rows] = encoder.encode(draw(states[rows]))
        done = rows.stop
        if done % (_CHUNK * 8) == 0 or done == len(states):
            held.flush()
            note.write_text(json.dumps({"key": key, "done": done}))
            log(f"{done:,} of {len(states):,} pictures")
    return held


def _done(note: Path, key: str) -> int:
    """How many features of ``key`` are done; 0 if ``note`` is of others or is incomplete."""
    try:
        about = json.loads(note.read_text())
        return int(about["done"]) if about["key"] == key else 0
    except (OSError, ValueError, KeyError, TypeError):
        return 0


def _opened(path: Path, shape: tuple[int, int]) -> np.memmap[Any, np.dtype[Any]] | None:
    """The array in ``path``; None if it is incomplete or of another shape."""
    try:
        size = path.stat().st_size  # opened for writing, a truncated file would grow to its full length
        held = np.lib.format.open_memmap(path, mode="r+")
    except (OSError, ValueError):
        return None
    return held if held.shape == shape and size == held.offset + held.nbytes else None


def segments(frames: Frames, random: np.random.Generator, count: int, horizon: int) -> tuple[Indices, Indices]:
    """``count`` random segments of ``horizon`` macro steps: the trajectory and the first macro step of each."""
    trajectories, marks = frames.features.shape[:2]
    return random.integers(trajectories, size=count), random.integers(marks - horizon, size=count)
