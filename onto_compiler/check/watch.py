"""``onto check --watch``: look at the files' times now and then, and check again when one of them changed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from onto_compiler.check.documents import ENDINGS
from onto_compiler.folders import below

__all__ = ["changes", "stamps"]

_ENDINGS = frozenset((*ENDINGS, ".bddl"))

Stamps = dict[Path, tuple[int, int]]


def stamps(paths: Sequence[Path]) -> Stamps:
    """When each file of ``paths`` (or of the folders among them) was last written, in ns, and its size in bytes."""
    found: Stamps = {}
    for path in paths:
        files = (file for file in below(path, "*") if file.suffix.lower() in _ENDINGS) if path.is_dir() else (path,)
        for file in files:
            try:
                status = file.stat()
            except OSError:  # gone since it was listed: that is a change too
                continue
            found[file] = (status.st_mtime_ns, status.st_size)
    return found


def changes(
    paths: Sequence[Path], every: float = 0.3, wait: Callable[[float], object] = time.sleep
) -> Iterator[tuple[Path, ...]]:
    """Yield at once with no file, and then each time that files changed, came or went, with those files.

    ``every`` is the time between two looks, in seconds. The consumer may add to ``paths``, and ends the iterator.
    """
    before = stamps(paths)
    known = set(paths)
    yield ()
    while True:
        new = [path for path in paths if path not in known]
        known.update(new)
        before |= stamps(new)  # of a file that was added its present state has been read
        wait(every)
        now = stamps(paths)
        if now != before:
            changed = {file for file in {*now, *before} if now.get(file) != before.get(file)}
            before = now
            yield tuple(sorted(changed))
