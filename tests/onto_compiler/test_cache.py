"""A cache of verdicts is there as long as what it depends on; what is wrong with it costs time and nothing else."""

import pytest

from onto_compiler.cache import VerdictCache, cache_folder, digest


@pytest.fixture
def filled(tmp_path):
    cache = VerdictCache(tmp_path / "cache", "d")
    cache.add({"abc": {"facts": 2}, "def": {"facts": 3}})
    cache.save()
    return cache


def test_a_verdict_is_kept_until_what_it_depends_on_changes(tmp_path):
    ttl = tmp_path / "a.ttl"
    ttl.write_text("# one")
    first = digest([ttl])
    cache = VerdictCache(tmp_path / "cache", first)
    cache.add({"abc": {"facts": 2}})
    cache.save()
    assert VerdictCache(cache.folder, first).get("abc") == {"facts": 2}
    ttl.write_text("# two")
    assert digest([ttl]) != first
    assert len(VerdictCache(cache.folder, digest([ttl]))) == 0
    ttl.write_text("# one")
    assert VerdictCache(cache.folder, digest([ttl])).get("abc") == {"facts": 2}, "two ontologies can take turns"


def test_relative_iris_start_at_a_files_place_so_that_the_place_counts(tmp_path):
    for name in ("a.ttl", "b.ttl"):
        (tmp_path / name).write_text("<#x> a <#y> .")
    assert digest([tmp_path / "a.ttl"]) != digest([tmp_path / "b.ttl"])
    assert digest([tmp_path / "a.ttl"]) == digest([tmp_path / "c" / ".." / "a.ttl"])


def test_a_file_that_is_cut_off_anywhere_counts_as_none(filled):
    whole = filled.path.read_bytes()
    assert len(whole) > 130
    for length in range(len(whole) - 1):  # the line end after the verdicts says nothing
        filled.path.write_bytes(whole[:length])
        again = VerdictCache(filled.folder, "d")
        assert (len(again), again.damaged) == (0, True), length
    filled.path.write_bytes(whole)
    assert len(VerdictCache(filled.folder, "d")) == 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"facts": 2', b'"facts": 7'),
        (b'{"digest": "d"', b'{"digest": "e"'),
        (b'"sha256"', b'"sha512"'),
        (b'{"abc"', b"\xff\xfe"),
        (b'{"digest"', b"[" * 100_000),
    ],
)
def test_a_file_that_was_altered_counts_as_none(filled, old, new):
    data = filled.path.read_bytes()
    assert data.count(old) == 1
    filled.path.write_bytes(data.replace(old, new))
    again = VerdictCache(filled.folder, "d")
    assert (len(again), again.damaged) == (0, True)
    again.add({"ghi": {"facts": 1}})
    again.save()
    assert VerdictCache(filled.folder, "d").get("ghi") == {"facts": 1}


def test_two_that_write_keep_what_either_found(filled):
    one, other = (VerdictCache(filled.folder, "d") for _ in range(2))
    one.add({"one": 1})
    other.add({"other": 2})
    one.save()
    other.save()
    assert len(VerdictCache(filled.folder, "d")) == 4
    assert [path.name for path in filled.folder.iterdir()] == [filled.path.name]


def test_what_cannot_be_written_leaves_what_was_there(filled, monkeypatch):
    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.replace", refuse)
    filled.add({"ghi": {}})
    with pytest.raises(OSError, match="No space"):
        filled.save()
    monkeypatch.undo()
    assert len(VerdictCache(filled.folder, "d")) == 2
    assert [path.name for path in filled.folder.iterdir()] == [filled.path.name]


def test_a_cache_to_which_nothing_was_added_is_not_written(tmp_path):
    VerdictCache(tmp_path / "cache", "d").save()
    assert not (tmp_path / "cache").exists()


def test_files_of_long_ago_go(tmp_path):
    for number in range(20):
        cache = VerdictCache(tmp_path, str(number))
        cache.add({"abc": number})
        cache.save()
    assert len(list(tmp_path.iterdir())) == 16
    assert VerdictCache(tmp_path, "19").get("abc") == 19


def test_the_folder_is_where_the_system_keeps_caches(monkeypatch, tmp_path):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    assert cache_folder() == tmp_path / ".cache/onto-evwm"
    monkeypatch.setenv("XDG_CACHE_HOME", "here")  # the specification: a relative path is to be ignored
    assert cache_folder() == tmp_path / ".cache/onto-evwm"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "x"))
    assert cache_folder() == tmp_path / "x/onto-evwm"
    monkeypatch.setattr("sys.platform", "darwin")
    assert cache_folder() == tmp_path / "Library/Caches/onto-evwm"
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "Local"))
    assert cache_folder() == tmp_path / "Local/onto-evwm"


def test_without_a_home_there_is_no_folder(monkeypatch):
    def homeless():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr("pathlib.Path.home", homeless)
    assert cache_folder() is None
