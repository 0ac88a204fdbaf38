"""A baseline: the problems that a project had when it began to check, which are not reported again.

Problems are told apart by file, code and message, and counted; lines do not matter, since they move.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from onto_compiler.atomic import replacing
from onto_compiler.problems import OntoError, Problem

__all__ = ["beyond", "read_baseline", "write_baseline"]

_VERSION = 1
_HINT = "write it anew with `--write-baseline`"
_Key = tuple[str, str, str]  # file, code, message


def write_baseline(path: Path, problems: Iterable[Problem]) -> int:
    """Write all ``problems`` to ``path``; return how many there are.

    Raises:
        OntoError: CFG003, where the file cannot be written.

    """
    found = Counter(_key(path, problem) for problem in problems)
    rows = [[*key, number] for key, number in sorted(found.items())]
    try:
        with replacing(path) as partial:
            partial.write_text(json.dumps({"version": _VERSION, "problems": rows}, indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        message = f"cannot write `{path.name}`: {error.strerror or error}"
        raise OntoError.of("CFG003", message, "name a file in a folder that can be written", str(path)) from error
    return found.total()


def read_baseline(path: Path) -> Counter[_Key]:
    """How many problems of each kind the baseline holds.

    Raises:
        OntoError: CFG003, where the file cannot be read, is no baseline, or is one of another version.

    """
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        version = held["version"]
        rows = held["problems"] if version == _VERSION else []
        found: Counter[_Key] = Counter({(str(file), str(code), str(said)): int(n) for file, code, said, n in rows})
    except OSError as error:
        message = f"cannot read the baseline `{path.name}`: {error.strerror or error}"
        raise OntoError.of("CFG003", message, _HINT, str(path)) from error
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise OntoError.of("CFG003", f"`{path.name}` is no baseline", _HINT, str(path)) from error
    if version != _VERSION:
        message = f"`{path.name}` is a baseline of version {version}, and this program reads version {_VERSION}"
        raise OntoError.of("CFG003", message, _HINT, str(path))
    return found


def beyond(path: Path, baseline: Counter[_Key], problems: Iterable[Problem]) -> Iterator[Problem]:
    """The ``problems`` that the baseline of ``path`` does not hold, or not as often."""
    left = baseline.copy()
    for problem in problems:
        key = _key(path, problem)
        left[key] -= 1
        if left[key] < 0:
            yield problem


def _key(path: Path, problem: Problem) -> _Key:
    """With the file as seen from the baseline's folder, so that a checkout may move."""
    file, folder = Path(problem.file), path.resolve().parent
    shown = file.relative_to(folder) if file.is_relative_to(folder) else file
    return shown.as_posix(), problem.code, problem.message
