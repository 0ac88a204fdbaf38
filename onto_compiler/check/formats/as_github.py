"""For GitHub: workflow commands, which a job's log turns into annotations of the changed lines.

Source: GitHub's documentation of workflow commands, and the escaping of ``actions/toolkit``, ``packages/core``.
"""

from __future__ import annotations

from onto_compiler.check.formats.checked import Checked
from onto_compiler.problems import Problem

__all__ = ["render"]

_DATA = {"%": "%25", "\r": "%0D", "\n": "%0A"}
_PROPERTY = {**_DATA, ":": "%3A", ",": "%2C"}


def render(checked: Checked) -> str:
    """One ``::error``, ``::warning`` or ``::notice`` line for each problem."""
    return "".join(_line(problem) + "\n" for problem in checked.problems)


def _line(problem: Problem) -> str:
    place = {"file": problem.file, "line": problem.line, "col": problem.column, "title": problem.code}
    properties = ",".join(f"{name}={_escaped(str(value), _PROPERTY)}" for name, value in place.items() if value)
    message = f"{problem.message}\n{problem.hint}" if problem.hint else problem.message
    level = "notice" if problem.severity == "info" else problem.severity
    return f"::{level} {properties}::{_escaped(message, _DATA)}"


def _escaped(text: str, replacements: dict[str, str]) -> str:
    return "".join(replacements.get(character, character) for character in text)
