"""Films of a world without a simulator: a hand that carries a bright thing, which is on its plate at the right side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from runtime.worlds.libero.training.film import PIXELS, Film
from runtime.worlds.libero.training.hand import SIZE
from runtime.worlds.libero.training.library import Filmed, _write

STEPS = 40
MARKS = STEPS // 5 + 1


def made(rng: np.random.Generator, facts: int) -> Film:
    """A hand that moves along x by what it is told; fact 0 holds where x is above a half, the others never do."""
    push = rng.uniform(-1.0, 1.0)
    actions = np.zeros((STEPS, 7), dtype=np.float32)
    actions[:, 0] = np.clip(push + 0.2 * rng.standard_normal(STEPS), -1, 1)
    x = 0.5 + np.concatenate([[0.0], np.cumsum(actions[:, 0])]) / (2 * STEPS)
    proprio = np.zeros((STEPS + 1, SIZE), dtype=np.float32)
    proprio[:, 0], proprio[1:, -5] = x, np.diff(x) * 20
    at = x[::5]
    pictures = np.zeros((MARKS, PIXELS, PIXELS, 3), dtype=np.uint8)
    for mark, where in enumerate(at):
        column = int(where * (PIXELS - 16))
        pictures[mark, 50:66, column : column + 16] = 250
    margin = np.full((MARKS, facts), -0.3, dtype=np.float32)
    margin[:, 0] = at - 0.5
    return Film(proprio, actions, pictures, margin > 0, margin, at < 0.55)


@pytest.fixture(scope="session")
def films(tmp_path_factory: pytest.TempPathFactory) -> tuple[Filmed, ...]:
    """Two dozen films on disk, of task 0, whose goal is fact 0; a third of them is of other actions."""
    folder: Path = tmp_path_factory.mktemp("films")
    rng = np.random.default_rng(0)
    found = []
    for trial in range(24):
        kind = "altered" if trial % 3 == 2 else "demonstration"
        one = Filmed(0, trial, 4 + trial, kind, folder / "films.0" / "task" / f"0-{trial:04d}-{kind}.npz")
        _write(one.path, made(rng, 2))
        found.append(one)
    return tuple(found)
