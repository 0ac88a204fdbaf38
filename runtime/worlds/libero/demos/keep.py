"""The demonstrations of one task on disk while they are collected: a part for each trial, then one file.

An interrupted collection resumes from the parts. A damaged part or file is made again. One process at a time collects
a task; the lock ends with the process.
"""

from __future__ import annotations

import fcntl
import json
import logging
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from onto_compiler.atomic import replacing
from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.read import load
from runtime.worlds.libero.demos.records import DemoFile, Demonstration
from runtime.worlds.libero.demos.write import merge, write

__all__ = ["Kept", "TaskStore"]

_LOG = logging.getLogger("onto_evwm.demos")
Place = tuple[Path, str]
Kept = dict[int, Place | str]
"""Trial -> where its demonstration is (file and name), or why there is none."""


class TaskStore:
    """The files in ``folder`` of the task ``name`` of ``suite``, all made with ``spec``."""

    def __init__(self, folder: Path, suite: str, name: str, spec: Mapping[str, Any]) -> None:
        self.path = folder / suite / f"{name}_demo.hdf5"
        self.parts = folder / suite / f"{name}_demo.parts"
        self._lock = folder / suite / f".{name}.lock"
        self._spec = dict(spec)

    @contextmanager
    def locked(self, *, wait: bool) -> Iterator[bool]:
        """Whether this process may collect; with ``wait``, as soon as no other does.

        Raises ``DEM006`` if the folder cannot be written.
        """
        try:
            self._lock.parent.mkdir(parents=True, exist_ok=True)
            file = self._lock.open("w")
        except OSError as error:
            raise _unwritable(self._lock, error) from error
        with file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            except BlockingIOError:
                yield False
                return
            yield True

    def known(self) -> Kept:
        """Every stored trial; raises ``DEM003`` if some were made with other options."""
        found: Kept = {}
        if (file := self._whole(self.path)) is not None:
            found |= {int(number): str(reason) for number, reason in file.about.get("rejected", {}).items()}
            found |= _places(file, self.path)
        for path in sorted(self.parts.glob("trial_*.hdf5")):
            if (part := self._whole(path)) is not None:
                found = {**_places(part, path), **found}
        for path in sorted(self.parts.glob("trial_*.json")):
            try:
                record = json.loads(path.read_text(encoding="utf-8"))
                self._check(record["spec"], path)
                found.setdefault(int(record["trial"]), str(record["reason"]))
            except (OSError, ValueError, KeyError, TypeError) as error:
                _LOG.warning("%s is damaged and its trial will be run again: %s", path.name, error)
        return found

    def keep(self, trial: int, attributes: Mapping[str, Any], found: Demonstration | str) -> Place | str:
        """Store the result of ``trial``, and return where; raises ``DEM006`` if it cannot be written."""
        path = self.parts / f"trial_{trial:04d}.hdf5"
        if isinstance(found, Demonstration):
            write(path, attributes, {"spec": self._spec}, [found])
            return path, "demo_0"
        try:
            with replacing(path.with_suffix(".json")) as partial:
                partial.write_text(json.dumps({"spec": self._spec, "trial": trial, "reason": found}), encoding="utf-8")
        except OSError as error:
            raise _unwritable(path, error) from error
        return found

    def finish(self, kept: Kept, attributes: Mapping[str, Any], count: int) -> None:
        """Merge the first ``count`` demonstrations into one file, and delete the parts; raises ``DEM006``."""
        places = [(trial, place) for trial, place in sorted(kept.items()) if not isinstance(place, str)][:count]
        last = places[-1][0] if len(places) == count else max(kept, default=-1)
        rejected = {str(trial): why for trial, why in sorted(kept.items()) if isinstance(why, str) and trial <= last}
        merge(self.path, attributes, {"spec": self._spec, "rejected": rejected}, [place for _, place in places])
        shutil.rmtree(self.parts, ignore_errors=True)

    def _whole(self, path: Path) -> DemoFile | None:
        """The file at ``path``, if it is there and whole."""
        if not path.is_file():
            return None
        try:
            file = load(path)
        except OntoError as error:
            if error.problems[0].code == "DEM004":
                raise
            _LOG.warning("%s is damaged and will be made again: %s", path.name, error)
            return None
        self._check(file.about.get("spec"), path)
        return file

    def _check(self, spec: Any, path: Path) -> None:  # noqa: ANN401  what a JSON file holds
        if spec == self._spec:
            return
        theirs = spec if isinstance(spec, dict) else {}
        other = sorted(name for name in {*theirs, *self._spec} if theirs.get(name) != self._spec.get(name))
        other_options = ", ".join(f"{name} {theirs.get(name)!r} and not {self._spec.get(name)!r}" for name in other)
        raise OntoError.of(
            "DEM003",
            f"the demonstrations there were made with {other_options}",
            "choose another --out, or remove it",
            str(path),
        )


def _places(file: DemoFile, path: Path) -> Kept:
    return {demo.origin.trial: (path, demo.name) for demo in file.demos if demo.origin is not None}


def _unwritable(path: Path, error: OSError) -> OntoError:
    return OntoError.of("DEM006", f"cannot be written: {error}", "choose another --out", str(path))
