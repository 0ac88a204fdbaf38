"""``onto fmt``: Turtle and task files in one layout."""

from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from onto_compiler.command import CLEAN, FINDINGS, MISUSE, Command
from onto_compiler.problems import OntoError, render
from onto_compiler.wording import counted

__all__ = ["FMT"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("paths", nargs="+", type=Path, metavar="PATH", help="Turtle or BDDL files, or folders of them")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 where a file would change")
    parser.add_argument("--diff", action="store_true", help="write nothing; print what would change")


def _run(options: argparse.Namespace) -> int:
    wrong = [path for path in options.paths if not path.is_dir() and path.suffix not in _FORMATS]
    for path in wrong:
        sys.stderr.write(f"onto fmt: `{path}` is neither a Turtle file (*.ttl), a BDDL file (*.bddl) nor a folder\n")
    if wrong:
        return MISUSE
    changed, faulty, total = 0, 0, 0
    for path in _files(options.paths):
        total += 1
        try:
            before, after = _FORMATS[path.suffix](path)
        except OntoError as error:
            faulty += 1
            text = path.read_text("utf-8-sig", errors="replace") if path.is_file() else None
            sys.stderr.write("".join(render(problem, text) + "\n" for problem in error.problems))
            continue
        if after == before:
            continue
        changed += 1
        if options.diff:
            pair = (before.splitlines(keepends=True), after.splitlines(keepends=True))
            sys.stdout.writelines(difflib.unified_diff(*pair, str(path), str(path)))
        elif options.check:
            sys.stdout.write(f"{path}\n")
        else:
            faulty += not _write(path, after)
    dry = options.check or options.diff
    done = "would change" if dry else "changed"
    sys.stderr.write(f"{changed} of {counted(total, 'file')} {done}\n")
    return FINDINGS if faulty or (dry and changed) else CLEAN


def _task(path: Path) -> tuple[str, str]:
    from onto_compiler.bddl.layout import format_text  # noqa: PLC0415 - heavy imports wait for a file of the kind
    from onto_compiler.bddl.parse import read_text  # noqa: PLC0415

    before = read_text(path)
    return before, format_text(before, str(path))


def _turtle(path: Path) -> tuple[str, str]:
    from onto_compiler.turtle.layout import format_turtle, read_turtle  # noqa: PLC0415 - as above

    before = read_turtle(path)
    return before, format_turtle(before, path)


_FORMATS: Final[Mapping[str, Callable[[Path], tuple[str, str]]]] = {".bddl": _task, ".ttl": _turtle}
"""By a file's ending: its text as it is, and as it should be."""


def _files(paths: Sequence[Path]) -> Iterator[Path]:
    for path in paths:
        if path.is_dir():
            found = (file for ending in _FORMATS for file in path.rglob(f"*{ending}"))
            # What is hidden belongs to others: .venv, .git.
            yield from sorted(file for file in found if not any(p[0] == "." for p in file.relative_to(path).parts))
        else:
            yield path


def _write(path: Path, text: str) -> bool:
    try:
        path.write_bytes(text.encode("utf-8"))
    except OSError as error:
        sys.stderr.write(f"onto fmt: cannot write `{path}`: {error.strerror}\n")
        return False
    return True


FMT = Command(
    name="fmt",
    help="Lay out Turtle and BDDL files in the one canonical way, comments included.",
    example="onto fmt --check ontology/ tasks/",
    configure=_configure,
    run=_run,
)
