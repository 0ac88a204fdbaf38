"""The result of checking large files, kept until something that decides it changes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

import ontology
from onto_compiler.cache import VerdictCache, cache_folder, digest
from onto_compiler.check.progress import Step, silent
from onto_compiler.check.run import Report, check
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.problems import OntoError, Problem
from onto_compiler.registered import GROUNDINGS, SERVING, points_of
from onto_compiler.sources import collect

__all__ = ["cached_check"]

_LARGE = 256 * 1024  # bytes of all files: what is smaller is checked in less than a second


def cached_check(
    paths: Sequence[Path | str] = (),
    texts: Mapping[Path, str] | None = None,
    settings: Settings = DEFAULT,
    step: Step = silent,
) -> Report:
    """As :func:`check`; a large result is kept by the content of its files, and found again."""
    try:
        files = collect(paths)
        sizes = sum(file.stat().st_size for file in files)
    except (OntoError, OSError):
        return check(paths, texts, settings, step)
    folder = cache_folder()
    if texts or sizes < _LARGE or folder is None:
        return check(paths, texts, settings, step)
    cache = VerdictCache(folder / "checks", digest((*ontology.turtle_files(), *ontology.query_files("checks"))))
    key = _hash(*map(str, files), str(Path.cwd()), repr(settings))
    content = _hash(*map(_content, files), *_registered())
    kept = cache.get(key)
    if kept is not None and kept["content"] == content and kept["consulted"] == _contents(kept["consulted"]):
        problems = tuple(Problem(**one) for one in kept["problems"])
        consulted = tuple(map(Path, kept["consulted"]))
        return Report(problems, tuple(map(Path, kept["files"])), kept["triples"], consulted=consulted)
    report = check(paths, texts, settings, step)
    found = {
        "content": content,
        "problems": [asdict(problem) for problem in report.problems],
        "files": [str(file) for file in report.files],
        "triples": report.triples,
        "consulted": _contents(map(str, report.consulted)),
    }
    cache.add({key: found})
    with suppress(OSError):  # a folder that cannot be written costs time, and nothing else
        cache.save()
    return report


def _contents(files: Iterable[str]) -> dict[str, str]:
    """The digest of each file; an empty one of a file that is not there."""
    found = {}
    for file in files:
        found[file] = ""
        with suppress(OSError, ValueError):
            found[file] = _content(Path(file))
    return found


def _content(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _registered() -> list[str]:
    """What installed packages register for the terms of an ontology."""
    groups = (GROUNDINGS, *(group for group, _ in SERVING.values()))
    found = points_of(groups)
    return sorted(f"{group} {point.name} {point.value}" for group in groups for point in found[group])


def _hash(*parts: str) -> str:
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()
