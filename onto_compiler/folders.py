"""The files that a folder stands for, and the target of a path."""

from __future__ import annotations

from pathlib import Path

__all__ = ["actual", "below"]


def actual(path: Path) -> Path:
    """The absolute path without links; a link that leads nowhere stays, for its reader to complain of."""
    return path.resolve() if path.exists() else path.absolute()  # `resolve` raises where links go round in a circle


def below(folder: Path, pattern: str) -> list[Path]:
    """What matches ``pattern`` in ``folder`` or below it, sorted.

    Hidden files and folders are passed over: ``.venv`` and ``.git`` hold other people's files, ``.#name`` is a lock.
    """
    found = folder.rglob(pattern)
    return sorted(path for path in found if not any(part[0] == "." for part in path.relative_to(folder).parts))
