"""``onto check --fix``: repair problems with a mechanical fix until none is left, first in memory, then on disk."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pyoxigraph import Store

from onto_compiler.check.edits import Edit, apply, edits
from onto_compiler.check.formats.checked import Repair
from onto_compiler.check.imports import Imports
from onto_compiler.check.model import Model, load_model
from onto_compiler.check.run import Report, check_model
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.check.tasks import check_all, split
from onto_compiler.problems import OntoError, Problem
from onto_compiler.sources import read_into
from onto_compiler.turtle.tokens import SourceText

__all__ = ["Fixed", "Repairs", "diff", "fix", "repair", "repairs", "write"]

_ROUNDS = 20  # a repair may show another problem (a prefix that its term was the last to use); this ends all circles


@dataclass(frozen=True, slots=True)
class Fixed:
    """The repairs, the resulting texts, and the remaining problems."""

    edits: tuple[Edit, ...]
    before: Mapping[Path, str]
    after: Mapping[Path, str]  # as ``before``: changed files only
    report: Report


@dataclass(frozen=True, slots=True)
class Repairs:
    """What :func:`repair` did."""

    edits: tuple[Edit, ...]
    before: Mapping[Path, str]
    after: Mapping[Path, str]  # as ``before``: changed files only


def fix(paths: Sequence[Path | str], settings: Settings = DEFAULT) -> Fixed:
    """Repair the Turtle among ``paths`` in memory; nothing is written, and what does not parse stays as it is."""
    made = repair(split(paths)[0], settings)
    return Fixed(made.edits, made.before, made.after, check_all(paths, made.after, settings))


def repair(
    turtle: Sequence[Path],
    settings: Settings = DEFAULT,
    texts: Mapping[Path, str] | None = None,
    only: Collection[Path] | None = None,
) -> Repairs:
    """Repair Turtle files until nothing is left to repair; of these alone ``only``, where it is given.

    ``texts`` is as :func:`onto_compiler.check.model.load_model` has it.
    """
    before: dict[Path, str] = {}
    after: dict[Path, str] = {}
    done: list[Edit] = []
    for _ in range(_ROUNDS if turtle else 0):
        try:
            model = load_model(turtle, {**(texts or {}), **after}, lead=Imports(settings.imported))
        except OntoError:
            break
        problems = check_model(model, settings)
        changed = False
        for path in model.files if only is None else only:
            found = edits(model, path, [problem for problem in problems if problem.file == str(path)])
            text = apply(model.text(path), found)
            if found and not read_into(Store(), path, text):
                before.setdefault(path, model.text(path))
                after[path] = text
                done += found
                changed = True
        if not changed:
            break
    return Repairs(tuple(done), before, after)


def repairs(report: Report, paths: Sequence[Path | str]) -> Mapping[Problem, Repair]:
    """What :func:`fix` would do first about the problems of ``report``, which a check of ``paths`` gave."""
    turtle, _ = split(paths)
    found: dict[Problem, Repair] = {}
    try:
        model = load_model(turtle) if turtle else Model(Store(), ())
    except OntoError:
        return found
    for path in model.files:
        text = SourceText(str(path), model.text(path))
        for edit in edits(model, path, [problem for problem in report.problems if problem.file == str(path)]):
            found[edit.problem] = Repair(text.span(edit.start, edit.end), edit.text, edit.done)
    return found


def diff(fixed: Fixed, shown: Mapping[Path, str]) -> str:
    """The changes as a unified diff, each file under the name that ``shown`` gives it."""
    lines: list[str] = []
    for path in sorted(fixed.after):
        old, new = (text.splitlines(keepends=True) for text in (fixed.before[path], fixed.after[path]))
        changed = difflib.unified_diff(old, new, shown[path], shown[path])
        lines += (line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in changed)
    return "".join(lines)


def write(fixed: Fixed) -> None:
    """Write the changed files, each with the byte-order mark and the line ends that it had.

    Raises:
        OntoError: FIX001, for every file that cannot be written.

    """
    faults: list[Problem] = []
    for path, text in fixed.after.items():
        mark = b"\xef\xbb\xbf"
        try:
            start = mark if path.read_bytes().startswith(mark) else b""
            path.write_bytes(start + text.encode())
        except OSError as error:
            faults += OntoError.of(
                "FIX001",
                f"cannot write `{path.name}`: {error.strerror or error}",
                "make the file writable, or see the changes with `--diff`",
                str(path),
            ).problems
    if faults:
        raise OntoError(*faults)
