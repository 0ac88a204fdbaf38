"""``# onto: ignore[DOC004]`` in a Turtle file: on a line, or above a statement for all of its lines."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from onto_compiler.problems import Problem, near
from onto_compiler.turtle.tokens import SourceText, tokens

__all__ = ["Suppression", "suppressions", "unsuppressed"]

_SUPPRESSION = re.compile(r"#[ \t]*onto:[ \t]*ignore\b[ \t]*(?:\[([^\]\n\r]*)\])?")
_COMMENT = re.compile(r"#[^\n\r]*")
_OPENING, _CLOSING = frozenset("[({"), frozenset("])}")


@dataclass(frozen=True, slots=True)
class Suppression:
    """The ``codes`` (or how they begin) that are not reported of the lines from ``first`` to ``last``."""

    codes: tuple[str, ...]
    first: int
    last: int
    start: int  # offsets of the comment
    end: int

    def covers(self, problem: Problem) -> bool:
        """Whether a problem of the same file is meant."""
        return self.first <= problem.line <= self.last and bool(self.codes) and problem.code.startswith(self.codes)


def suppressions(source: SourceText) -> Iterator[Suppression]:
    """Every suppression among the comments of a text; what stands in a string is none."""
    text = source.text
    if _SUPPRESSION.search(text) is None:
        return
    read = list(tokens(text))
    ends = _statements([token.text if token.kind == "mark" else "" for token in read])
    at = 0
    for index in range(len(read) + 1):
        gap_end = read[index].start if index < len(read) else len(text)
        for comment in _COMMENT.finditer(text, at, gap_end):
            match = _SUPPRESSION.match(comment[0])
            if match is None:
                continue
            first = last = _line(source, comment.start())
            beside = index > 0 and _line(source, read[index - 1].end) == first
            if not beside and index < len(read):
                begins = index == 0 or ends[index - 1] == index - 1
                first = _line(source, read[index].start)
                last = _line(source, read[ends[index]].end) if begins else first
            codes = tuple(code.strip().upper() for code in (match[1] or "").split(",") if code.strip())
            yield Suppression(codes, first, last, comment.start(), comment.start() + match.end())
        at = read[index].end if index < len(read) else gap_end


def _line(source: SourceText, offset: int) -> int:
    return source.span(offset, offset).line


def _statements(marks: list[str]) -> list[int]:
    """For each token the index of the dot that ends its statement; ``marks`` holds the text of marks alone."""
    ends, depth, begin = [len(marks) - 1] * len(marks), 0, 0
    for index, mark in enumerate(marks):
        depth += (mark in _OPENING) - (mark in _CLOSING) if mark else 0
        if mark == "." and depth == 0:
            ends[begin : index + 1] = [index] * (index + 1 - begin)
            begin = index + 1
    return ends


def unsuppressed(
    file: str, text: str, problems: Iterable[Problem], reports: Callable[[str], bool]
) -> Iterator[Problem]:
    """The ``problems`` of a file that are left, and CFG002 for each suppression without effect.

    ``reports`` says whether problems of a code are reported at all.
    """
    source = SourceText(file, text)
    found = list(suppressions(source))
    if not found:
        yield from problems
        return
    used: set[tuple[Suppression, str]] = set()
    for problem in problems:
        covering = [one for one in found if one.covers(problem)]
        used.update((one, code) for one in covering for code in one.codes if problem.code.startswith(code))
        if not covering:
            yield problem
    from onto_compiler.check.pages import codes as known  # noqa: PLC0415 - few files suppress anything

    codes = known()
    for one in found:
        span = source.span(one.start, one.end)
        if not one.codes:
            message = "this comment names no code, and suppresses nothing"
            yield Problem.at(span, "CFG002", message, "write `# onto: ignore[DOC004]`, or remove it", "warning")
        for code in one.codes:
            if not any(each.startswith(code) for each in codes):
                hint = near(code, codes) or "`onto explain` knows all codes"
                yield Problem.at(span, "CFG002", f"`{code}` is no code of a problem", hint, "warning")
            elif (one, code) not in used and reports(code):
                message = f"nothing here is reported as {code}, and nothing suppressed"
                yield Problem.at(span, "CFG002", message, "remove the comment, or the code from it", "warning")
