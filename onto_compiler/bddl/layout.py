"""A task file in the canonical layout, with its comments.

Each comment belongs to an item: on its own line to the next one in its section, at a line's end to the one before. It
is printed with that item.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace

from onto_compiler.bddl import codes
from onto_compiler.bddl.groups import Group, groups
from onto_compiler.bddl.parse import parse
from onto_compiler.bddl.printer import Line, layout
from onto_compiler.bddl.sections import KEYWORDS
from onto_compiler.problems import OntoError, Problem

__all__ = ["format_text"]

COMMENT = re.compile(r";[^\n]*")
SECTIONS = frozenset(KEYWORDS.values())


@dataclass(frozen=True, slots=True)
class _Comment:
    """A comment, its place, whether code stands before it on its line, and the section that it is part of."""

    text: str
    line: int
    column: int
    trailing: bool
    section: str  # "start": before the task; ")": after its last section; "end": after it
    within: bool  # inside the section's parentheses


def format_text(text: str, file: str = "<string>") -> str:
    """``text`` as it should be laid out: the same task, and the same comments.

    Raises:
        OntoError: ``text`` is not a well-formed task, or holds something that readers pass over, which would be lost.

    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    spec = parse(text, file)
    if spec.passed_over:
        raise OntoError(*(_ambiguous(problem) for problem in spec.passed_over))
    lines = list(layout(spec))
    before: dict[int, list[str]] = {}
    after: dict[int, str] = {}
    for comment in _comments(text):
        index, trailing = _place(comment, lines)
        if trailing and index not in after:
            after[index] = comment.text
        else:
            before.setdefault(index, []).append(comment.text)
    printed: list[str] = []
    for index, line in enumerate(lines):
        indent = " " * (len(line.text) - len(line.text.lstrip()))
        printed += [f"{indent}{each}" for each in before.get(index, ())]
        printed.append(f"{line.text}  {after[index]}" if index in after else line.text)
    printed += before.get(len(lines), ())
    return "\n".join(printed) + "\n"


def _ambiguous(problem: Problem) -> Problem:
    message = f"{problem.message}, so formatting would drop it"
    return replace(problem, code=codes.PASSED_OVER, severity="error", message=message)


def _comments(text: str) -> list[_Comment]:
    parts = [group for group in groups(text) if group.parent is not None and group.parent.parent is None]
    sections = sorted((group for group in parts if group.head in SECTIONS), key=lambda group: group.start)
    whole = next(group for group in groups(text) if group.parent is None)
    starts = [0, *(match.end() for match in re.finditer("\n", text))]
    found = []
    for match in COMMENT.finditer(text):
        position = match.start()
        row = bisect_right(starts, position) - 1
        trailing = bool(text[starts[row] : position].strip())
        section, within = _section_of(position, sections, whole, trailing=trailing)
        found.append(_Comment(match.group().rstrip(), row + 1, position - starts[row] + 1, trailing, section, within))
    return found


def _section_of(position: int, sections: Sequence[Group], whole: Group, *, trailing: bool) -> tuple[str, bool]:
    """The section that a comment is in, and True; between two, the one that it belongs to, and False."""
    for group in sections:
        if group.start < position < group.end:
            return group.head, True
    if position >= whole.end:
        return "end", False
    earlier = [group.head for group in sections if group.end <= position]
    later = [group.head for group in sections if group.start > position]
    if trailing and earlier:
        return earlier[-1], False
    if position < whole.start:
        return "start", False
    return later[0] if later else ")", False


def _place(comment: _Comment, lines: Sequence[Line]) -> tuple[int, bool]:
    """The printed line that a comment belongs to, and whether it stands at its end."""
    if comment.section in {"start", ")", "end"}:
        return {"start": 0, ")": len(lines) - 1, "end": len(lines)}[comment.section], False
    mine = [index for index, line in enumerate(lines) if line.section == comment.section]
    if not mine:  # an empty section, which is not printed
        return len(lines) - 1, False
    if not comment.within:
        return (mine[-1], True) if comment.trailing else (mine[0], False)
    if len(mine) == 1:
        return mine[0], False
    spots = [(lines[index].at, index) for index in mine]
    places = [((span.line, span.column), index) for span, index in spots if span is not None]
    here = (comment.line, comment.column)
    if comment.trailing:
        return max((item for item in places if item[0] < here), default=((0, 0), mine[0]))[1], True
    return min((item for item in places if item[0] > here), default=((0, 0), mine[-1]))[1], False
