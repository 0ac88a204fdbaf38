"""Audited tasks on disk, one file each, so that an interrupted audit can be resumed.

A file's name is a hash of everything that affects the result: task file, initial states, seed, assets, ontology,
versions of the simulator's packages, and sources of the measures. An unreadable file is ignored.
"""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Sequence
from dataclasses import asdict
from functools import cache
from pathlib import Path

import ontology
from onto_compiler.atomic import replacing
from onto_compiler.cache import digest
from onto_compiler.sources import collect
from onto_compiler.versions import version_of
from runtime.worlds.libero.audit.records import TaskAudit, task_of
from runtime.worlds.libero.simulator.assets import TaskRef, asset_folders
from runtime.worlds.libero.simulator.compiled import PACKAGES

__all__ = ["AuditCache"]

_LOG = logging.getLogger("onto_evwm.audit")
_PROJECT = Path(__file__).resolve().parents[2]
_SOURCES = ("grounding", "runtime/worlds/libero/audit", "runtime/worlds/libero/simulator")


class AuditCache:
    """Task audits in ``folder``; None disables the cache."""

    def __init__(self, folder: Path | None, extra: Sequence[str | Path], seed: int) -> None:
        self._folder = None if folder is None else folder / "audits"
        self._base = f"{_knowledge(tuple(map(str, extra)))} {_sources()} {_assets(asset_folders())} {seed}"
        self._base += "".join(f" {name}={version_of(name)}" for name in PACKAGES)

    def load(self, ref: TaskRef) -> TaskAudit | None:
        """The cached audit of ``ref``, with all the states that were audited; or None."""
        if self._folder is None:
            return None
        path = self._path(ref)
        try:
            return task_of(json.loads(path.read_text(encoding="utf-8")))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            _LOG.warning("kept audit %s cannot be used: %s", path.name, error)
            return None

    def save(self, ref: TaskRef, task: TaskAudit) -> None:
        """Store ``task``; a folder that cannot be written is reported in the log."""
        if self._folder is None or not task.states:
            return
        path = self._path(ref)
        try:
            with replacing(path) as partial:
                partial.write_text(json.dumps(asdict(task), allow_nan=False), encoding="utf-8")
        except OSError as error:
            _LOG.warning("the audit cannot be kept in %s: %s", self._folder, error)

    def _path(self, ref: TaskRef) -> Path:
        if self._folder is None:
            raise ValueError("nothing is kept without a folder")
        total = hashlib.sha256(f"{self._base} {ref.suite} {ref.name}\n".encode())
        for path in (ref.bddl, ref.initial_states):
            total.update(hashlib.sha256(path.read_bytes() if path.is_file() else b"").digest())
        return self._folder / f"{total.hexdigest()}.json"


@cache
def _knowledge(extra: tuple[str, ...]) -> str:
    return digest([*ontology.turtle_files(), *collect(extra)])


@cache
def _assets(folders: tuple[Path, ...]) -> str:
    """Path, size and time of every mesh, texture and part of a scene."""
    total = hashlib.sha256()
    for path in sorted(path for folder in folders for path in folder.rglob("*")):
        status = path.stat()
        if not path.is_dir():
            total.update(f"{path} {status.st_size} {status.st_mtime_ns}\n".encode())
    return total.hexdigest()


@cache
def _sources() -> str:
    total = hashlib.sha256()
    for path in sorted(path for part in _SOURCES for path in (_PROJECT / part).rglob("*.py")):
        total.update(hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()
