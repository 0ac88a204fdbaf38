"""Open HDF5 files; exceptions of h5py become problems."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from onto_compiler.problems import OntoError

__all__ = ["PACKED", "h5py", "reading"]

PACKED: Mapping[str, Any] = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
"""How arrays of many steps are stored."""


def h5py() -> Any:  # noqa: ANN401  an untyped package
    """The package ``h5py``; raises ``DEM004`` if it is not installed."""
    try:
        return importlib.import_module("h5py")
    except ImportError as error:
        message = "demonstrations are HDF5 files, and h5py is not installed"
        raise OntoError.of("DEM004", message, 'pip install "onto-evwm[demos]"') from error


@contextmanager
def reading(path: Path) -> Iterator[Any]:
    """The open file ``path``; raises ``DEM001`` if it, or a part that is asked for, cannot be read."""
    library = h5py()
    if not path.is_file():
        raise OntoError.of("DEM001", "there is no such file", "`onto demos collect` makes some", str(path))
    try:
        with library.File(path, "r", locking=False) as file:
            yield file
    except (OSError, RuntimeError) as error:  # h5py's own: not HDF5, truncated, a checksum that fails
        hint = "a file that was cut off is made again by the same `onto demos collect`"
        raise OntoError.of("DEM001", f"the file cannot be read: {error}", hint, str(path)) from error
