from __future__ import annotations

import io
import re
from dataclasses import replace

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.report.filmstrip import Shot, shots, write_film
from tests.runtime.trace.samples import SCHEMA, accepted

PIL = pytest.importorskip("PIL.Image")


def actions(*grippers):
    given = np.zeros((len(grippers), 7))
    given[:, 6] = grippers
    return given


def test_an_attempt_is_shown_before_at_grasp_and_release_and_after():
    given = actions(*[-1] * 10, *[1] * 30, *[-1] * 5)
    assert shots(given, (0, 45)) == (
        Shot(0, "before", 0),
        Shot(0, "grasp", 20),
        Shot(0, "release", 40),
        Shot(0, "after", 45),
    )


def test_each_attempt_has_its_own_moments_and_a_push_is_shown_on_the_way():
    given = actions(*[-1] * 20, *[1] * 4)
    shown = shots(given, (0, 10, 24))
    assert [moment.name for moment in shown if moment.attempt == 0] == ["before", "on the way", "after"]
    assert [(m.name, m.step) for m in shown if m.attempt == 1] == [
        ("before", 10),
        ("grasp", 23),
        ("release", 24),
        ("after", 24),
    ]


def picture(step):
    buffer = io.BytesIO()
    PIL.new("RGB", (64, 48), (step, 0, 0)).save(buffer, "JPEG")
    return buffer.getvalue()


SHOWN = (Shot(0, "before", 0), Shot(0, "grasp", 3), Shot(0, "after", 9))


def test_a_page_holds_every_picture_and_the_story(tmp_path):
    path = tmp_path / "new" / "film.html"
    write_film(path, accepted(), SCHEMA, SHOWN, picture)
    text = path.read_text("utf-8")
    assert len(re.findall('<img src="data:image/jpeg', text)) == 3
    assert "grasp, step 3" in text
    assert "the native verifier accepts" in text


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_a_picture_has_a_row_for_each_attempt(tmp_path, suffix):
    path = tmp_path / f"film{suffix}"
    write_film(path, accepted(), SCHEMA, SHOWN, picture)
    width, height = PIL.open(path).size
    assert width == 3 * 64
    assert 48 < height < 2 * 48
    write_film(path, accepted(), SCHEMA, (*SHOWN, Shot(1, "before", 9), Shot(1, "after", 20)), picture)
    assert PIL.open(path).size == (width, 2 * height)


@pytest.mark.parametrize("name", ["film.png", "film.html"])
def test_an_episode_without_attempts_is_shown_where_it_starts(tmp_path, name):
    shown = shots(actions(), (0,))
    assert shown == (Shot(0, "start", 0),)
    write_film(tmp_path / name, replace(accepted(), attempts=()), SCHEMA, shown, picture)
    content = (tmp_path / name).read_bytes()
    assert content.startswith(b"\x89PNG") if name.endswith("png") else b"start, step 0" in content


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OntoError) as caught:
        write_film(tmp_path / "file" / "film.html", accepted(), SCHEMA, SHOWN, picture)
    assert caught.value.problems[0].code == "TRC001"
