"""Archives are unpacked only where they are the ones that were measured."""

import hashlib
import io
import tarfile
import zipfile

import pytest

from benchmarks.archives import fetch
from onto_compiler.problems import OntoError

FILES = {
    "pkg-1/data/a.txt": b"a",
    "pkg-1/data/sub/b.txt": b"b",
    "pkg-1/database/c.txt": b"c",
    "pkg-1/setup.py": b"raise",
}


def put_tar(folder, files):
    path = folder / "pkg-1.tar.gz"
    with tarfile.open(path, "w:gz") as archive:
        for name, data in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(data)
            archive.addfile(member, io.BytesIO(data))
        link = tarfile.TarInfo("pkg-1/data/link")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(link)
    return path


def put_zip(folder, files):
    path = folder / "pkg-1.whl"
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return path


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.parametrize("put", [put_tar, put_zip])
def test_only_files_below_the_prefix_are_unpacked(put, tmp_path):
    archive = put(tmp_path, FILES)
    folder = fetch("pkg==1", archive.name, digest(archive), "pkg-1/data", cache=tmp_path)
    assert {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()} == {
        "a.txt": b"a",
        "sub/b.txt": b"b",
    }
    assert not list(folder.parent.glob("*.py"))


def test_a_second_call_needs_no_archive(tmp_path):
    archive = put_tar(tmp_path, FILES)
    sha256 = digest(archive)
    first = fetch("pkg==1", archive.name, sha256, "pkg-1/data", cache=tmp_path)
    archive.unlink()
    assert fetch("pkg==1", archive.name, sha256, "pkg-1/data", cache=tmp_path) == first


def test_an_archive_with_another_checksum_is_refused(tmp_path):
    archive = put_zip(tmp_path, FILES)
    with pytest.raises(OntoError, match=r"BEN003.*SHA-256") as caught:
        fetch("pkg==1", archive.name, "0" * 64, "pkg-1", cache=tmp_path)
    assert str(archive) in caught.value.problems[0].hint
    assert list(tmp_path.iterdir()) == [archive]


def test_a_prefix_that_holds_nothing_is_refused_and_leaves_nothing(tmp_path):
    archive = put_tar(tmp_path, FILES)
    with pytest.raises(OntoError, match="holds no file below"):
        fetch("pkg==1", archive.name, digest(archive), "pkg-1/dat", cache=tmp_path)
    assert list(tmp_path.iterdir()) == [archive]


@pytest.mark.parametrize("put", [put_tar, put_zip])
def test_nothing_is_written_outside_the_cache(put, tmp_path):
    cache = tmp_path / "cache"
    cache.mkdir()
    archive = put(cache, {"pkg-1/../../../evil.txt": b"x", "pkg-1/good.txt": b"y"})
    folder = fetch("pkg==1", archive.name, digest(archive), "pkg-1", cache=cache)
    assert [p.name for p in folder.rglob("*") if p.is_file()] == ["good.txt"]
    assert not list(tmp_path.glob("evil.txt"))


def test_what_pip_cannot_bring_is_a_problem(tmp_path, monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    with pytest.raises(OntoError, match="cannot download `no-such-package==1`"):
        fetch("no-such-package==1", "no-such-package-1.tar.gz", "0" * 64, cache=tmp_path)
