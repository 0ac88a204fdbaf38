"""Films as windows."""

from collections import Counter

import numpy as np
import pytest

from grounding.world_model.encoder import encoder
from onto_compiler.problems import OntoError
from onto_compiler.required import Entity, Fact, NativeAtom
from runtime.worlds.libero.training.library import Filmed, read_film, split_of
from runtime.worlds.libero.training.scene import SceneFacts
from runtime.worlds.libero.training.windows import windows

THING = Entity("thing", "Thing")
FACTS = tuple(Fact(f"x#{name}", (THING,), NativeAtom(name, ("thing",)), name) for name in ("placed", "lost"))
ASKED = SceneFacts(FACTS, {0: (0,)}, {0: (0,)})


def cut(films, tmp_path):
    return windows(films, ASKED, encoder("pixels:8:128"), tmp_path / "features.npy", lambda _text: None)


def test_every_mark_with_25_steps_after_it_begins_a_window(films, tmp_path):
    found = cut(films[:3], tmp_path)
    assert len(found) == 3 * 4
    assert found.frames.states.shape[:2] == (12, 26)
    assert found.frames.actions.shape == (12, 25, 7)
    assert found.frames.features.shape == (12, 6, 192)
    assert found.calm.tolist() == [True] * 8 + [False] * 4
    film = read_film(films[1].path)
    window = 4 + 2  # of the second film, the one from its third mark
    assert np.array_equal(found.frames.states[window], film.proprio[10:36])
    assert np.array_equal(found.frames.actions[window], film.actions[10:35])
    assert np.array_equal(found.margin[window], film.margin[2:8])
    assert np.allclose(found.frames.features[window], encoder("pixels:8:128").encode(film.pictures[2:8]), atol=1e-4)


def test_what_remains_is_the_time_until_the_goal_lasts(films, tmp_path):
    found = cut(films, tmp_path)
    told = 0
    for number, one in enumerate(films):
        truth = read_film(one.path).truth[:, 0]
        lasting = [bool(truth[mark:].all()) for mark in range(len(truth))]
        rows = np.flatnonzero(found.film == number)
        for start, row in enumerate(rows):
            expected = [
                0.0 if lasting[mark] else (lasting.index(True) - mark) * 0.25 if one.calm and any(lasting) else np.inf
                for mark in range(start, start + 6)
            ]
            assert found.remaining[row].tolist() == expected
            told += any(0 < value < np.inf for value in expected)
    assert told >= 3


def test_features_are_kept_and_those_of_other_films_are_not_taken(films, tmp_path):
    said = []
    base = encoder("pixels:8:128")
    first = windows(films[:2], ASKED, base, tmp_path / "kept.npy", said.append)
    again = windows(films[:2], ASKED, base, tmp_path / "kept.npy", said.append)
    assert len(said) == 1
    assert np.array_equal(first.frames.features, again.frames.features)
    other = windows(films[2:4], ASKED, base, tmp_path / "kept.npy", said.append)
    assert len(said) == 2
    assert not np.array_equal(first.frames.features, other.frames.features)


def test_splits_share_no_initial_state():
    assert Counter(split_of(state) for state in range(40)) == {"train": 24, "held": 6, "test": 10}
    assert Filmed(0, 43, 3, "altered", None).split == Filmed(0, 3, 3, "demonstration", None).split


def test_a_film_that_was_cut_off_is_told(films, tmp_path):
    path = tmp_path / "cut.npz"
    path.write_bytes(films[0].path.read_bytes()[:-200])
    with pytest.raises(OntoError) as caught:
        read_film(path)
    assert caught.value.problems[0].code == "WM017"


def test_an_encoder_of_another_size_is_refused(films, tmp_path):
    with pytest.raises(OntoError) as caught:
        windows(films[:1], ASKED, encoder("pixels:8:64"), tmp_path / "features.npy", lambda _text: None)
    assert caught.value.problems[0].code == "WM009"


class Broken:
    """An encoder that gives no number for one picture."""

    name, size, shape, identity = "broken", 128, (2,), "0" * 64

    def encode(self, pictures):
        found = np.zeros((len(pictures), 2), dtype=np.float32)
        found[-1, 0] = np.nan
        return found


def test_features_that_are_not_finite_are_refused(films, tmp_path):
    with pytest.raises(OntoError) as caught:
        windows(films[:1], ASKED, Broken(), tmp_path / "features.npy", lambda _text: None)
    assert caught.value.problems[0].code == "WM010"
