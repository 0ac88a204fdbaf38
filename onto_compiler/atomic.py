"""Write a file atomically: to a temporary file first, which replaces it when it is complete."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["replacing"]


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to, of the same name; what is there when the block ends takes the place of ``path``.

    Another process sees the file before or the file after, never a part, and after a crash one of them is there. Where
    the block raises, ``path`` stays as it was. Missing folders are made.

    Raises:
        OSError: where the folder or the file cannot be written, or the block has written nothing.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # Within the same folder, as a file can only be moved in one step where it stays on its file system.
    with tempfile.TemporaryDirectory(prefix=f".{path.stem}-", dir=path.parent) as scratch:
        partial = Path(scratch) / path.name
        yield partial
        with partial.open("rb") as written:
            os.fsync(written.fileno())
        partial.replace(path)
