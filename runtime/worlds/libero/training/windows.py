"""Films cut into windows of 25 control steps, one from every mark: the equal lengths that the losses need."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grounding.world_model.encoder import Encoder, Pictures, checked_features
from runtime.training.frames import HORIZON, Frames, encoded
from runtime.worlds.libero.training.film import MACRO, Film
from runtime.worlds.libero.training.library import Filmed, read_film
from runtime.worlds.libero.training.scene import SceneFacts

__all__ = ["Windows", "pictures_of", "windows"]

_SECONDS = MACRO / 20  # between two marks


@dataclass(frozen=True, slots=True, eq=False)
class Windows:
    """W windows of H + 1 marks.

    ``frames`` has a window for a trajectory. ``truth`` and ``margin`` (W, H + 1, F), ``clear`` (W, H + 1) as of
    :class:`~runtime.worlds.libero.training.film.Film`; ``remaining`` (W, H + 1): seconds until the goal of the film's
    own task holds for good, infinite if it never does. ``film`` (W,) is a place in ``films``.
    """

    frames: Frames
    truth: NDArray[np.bool_]
    margin: NDArray[np.float32]
    clear: NDArray[np.bool_]
    remaining: NDArray[np.float32]
    film: NDArray[np.int64]
    films: tuple[Filmed, ...]

    @property
    def task(self) -> NDArray[np.int64]:
        """The index of each window's task (W,)."""
        return np.array([one.task for one in self.films], dtype=np.int64)[self.film]

    @property
    def calm(self) -> NDArray[np.bool_]:
        """Which windows (W,) are of demonstrations, and not of altered actions."""
        return np.array([one.calm for one in self.films], dtype=np.bool_)[self.film]

    def __len__(self) -> int:
        return len(self.film)


@dataclass(frozen=True, slots=True)
class _Picked:
    """The cache key of features: the films by their folder and name, in order."""

    names: tuple[str, ...]


def pictures_of(films: Sequence[Filmed]) -> tuple[NDArray[np.int64], Callable[[NDArray[np.int64]], Pictures]]:
    """The pictures of ``films`` as rows (film, mark), and a function that reads those of such rows.

    It caches the last film, as rows come film by film.
    """
    counts = [len(read_film(one.path, pictures=False).clear) for one in films]
    rows = np.array([(film, mark) for film, count in enumerate(counts) for mark in range(count)], dtype=np.int64)
    held: dict[int, Pictures] = {}

    def draw(wanted: NDArray[np.int64]) -> Pictures:
        parts = []
        for film, mark in wanted:
            if int(film) not in held:
                held.clear()
                held[int(film)] = read_film(films[film].path).pictures
            parts.append(held[int(film)][mark])
        return np.stack(parts)

    return rows, draw


def windows(
    films: Sequence[Filmed],
    asked: SceneFacts,
    seen: Encoder,
    path: Path,
    log: Callable[[str], None],
    device: str = "cpu",
) -> Windows:
    """All windows of ``films``, with the features that ``seen`` has of their marks, cached in the file ``path``.

    Batches drawn from them are on ``device``.

    Raises:
        OntoError: ``WM009`` where films have another size than ``seen`` reads, ``WM010`` if a feature is not finite,
            ``WM017`` if a film is damaged.
    """
    rows, draw = pictures_of(films)
    source = _Picked(tuple(f"{one.path.parent.parent.name}/{one.path.name}" for one in films))
    features = np.asarray(encoded(rows, draw, seen, path, source, log))
    checked_features(features, features.shape[1])
    cut: list[list[NDArray[Any]]] = [[] for _ in range(8)]
    begin = 0
    for number, one in enumerate(films):
        film = read_film(one.path, pictures=False)
        marks = len(film.clear)
        looks, begin = features[begin : begin + marks], begin + marks
        left = _remaining(film, list(asked.goals[one.task]), calm=one.calm)
        for mark in range(marks - HORIZON):
            steps, inside = mark * MACRO, slice(mark, mark + HORIZON + 1)
            parts: tuple[NDArray[Any], ...] = (
                film.proprio[steps : steps + HORIZON * MACRO + 1], film.actions[steps : steps + HORIZON * MACRO],
                looks[inside], film.truth[inside], film.margin[inside], film.clear[inside], left[inside],
                np.array(number),
            )  # fmt: skip
            for column, part in zip(cut, parts, strict=True):
                column.append(part)
    states, actions, looked, truth, margin, clear, remaining, place = (np.stack(column) for column in cut)
    return Windows(Frames(states, actions, looked, device), truth, margin, clear, remaining, place, tuple(films))


def _remaining(film: Film, goal: list[int], *, calm: bool) -> NDArray[np.float32]:
    """Seconds (K + 1,) from each mark until all facts of ``goal`` hold to the end of ``film``; see :class:`Windows`."""
    holds = np.asarray(film.truth[:, goal].all(axis=1))
    lasting = np.logical_and.accumulate(holds[::-1])[::-1]
    found = np.where(lasting, 0.0, np.inf).astype(np.float32)
    if calm and lasting.any():
        first = int(lasting.argmax())
        found[:first] = (first - np.arange(first)) * _SECONDS
    return found
