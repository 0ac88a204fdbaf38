"""Compiled scenes on disk: loaded in a tenth of a second instead of built in seconds; stale ones are built again.

A scene is two files: a record ``scenes/KEY.npz`` and the model ``models/SHA256.mjb``, which tasks in the same room
share. The key is a hash of the task file, the seed and the versions of all that takes part; the record names every
asset that the scene was built from. An asset whose size or time differs is hashed again, and a scene whose asset
differs, or whose file is damaged, counts as none.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import tempfile
import zipfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from onto_compiler.atomic import replacing

__all__ = ["SceneCache", "SceneRecord", "key_of", "stamp"]

_LOG = logging.getLogger("onto_evwm.scenes")
_RECORD = "record"  # the array that holds the JSON part
Stamp = tuple[int, int, str]


@dataclass(frozen=True, slots=True, eq=False)
class SceneRecord:
    """The record of a scene without its model: JSON values, arrays, and assets with size, time (ns) and SHA-256."""

    values: Mapping[str, Any]
    arrays: Mapping[str, NDArray[Any]]
    assets: Mapping[str, Stamp]


def key_of(parts: Mapping[str, str]) -> str:
    """A SHA-256 over names and values, in the order of the names."""
    return hashlib.sha256(json.dumps(dict(parts), sort_keys=True).encode()).hexdigest()


def stamp(paths: Iterable[Path]) -> dict[str, Stamp]:
    """Size, time and content hash of every file; raises ``OSError`` where one cannot be read."""
    return {
        str(path): (status.st_size, status.st_mtime_ns, hashlib.sha256(path.read_bytes()).hexdigest())
        for path in sorted(set(paths))
        if (status := path.stat())
    }


class SceneCache:
    """Scenes in ``folder``; None disables the cache."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder

    def load(self, key: str) -> tuple[SceneRecord, Path] | None:
        """The record kept for ``key`` and the path of its model; None if there is none that can be used."""
        if self.folder is None:
            return None
        path = _record(self.folder, key)
        try:
            record = _read(path)
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            _LOG.warning("cached scene %s is damaged and will be built again: %s", path.name, error)
            return None
        model = _model(self.folder, str(record.values["model"]))
        stale = next((name for name, known in record.assets.items() if not _same(Path(name), known)), None)
        if stale is not None:
            _LOG.info("cached scene %s is stale: %s has changed", path.name, stale)
            return None
        if not model.is_file() or _digest(model) != record.values["model"]:
            _LOG.warning("the model of cached scene %s is missing or damaged and will be built again", path.name)
            return None
        return record, model

    def save(self, key: str, record: SceneRecord, write_model: Callable[[Path], None]) -> None:
        """Store a scene; a folder that cannot be written is reported in the log."""
        if self.folder is None:
            return
        try:
            with tempfile.TemporaryDirectory(dir=_made(self.folder)) as scratch:
                model = Path(scratch) / "model.mjb"
                write_model(model)
                digest = _digest(model)
                kept = _model(self.folder, digest)
                _made(kept.parent)
                model.replace(kept)  # not `replacing`: its name follows from what was written
            values = {**record.values, "model": digest, "assets": record.assets}
            with replacing(_record(self.folder, key)) as partial:
                np.savez_compressed(partial, **{_RECORD: np.array(json.dumps(values))}, **record.arrays)  # type: ignore[arg-type]
        except OSError as error:
            _LOG.warning("the scene cannot be kept in %s: %s", self.folder, error)


def _record(folder: Path, key: str) -> Path:
    return folder / "scenes" / f"{key}.npz"


def _model(folder: Path, digest: str) -> Path:
    return folder / "models" / f"{digest}.mjb"


def _made(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def _read(path: Path) -> SceneRecord:
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    values = json.loads(str(arrays.pop(_RECORD)))
    assets = {name: (int(size), int(time), str(sha)) for name, (size, time, sha) in values.pop("assets").items()}
    return SceneRecord(values, arrays, assets)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _same(path: Path, known: Stamp) -> bool:
    size, time, digest = known
    try:
        status = os.stat(path)  # noqa: PTH116  a scene has hundreds of assets, and Path.stat costs twice as much
        return status.st_size == size and (status.st_mtime_ns == time or _digest(path) == digest)
    except OSError:
        return False
