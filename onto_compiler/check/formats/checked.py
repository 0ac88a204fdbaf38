"""The input of a format: the problems, the checked files, and what counts as a failure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from onto_compiler.problems import Problem, Span

__all__ = ["Checked", "Repair"]


@dataclass(frozen=True, slots=True)
class Repair:
    """The mechanical repair of a problem: ``text`` takes the place of ``span``; ``done`` says it in the past tense."""

    span: Span
    text: str
    done: str


@dataclass(frozen=True)
class Checked:
    """Problems in file order; ``files`` are all that were checked, clean ones included, as they are displayed.

    ``texts`` holds the text of files that are not (or not yet) on disk in this form, and ``repairs`` is what ``--fix``
    would do. ``colour`` is for people at a terminal.
    """

    problems: tuple[Problem, ...]
    files: tuple[str, ...]
    fail_on: str = "error"  # "error" | "warning": the least severity that fails
    texts: dict[str, str] = field(default_factory=dict)
    repairs: Mapping[Problem, Repair] = field(default_factory=dict)
    colour: bool = False

    @cached_property
    def failures(self) -> tuple[Problem, ...]:
        """The problems that make the check fail."""
        return tuple(problem for problem in self.problems if self.fails(problem))

    def fails(self, problem: Problem) -> bool:
        """Whether ``problem`` is severe enough to fail."""
        return problem.severity in {"error", self.fail_on}

    def text(self, file: str) -> str | None:
        """A file's text, read once; None if it cannot be read."""
        if file not in self.texts:
            try:
                self.texts[file] = Path(file).read_text(encoding="utf-8-sig")
            except (OSError, UnicodeDecodeError, ValueError):
                return None
        return self.texts[file]
