"""A file is replaced whole or not at all."""

import pytest

from onto_compiler.atomic import replacing


def test_what_the_block_wrote_takes_the_place_and_nothing_else_stays(tmp_path):
    path = tmp_path / "new" / "record.json"
    with replacing(path) as partial:
        partial.write_text("first")
        assert not path.exists()
    with replacing(path) as partial:
        assert partial.name == path.name
        partial.write_text("second")
        assert path.read_text() == "first"
    assert path.read_text() == "second"
    assert list(path.parent.iterdir()) == [path]


def test_a_block_that_raises_leaves_the_file_as_it_was(tmp_path):
    path = tmp_path / "record.json"
    path.write_text("before")

    def interrupted():
        with replacing(path) as partial:
            partial.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_block_that_writes_nothing_is_an_error(tmp_path):
    with pytest.raises(OSError, match="record"), replacing(tmp_path / "record.json"):
        pass


def test_the_file_has_the_permissions_that_any_new_file_gets(tmp_path):
    (tmp_path / "plain").touch()
    with replacing(tmp_path / "replaced") as partial:
        partial.touch()
    assert (tmp_path / "plain").stat().st_mode == (tmp_path / "replaced").stat().st_mode
