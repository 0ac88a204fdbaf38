"""A cache of compiled task files, valid for the same ontology and the same compiler.

A cache is one file for each ``digest``. It is written again beside the old one and put in its place, so that a reader
sees one or the other; a file whose checksum does not fit what it holds counts as none.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from onto_compiler.atomic import replacing
from onto_compiler.versions import version_of

__all__ = ["VerdictCache", "cache_folder", "digest"]

_COMPILER = Path(__file__).parent
_KEPT = 16  # files; as many ontologies, or versions of one, can take turns


def digest(files: Iterable[Path]) -> str:
    """A SHA-256 over what decides a verdict: ``files`` and their places, this package's sources, the versions.

    A file's place counts since relative IRIs in it start there.

    Raises:
        OSError: where a file cannot be read.
    """
    total = hashlib.sha256(f"python {sys.version_info[:3]}\n".encode())
    for name in ("onto-evwm", "lark", "pyoxigraph"):
        total.update(f"{name} {version_of(name)}\n".encode())
    for path in sorted({*_COMPILER.rglob("*.py"), *_COMPILER.rglob("*.lark")}):
        total.update(hashlib.sha256(path.read_bytes()).digest())
    for path in sorted({file.resolve() for file in files}):
        total.update(f"{path.as_uri()} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return total.hexdigest()


def cache_folder() -> Path | None:
    """Our folder in the user's cache directory; None without a home directory."""
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = home / "Library" / "Caches"
    else:
        given = Path(os.environ.get("XDG_CACHE_HOME", ""))
        base = given if given.is_absolute() else home / ".cache"  # XDG: a relative path is to be ignored
    return base / "onto-evwm"


class VerdictCache:
    """JSON verdicts by key in one file of ``folder``, for one ``digest``."""

    def __init__(self, folder: Path, digest: str) -> None:
        """Read the entries for ``digest``; a damaged file counts as empty and sets :attr:`damaged`."""
        self.folder, self.digest = folder, digest
        self.path = folder / f"verdicts-{digest[:32]}.json"
        kept = self._read()
        self.damaged = kept is None
        self._verdicts = kept or {}
        self._fresh: dict[str, Any] = {}

    def __len__(self) -> int:
        return len(self._verdicts)

    def get(self, key: str) -> Any | None:  # noqa: ANN401 - whatever JSON holds
        """The cached verdict for ``key``, or None."""
        return self._verdicts.get(key)

    def add(self, verdicts: Mapping[str, Any]) -> None:
        """Add ``verdicts`` by key; :meth:`save` writes them."""
        self._verdicts.update(verdicts)
        self._fresh.update(verdicts)

    def save(self) -> None:
        """Write the file again, whole or not at all, with what another process has added meanwhile.

        Raises:
            OSError: where the folder or the file cannot be written.
        """
        if not self._fresh:
            return
        verdicts = json.dumps({**(self._read() or {}), **self._verdicts})
        head = json.dumps({"digest": self.digest, "sha256": _checksum(verdicts)})
        with replacing(self.path) as partial:
            partial.write_text(f"{head}\n{verdicts}\n", encoding="utf-8")
        self._fresh.clear()
        self._prune()

    def _read(self) -> dict[str, Any] | None:
        """The verdicts on disk; None if the file is damaged."""
        try:
            head, _, verdicts = self.path.read_text(encoding="utf-8").partition("\n")
        except UnicodeDecodeError:
            return None
        except OSError:  # not there yet, or not ours to read: saving says so where it matters
            return {}
        try:
            expected, found = json.loads(head), verdicts.removesuffix("\n")
            if expected != {"digest": self.digest, "sha256": _checksum(found)}:
                return None
            kept: dict[str, Any] = json.loads(found)
        except (ValueError, RecursionError):
            return None
        return kept

    def _prune(self) -> None:
        """Remove all but the newest files, which an ontology or a compiler of long ago wrote."""
        with suppress(OSError):  # another process may be removing them, too
            files = sorted(self.folder.glob("verdicts-*.json"), key=lambda file: file.stat().st_mtime, reverse=True)
            for old in files[_KEPT:]:
                old.unlink(missing_ok=True)


def _checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
