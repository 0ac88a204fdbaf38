"""What the networks are trained on: trajectories, and the features of the picture at each macro step."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grounding.world_model.encoder import Encoder, Features, Pictures
from runtime.pointmaze.maze import MACRO_STEPS
from runtime.pointmaze.trajectories import Source

__all__ = ["Frames", "encoded", "segments"]

_CHUNK = 512

Draw = Callable[[NDArray[np.float64]], Pictures]


@dataclass(frozen=True, slots=True, eq=False)
class Frames:
    """``states`` (N, T + 1, P), ``actions`` (N, T, A) by environment steps; ``features`` (N, K + 1, D) by macro."""

    states: NDArray[np.float32]
    actions: NDArray[np.float32]
    features: Features

    @property
    def marks(self) -> NDArray[np.float32]:
        """States (N, K + 1, P) at the macro steps."""
        return self.states[:, ::MACRO_STEPS]


def encoded(
    states: NDArray[np.float64], draw: Draw, encoder: Encoder, kept: Path, source: Source, say: Callable[[str], None]
) -> Features:
    """Features (N, D) of the pictures of ``states`` (N, P), read from ``kept`` where they lie there already.

    ``kept`` is a memory map that is filled a piece at a time, with a note of how far it is beside it, so that an
    interrupted run goes on.
    """
    width = int(np.prod(encoder.shape))
    key = hashlib.sha256(json.dumps([asdict(source), len(states), encoder.identity]).encode()).hexdigest()
    note = kept.with_suffix(".json")
    done = 0
    if kept.exists() and note.exists():
        about = json.loads(note.read_text())
        done = int(about["done"]) if about["key"] == key else 0
    kept.parent.mkdir(parents=True, exist_ok=True)
    mode = "r+" if done else "w+"
    held = np.lib.format.open_memmap(kept, mode=mode, dtype=np.float32, shape=(len(states), width))
    while done < len(states):
        rows = slice(done, min(done + _CHUNK, len(states)))
        held[rows] = encoder.encode(draw(states[rows]))
        done = rows.stop
        if done % (_CHUNK * 8) == 0 or done == len(states):
            held.flush()
            note.write_text(json.dumps({"key": key, "done": done}))
            say(f"{done:,} of {len(states):,} pictures")
    return held


def segments(
    frames: Frames, random: np.random.Generator, count: int, horizon: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """``count`` random pieces of ``horizon`` macro steps: which trajectory, and the macro step each begins at."""
    trajectories, marks = frames.features.shape[:2]
    return random.integers(trajectories, size=count), random.integers(marks - horizon, size=count)
