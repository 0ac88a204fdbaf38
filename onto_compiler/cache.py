"""What was compiled once, under the same ontology and by the same compiler, need not be compiled again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

__all__ = ["VerdictCache", "digest"]

_COMPILER = Path(__file__).parent


def digest(files: Iterable[Path]) -> str:
    """A SHA-256 over the bytes of ``files``, this package's own sources, and the versions that decide a verdict."""
    sources = [*files, *_COMPILER.rglob("*.py"), *_COMPILER.rglob("*.lark")]
    total = hashlib.sha256()
    for name in ("onto-evwm", "lark", "pyoxigraph"):
        total.update(f"{name} {_version(name)}\n".encode())
    for path in sorted(set(sources)):
        total.update(hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


class VerdictCache:
    """JSON verdicts by the SHA-256 of a file's content, kept in one file; another ``digest`` starts an empty one."""

    def __init__(self, path: Path, digest: str) -> None:
        """Read what ``path`` holds, if it was written under the same ``digest``; a damaged file counts as empty."""
        self.path, self.digest = path, digest
        self._verdicts: dict[str, Any] = {}
        try:
            kept = json.loads(path.read_text(encoding="utf-8"))
            if kept["digest"] == digest:
                self._verdicts = dict(kept["verdicts"])
        except (OSError, ValueError, KeyError, TypeError):
            self._verdicts = {}

    def __len__(self) -> int:
        return len(self._verdicts)

    def get(self, key: str) -> Any | None:  # noqa: ANN401 - whatever JSON holds
        """The verdict kept for the content hash ``key``, or None."""
        return self._verdicts.get(key)

    def add(self, verdicts: Mapping[str, Any]) -> None:
        """Add ``verdicts`` by content hash; :meth:`save` writes them."""
        self._verdicts.update(verdicts)

    def save(self) -> None:
        """Write the file anew, whole or not at all."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        partial = self.path.with_suffix(".partial")
        partial.write_text(json.dumps({"digest": self.digest, "verdicts": self._verdicts}), encoding="utf-8")
        partial.replace(self.path)
