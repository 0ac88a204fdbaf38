"""The parentheses of a task file, read on their own: which group holds what, and which one is not balanced.

A file whose parentheses do not match would send a parser astray far from the mistake, so they are looked at first, with
what BDDL allows inside each kind of group as the guide to the one that was left open.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from onto_compiler.bddl.sections import KEYWORDS, QUANTIFIERS

__all__ = ["MAX_DEPTH", "Group", "groups", "swallowed", "too_deep", "unbalanced"]

TOKEN = re.compile(r";[^\n]*|[()]|[^\s();]+")
MAX_DEPTH = 64
CONNECTIVES = frozenset({"and", "or", "not", "imply"}) | QUANTIFIERS
SECTION_HEADS = frozenset(KEYWORDS.values())
# What the groups inside a group are, where that does not depend on how they begin.
INNER = {
    ":regions": "region",
    ":ranges": "rows",
    ":yaw_rotation": "rows",
    ":rgba": "numbers",
    "rows": "numbers",
    ":init": "atom",
    ":scene_properties": "property",
}
HOLDS_FORMULAS = CONNECTIVES | {":goal"}


@dataclass(frozen=True, slots=True)
class Group:
    """``text[start:end]`` is ``( ... )``. ``kind`` says what it is: ``define``, a section's keyword, ``atom`` ..."""

    start: int
    end: int
    head: str  # the first word in lower case, or an empty string
    kind: str
    parent: Group | None


def groups(text: str) -> tuple[Group, ...]:
    """Every group of a balanced ``text``, an inner one before the one that holds it."""
    found: list[Group] = []
    ends = dict(_pairs(text))
    stack: list[Group] = []
    for start in sorted(ends):
        while stack and stack[-1].end <= start:
            found.append(stack.pop())
        parent = stack[-1] if stack else None
        head = _head(text, start)
        stack.append(Group(start, ends[start] + 1, head, _kind(parent.kind if parent else None, head), parent))
    found.extend(reversed(stack))
    return tuple(found)


def unbalanced(text: str) -> tuple[int, str] | None:
    """Where the first unmatched parenthesis stands, and ``(`` or ``)``; None where all match."""
    depth = 0
    closed_at = -1
    for match in _parentheses(text):
        depth += 1 if match.group() == "(" else -1
        if depth < 0:
            # The one that ended (define ...) too early is the mistake, if anything but `)` follows it.
            rest = text[closed_at + 1 : match.start()]
            return (closed_at if closed_at >= 0 and "(" in rest else match.start()), ")"
        if depth == 0 and closed_at < 0:
            closed_at = match.start()
    return (_left_open(text), "(") if depth else None


def swallowed(text: str, position: int, which: str) -> int | None:
    """Where a comment holds the match that the parenthesis ``which`` at ``position`` lacks; None if none does.

    A comment lacks nothing itself: what it holds in pairs is prose. The match of a ``(`` stands behind it.
    """
    missing = ")" if which == "(" else "("
    for match in TOKEN.finditer(text):
        comment = match.group()
        behind = match.start() > position
        if comment.startswith(";") and behind == (which == "(") and comment.count(missing) > comment.count(which):
            return match.start() + comment.index(missing)
    return None


def too_deep(text: str) -> int | None:
    """Where the first group opens that is nested deeper than MAX_DEPTH, which the recursive passes could not follow."""
    depth = 0
    for match in _parentheses(text):
        depth += 1 if match.group() == "(" else -1
        if depth > MAX_DEPTH:
            return match.start()
    return None


def _left_open(text: str) -> int:
    """The opening parenthesis that most likely lacks its match: the first that holds what it cannot hold."""
    stack: list[tuple[int, str]] = []
    for match in _parentheses(text):
        if match.group() == ")":
            if stack:
                stack.pop()
            continue
        head = _head(text, match.start())
        if stack and not _may_hold(stack[-1][1], head):
            return stack[-1][0]
        stack.append((match.start(), _kind(stack[-1][1] if stack else None, head)))
    return stack[-1][0]


def _may_hold(kind: str, head: str) -> bool:
    """Whether a group of ``kind`` may hold a group that begins with ``head``."""
    if kind == "define":
        return head in SECTION_HEADS
    if kind == "region":
        return head.startswith(":") and head not in SECTION_HEADS
    if kind == ":scene_properties":
        return head not in SECTION_HEADS
    return (kind in INNER or kind in HOLDS_FORMULAS) and not head.startswith(":")


def _kind(parent: str | None, head: str) -> str:
    if parent is None:
        return "define"
    if parent in QUANTIFIERS and (head.startswith("?") or head.isdigit()):
        return "variable" if head.startswith("?") else "count"
    if parent in HOLDS_FORMULAS:
        return head if head in CONNECTIVES else "atom"
    if parent == ":init" and head == "not":
        return head
    return INNER.get(parent, head)


def _pairs(text: str) -> Iterator[tuple[int, int]]:
    stack: list[int] = []
    for match in _parentheses(text):
        if match.group() == "(":
            stack.append(match.start())
        else:
            yield stack.pop(), match.start()


def _parentheses(text: str) -> Iterator[re.Match[str]]:
    return (match for match in TOKEN.finditer(text) if match.group() in {"(", ")"})


def _head(text: str, start: int) -> str:
    """The word after the parenthesis at ``start``, past comments."""
    for match in TOKEN.finditer(text, start + 1):
        if not match.group().startswith(";"):
            return "" if match.group() in {"(", ")"} else match.group().lower()
    return ""
