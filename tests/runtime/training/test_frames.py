"""Features of pictures are kept on disk, and made again where what is kept cannot be trusted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from runtime.training.frames import encoded


@dataclass(frozen=True)
class Source:
    """What the states are."""

    name: str = "states"


class Counting:
    """An encoder that counts the pictures that it reads."""

    shape, identity = (2,), "counting"

    def __init__(self) -> None:
        self.read = 0

    def encode(self, pictures: np.ndarray) -> np.ndarray:
        self.read += len(pictures)
        return pictures[:, :2].astype(np.float32)


STATES = np.arange(3000.0).reshape(1000, 3)


def features(kept: Path, source: Source = Source()) -> tuple[np.ndarray, int]:
    encoder = Counting()
    found = np.array(encoded(STATES, lambda rows: rows, encoder, kept, source, lambda _text: None))
    return found, encoder.read


def test_features_are_read_where_they_lie_and_made_for_other_states(tmp_path):
    kept = tmp_path / "features.npy"
    first, made = features(kept)
    assert (made, first.tolist()) == (1000, STATES[:, :2].tolist())
    again, read = features(kept)
    assert (read, again.tolist()) == (0, first.tolist())
    assert features(kept, Source("others"))[1] == 1000


@pytest.mark.parametrize("note", ["", "{", "[]", '{"done": 1000}', "null"])
def test_a_damaged_note_has_them_made_again(tmp_path, note):
    kept = tmp_path / "features.npy"
    first, _ = features(kept)
    kept.with_suffix(".json").write_text(note)
    again, made = features(kept)
    assert (made, again.tolist()) == (1000, first.tolist())


@pytest.mark.parametrize("size", [0, 50, 1000])
def test_a_file_that_was_cut_off_is_made_again(tmp_path, size):
    kept = tmp_path / "features.npy"
    first, _ = features(kept)
    kept.write_bytes(kept.read_bytes()[:size])
    again, made = features(kept)
    assert (made, again.tolist()) == (1000, first.tolist())
