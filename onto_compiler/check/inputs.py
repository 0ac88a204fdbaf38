"""What the command line names: files, folders without what is excluded, globs, and standard input."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from glob import glob, has_magic
from pathlib import Path

from onto_compiler.check.settings import Settings
from onto_compiler.folders import below
from onto_compiler.problems import OntoError, Problem

__all__ = ["STDIN", "Inputs", "expanded", "read_stdin", "without_excluded"]

STDIN = Path("-")


@dataclass(frozen=True, slots=True)
class Inputs:
    """The ``paths`` that are there; what is wrong with the others is in ``problems``.

    ``texts`` holds standard input, by the path that stands for it.
    """

    paths: tuple[Path, ...]
    problems: tuple[Problem, ...] = ()
    texts: Mapping[Path, str] = field(default_factory=dict)


def read_stdin(paths: Iterable[Path], name: Path | None) -> dict[Path, str]:
    """Standard input by its path, where one of ``paths`` is ``-``: that of ``name``, or ``<stdin>`` in this folder.

    Raises:
        OntoError: TTL002, where it is not UTF-8.

    """
    if STDIN not in paths:
        return {}
    path = (name or Path("<stdin>")).resolve()
    try:
        return {path: sys.stdin.buffer.read().decode("utf-8-sig")}
    except UnicodeDecodeError as error:
        message = f"standard input is not UTF-8: byte 0x{error.object[error.start]:02X} at {error.start}"
        raise OntoError.of("TTL002", message, "send it as UTF-8", str(path)) from error


def expanded(paths: Iterable[Path], texts: Mapping[Path, str]) -> Inputs:
    """``paths`` with globs as what they match, and ``-`` as the path of standard input."""
    found: dict[Path, None] = {}
    problems = []
    for path in paths:
        if path == STDIN:
            found.update(dict.fromkeys(texts))
        elif path.exists():
            found[path] = None
        else:
            matching = sorted(glob(str(path), recursive=True)) if has_magic(str(path)) else []  # noqa: PTH207 - of any folder
            found.update(dict.fromkeys(map(Path, matching)))
            if not matching:
                problems.append(_missing(path))
    return Inputs(tuple(found), tuple(problems), texts)


def _missing(path: Path) -> Problem:
    said, hint = "does not exist", "give an existing file, or a folder that holds some"
    if path.is_symlink():
        said, hint = f"is a link to `{path.readlink()}`, which does not exist", "correct the link, or remove it"
    elif has_magic(str(path)):
        said = "matches no file"
    return Problem(str(path), 0, 0, "TTL002", "error", f"`{path}` {said}", hint)


def without_excluded(inputs: Inputs, settings: Settings, endings: Sequence[str]) -> Inputs:
    """``inputs`` with the files of each folder, of which one has an excluded file, in the folder's place."""
    if not settings.exclude:
        return inputs
    paths: list[Path] = []
    problems = list(inputs.problems)
    for path in inputs.paths:
        files = [file for file in below(path, "*") if file.suffix.lower() in endings] if path.is_dir() else []
        kept = [file for file in files if not settings.excludes(file.absolute())]
        if len(kept) == len(files):
            paths.append(path)
        elif kept:
            paths += kept
        else:
            hint = "give a file itself, or correct `exclude`"
            problems.append(Problem(str(path), 0, 0, "TTL002", "error", f"every file of `{path}` is excluded", hint))
    return Inputs(tuple(paths), tuple(problems), inputs.texts)
