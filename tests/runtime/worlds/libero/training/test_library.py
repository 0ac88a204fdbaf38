"""Films on disk: what is there is not made again, and what cannot be made is told."""

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.loop.faults import RunFault
from runtime.worlds.libero.training import library
from runtime.worlds.libero.training.library import FilmRequest, filmed, read_film
from tests.runtime.worlds.libero.training.conftest import made

pytestmark = pytest.mark.sim
SAMPLE = "docs/examples/put_the_bowl_on_the_plate_demo.hdf5"


class Fake:
    """A filmer that makes up its films, and counts them."""

    asked = 0

    def __init__(self, _ref, asked, _knowledge, *, exact):
        self.facts = len(asked.names)

    def film(self, _start, actions, first=0):
        type(self).asked += 1
        self.given = actions, first
        if first:
            raise RunFault("the state diverged", None)
        return made(np.random.default_rng(1), self.facts)

    def close(self):
        pass


@pytest.fixture
def shoot(tmp_path, monkeypatch):
    from pathlib import Path

    from runtime.worlds.libero.simulator.assets import find_task

    task = find_task("libero_goal", 8)
    file = tmp_path / "demos" / "libero_goal" / f"{task.name}_demo.hdf5"
    file.parent.mkdir(parents=True)
    file.write_bytes((Path(__file__).resolve().parents[5] / SAMPLE).read_bytes())
    monkeypatch.setattr(library, "Filmer", Fake)
    monkeypatch.setattr(Fake, "asked", 0)
    return FilmRequest(tmp_path / "data", 2, indices=(8,), splits=("train", "held", "test"), demos=tmp_path / "demos")


def test_each_demonstration_is_filmed_once_and_an_episode_that_diverges_is_left_out(shoot):
    said = []
    found = filmed(shoot, 1, said.append)
    assert said == ["put_the_bowl_on_the_plate: 2 films"]
    assert Fake.asked == 4
    assert {one.calm for one in found} == {True}
    assert [(one.task, one.kind) for one in found] == [(8, "demonstration")] * 2
    again = filmed(shoot, 1, said.append)
    assert again == found
    assert len(said) == 1
    assert Fake.asked == 6  # only those that diverged are tried again
    found[0].path.write_bytes(b"")
    assert len(filmed(shoot, 1, lambda _text: None)) == 2
    assert read_film(found[0].path).truth.shape[1] == 21


def test_only_what_belongs_to_the_splits_is_filmed(shoot):
    from dataclasses import replace

    by_split = {split: filmed(replace(shoot, splits=(split,)), 1, lambda _text: None) for split in shoot.splits}
    every = filmed(shoot, 1, lambda _text: None)
    assert sum(map(len, by_split.values())) == len(every) == 2
    assert all(one.split == split for split, films in by_split.items() for one in films)


def test_a_file_without_whole_starts_is_told(shoot, monkeypatch):
    from dataclasses import replace

    def bare(path):
        file = library_load(path)
        return replace(file, demos=tuple(replace(demo, start=None) for demo in file.demos))

    library_load = library.load
    monkeypatch.setattr(library, "load", bare)
    with pytest.raises(OntoError) as caught:
        filmed(shoot, 1, lambda _text: None)
    assert caught.value.problems[0].code == "WM016"


def test_a_missing_file_is_told(shoot, tmp_path):
    with pytest.raises(OntoError) as caught:
        filmed(FilmRequest(tmp_path, 2, indices=(8,), demos=tmp_path), 1, lambda _text: None)
    assert caught.value.problems[0].code == "DEM001"
