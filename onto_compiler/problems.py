"""Problems of an input: what is wrong, where, and what to do about it.

Every fault that a user can cause becomes a :class:`Problem`; code that cannot go on raises :class:`OntoError`, which
the command line prints without a traceback.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

__all__ = ["OntoError", "Problem", "Span", "clipped", "near", "render", "render_all"]

_WIDTH = 75
"""Characters of a source line that are shown: 80 columns without the margin."""
_BEFORE = 45
"""How many of them stand before the caret."""


@dataclass(frozen=True, slots=True, order=True)
class Span:
    """A place in a file; lines and columns count from 1, the end is exclusive."""

    file: str
    line: int = 0
    column: int = 0
    end_line: int = 0
    end_column: int = 0


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """One fault: ``code`` names its page in ``docs/errors``; line and column are 0 where a file as a whole is meant."""

    file: str
    line: int
    column: int
    code: str
    severity: str  # "error" | "warning" | "info": what is worth knowing and never fails a check
    message: str
    hint: str = ""
    end_line: int = 0  # the end is exclusive; 0 where only the start is known
    end_column: int = 0
    result: Mapping[str, Any] | None = field(default=None, compare=False, repr=False)  # of SHACL, as JSON has it

    @classmethod
    def at(cls, span: Span, code: str, message: str, hint: str = "", severity: str = "error") -> Problem:
        """Build a problem at ``span``."""
        return cls(span.file, span.line, span.column, code, severity, message, hint, span.end_line, span.end_column)

    def as_dict(self) -> dict[str, Any]:
        """The record that ``--format json`` prints."""
        names = ("code", "severity", "file", "line", "column", "message", "hint")
        record = {name: getattr(self, name) for name in names}
        return record if self.result is None else record | {"result": dict(self.result)}


class OntoError(Exception):
    """A fault in what the user gave; carries every problem that was found, in file order.

    Given another error, it carries that one's problems: Gymnasium raises a worker's as ``type(error)(error)``.
    """

    def __init__(self, *problems: Problem | OntoError) -> None:
        parts = [part.problems if isinstance(part, OntoError) else (part,) for part in problems]
        self.problems: tuple[Problem, ...] = tuple(sorted(problem for part in parts for problem in part))
        super().__init__("\n".join(f"{p.code}: {p.message}" for p in self.problems))

    @classmethod
    def of(cls, code: str, message: str, hint: str = "", file: str = "") -> OntoError:
        """An error with a single problem that has no line of its own."""
        return cls(Problem(file, 0, 0, code, "error", message, hint))

    def __reduce__(self) -> tuple[type[OntoError], tuple[Problem, ...]]:
        """Pickle by problems, so that a worker process can raise to its parent."""
        return (OntoError, self.problems)


def near(name: str, known: Iterable[str]) -> str:
    """``did you mean `x`?`` for the closest of ``known``, or an empty string."""
    import difflib  # noqa: PLC0415 - few runs need it, and every one imports this module

    match = difflib.get_close_matches(name, list(known), n=1, cutoff=0.6)
    return f"did you mean `{match[0]}`?" if match else ""


def clipped(text: str, length: int = 80) -> str:
    """``text``, without its middle where it is longer than a message should be."""
    return text if len(text) <= length else f"{text[: length // 2]}…{text[-(length // 4) :]}"


def _window(text: str, column: int) -> tuple[str, int]:
    """What of a line fits a terminal of 80 columns, and the ``column`` (from 1) of the same character in it."""
    if len(text) <= _WIDTH:
        return text, column
    start = min(max(column - 1 - _BEFORE, 0), len(text) - _WIDTH)
    shown = text[start : start + _WIDTH]
    if start:
        shown = f"…{shown[1:]}"
    if start + _WIDTH < len(text):
        shown = f"{shown[:-1]}…"
    return shown, column - start


@lru_cache(maxsize=1)
def _rows(source: str) -> tuple[str, ...]:
    """The lines of a source, kept for the next problem in it."""
    return tuple(source.splitlines())


def render(problem: Problem, source: str | None = None) -> str:
    """One problem as a compiler prints it: code, place, line with a caret when ``source`` holds it, and the hint."""
    lines = [f"{problem.severity}[{problem.code}]: {problem.message}"]
    if problem.file:
        place = f"{problem.file}:{problem.line}:{problem.column}" if problem.line else problem.file
        lines.append(f"  --> {place}")
    rows = _rows(source) if source else ()
    if 0 < problem.line <= len(rows):
        text, column = _window(rows[problem.line - 1].replace("\t", " "), problem.column)
        lines += [f"   | {text}", f"   | {' ' * max(column - 1, 0)}^"]
    if problem.hint:
        lines.append(f"   = help: {problem.hint}")
    return "\n".join(lines)


def render_all(problems: Iterable[Problem]) -> str:
    """Every problem as :func:`render` prints it, each file that can be read being read once; ends with a line end."""
    found = tuple(problems)
    sources = {file: _source(file) for file in {problem.file for problem in found if problem.line}}
    return "".join(f"{render(problem, sources.get(problem.file))}\n" for problem in found)


def _source(file: str) -> str | None:
    try:
        return Path(file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError):
        return None
