"""The films of a suite's demonstrations on disk: each demonstration in full, and once with altered actions.

A film is one file, written atomically, so that an interrupted run can be resumed. Films of other facts or other
demonstrations are in other folders.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from onto_compiler.atomic import replacing
from onto_compiler.knowledge import load_knowledge
from onto_compiler.pool import map_over_processes
from onto_compiler.problems import OntoError
from onto_compiler.versions import version_of
from runtime.loop.faults import RunFault
from runtime.worlds.libero.demos.collect import CollectionRequest, collect_task
from runtime.worlds.libero.demos.read import load
from runtime.worlds.libero.demos.records import Demonstration
from runtime.worlds.libero.simulator.actions import DUMMY_ACTION
from runtime.worlds.libero.simulator.assets import TaskRef, tasks
from runtime.worlds.libero.training.altered import altered
from runtime.worlds.libero.training.film import Film, Filmer
from runtime.worlds.libero.training.scene import SUITE, scene_facts

__all__ = ["TEST_SEED", "FilmRequest", "Filmed", "filmed", "read_film", "split_of"]

FORMAT = 1  # of what is kept
REST = 15
"""Control steps at rest after a demonstration, in which the goal must still hold."""
TEST_SEED = 1
"""The seed of trials whose demonstrations are for tests; training uses another."""
_TESTED, _HELD = 10, 16
_PACKAGES = ("mujoco", "robosuite")
_CALM, _ALTERED = "demonstration", "altered"


@dataclass(frozen=True, slots=True)
class Filmed:
    """One film: of which ``task`` (its index), trial and official initial ``state``; ``kind`` says what was played."""

    task: int
    trial: int
    state: int
    kind: str
    path: Path

    @property
    def calm(self) -> bool:
        """Whether it is the demonstration itself, without altered actions."""
        return self.kind == _CALM

    @property
    def split(self) -> str:
        """The split, determined by the initial state: no two splits share one."""
        return split_of(self.state)


@dataclass(frozen=True, slots=True)
class FilmRequest:
    """What is filmed: of ``count`` demonstrations a task, of trials of ``seed``, those in ``splits``; below ``folder``.

    ``exact`` is as of :class:`~runtime.worlds.libero.training.film.Filmer`; ``demos`` is a folder of demonstrations
    that exist already, in the layout of ``onto demos collect``.
    """

    folder: Path
    count: int = 50
    seed: int = 0
    indices: tuple[int, ...] = ()
    splits: tuple[str, ...] = ("train", "held")
    exact: bool = False
    demos: Path | None = None


def split_of(state: int) -> str:
    """Of a task's official initial states the first ten are for tests, and the next six are held out of the training.

    The rest is ``train``. The held-out split is for the temperatures of scores and the metrics on the cards.
    """
    return "test" if state < _TESTED else "held" if state < _HELD else "train"


def filmed(shoot: FilmRequest, jobs: int, log: Callable[[str], None]) -> tuple[Filmed, ...]:
    """Make the missing films of ``shoot`` in ``jobs`` processes, and list all films.

    Raises:
        OntoError: ``SIM031`` if this machine cannot draw; ``WM016`` if a task has no demonstration with a whole
            start; ``DEM`` problems of the demonstrations; ``WM006`` if ``folder`` cannot be written.
    """
    refs = [ref for ref in tasks(SUITE) if not shoot.indices or ref.index in shoot.indices]
    found: dict[int, tuple[Filmed, ...]] = {}
    for ref, films in map_over_processes(partial(_of_task, shoot), refs, jobs):
        if isinstance(films, OntoError):
            raise films
        found[ref.index], made = films
        if made:
            log(f"{ref.name}: {made} films")
    return tuple(film for ref in refs for film in found[ref.index])


def _of_task(shoot: FilmRequest, ref: TaskRef) -> tuple[tuple[Filmed, ...], int] | OntoError:
    try:
        return _films(shoot, ref)
    except OntoError as error:
        return error


def _films(shoot: FilmRequest, ref: TaskRef) -> tuple[tuple[Filmed, ...], int]:
    """The films of one task, and how many of them were made now."""
    where = _demonstrations(shoot, ref)
    file = load(where)
    whole = [demo for demo in file.demos if demo.start is not None and demo.origin is not None][: shoot.count]
    if not whole:
        message = f"no demonstration of `{ref.name}` says with which state it starts"
        raise OntoError.of("WM016", message, "collect some: `onto demos collect libero_goal`", str(where))
    wanted = [demo for demo in whole if demo.origin and split_of(demo.origin.state_index) in shoot.splits]
    knowledge = load_knowledge()
    asked = scene_facts(knowledge)
    about = [
        FORMAT,
        shoot.exact,
        asked.names,
        dict(file.about).get("spec", {}),
        [version_of(name) for name in _PACKAGES],
    ]
    key = hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()[:12]
    folder = shoot.folder / f"films.{key}" / ref.name
    filmer: Filmer | None = None
    found, made = [], 0
    try:
        for demo in wanted:
            for kind in (_CALM, _ALTERED):
                one = _named(folder, ref, demo, kind)
                if not _whole(one.path):
                    filmer = filmer or Filmer(ref, asked, knowledge, exact=shoot.exact)
                    if (film := _play(filmer, ref, demo, kind)) is None:
                        continue
                    _write(one.path, film)
                    made += 1
                found.append(one)
    finally:
        if filmer is not None:
            filmer.close()
    return tuple(found), made


def _demonstrations(shoot: FilmRequest, ref: TaskRef) -> Path:
    if shoot.demos is not None:
        return shoot.demos / ref.suite / f"{ref.name}_demo.hdf5"
    return Path(collect_task(CollectionRequest(ref, shoot.count, shoot.seed, shoot.folder / "demos"), wait=True).path)


def _named(folder: Path, ref: TaskRef, demo: Demonstration, kind: str) -> Filmed:
    origin = demo.origin
    if origin is None:  # those without were left out
        raise AssertionError
    name = f"{origin.seed}-{origin.trial:04d}-{kind}.npz"
    return Filmed(ref.index, origin.trial, origin.state_index, kind, folder / name)


def _play(filmer: Filmer, ref: TaskRef, demo: Demonstration, kind: str) -> Film | None:
    """The film, or None if the state diverges."""
    origin, start = demo.origin, demo.start
    if origin is None or start is None:
        raise AssertionError
    actions = np.asarray(demo.actions, dtype=np.float64)
    first = 0
    if kind == _CALM:
        played = np.concatenate([actions, np.tile(DUMMY_ACTION, (REST, 1))])
    else:
        first, _, future = altered(actions, np.random.default_rng([origin.seed, ref.index, origin.trial]))
        played = np.concatenate([actions[:first], future])
    try:
        return filmer.film(start, played, first)
    except RunFault:
        return None


def read_film(path: Path, *, pictures: bool = True) -> Film:
    """The film at ``path``; without ``pictures`` an empty array stands for them.

    Raises:
        OntoError: ``WM017`` if it is damaged.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            wanted = [field.name for field in fields(Film) if pictures or field.name != "pictures"]
            arrays: Mapping[str, NDArray[Any]] = {name: archive[name] for name in wanted}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise OntoError.of(
            "WM017", f"the film cannot be read: {error}", "remove it; it is made again", str(path)
        ) from error
    return Film(**{"pictures": np.empty((0, 0, 0, 3), np.uint8), **arrays})


def _whole(path: Path) -> bool:
    """Whether there is a film at ``path``, as far as its directory says."""
    return path.is_file() and zipfile.is_zipfile(path)


def _write(path: Path, film: Film) -> None:
    try:
        with replacing(path) as place:
            np.savez_compressed(place, **{field.name: getattr(film, field.name) for field in fields(Film)})
    except OSError as error:
        raise OntoError.of("WM006", f"the film cannot be written: {error.strerror}", "", str(path)) from error
