"""How deep a Turtle file may nest, and how long a literal may be: what no person writes is refused."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Final

from onto_compiler.problems import Problem
from onto_compiler.turtle.tokens import SourceText, Token, tokens, unescape

__all__ = ["MAX_DEPTH", "MAX_LITERAL", "literal_problem", "nesting_problem"]

MAX_DEPTH: Final = 100
"""The most brackets within each other; the passes that follow them call themselves for each."""
MAX_LITERAL: Final = 1024 * 1024
"""The most characters of a literal."""


def nesting_problem(path: Path, text: str) -> Problem | None:
    """A problem at the first bracket of ``text`` that is nested deeper than MAX_DEPTH."""
    # A glance that also counts what strings and comments hold; tokens are read only where it finds something.
    if _deepest(match[0] for match in re.finditer(r"[\[\]()]", text)) is None:
        return None
    brackets = [token for token in tokens(text) if token.kind == "mark" and token.text in "[]()"]
    place = _deepest(token.text for token in brackets)
    if place is None:
        return None
    message = f"brackets are nested more than {MAX_DEPTH} deep"
    return _problem(path, text, brackets[place], message, "give the inner nodes names, and describe them on their own")


def literal_problem(path: Path, text: str) -> Problem | None:
    """A problem at the first string of ``text`` that is longer than MAX_LITERAL."""
    long = (token for token in tokens(text) if token.kind == "string" and _length(token) > MAX_LITERAL)
    token = next(long, None)
    if token is None:
        return None
    message = f"a literal of {_length(token):,} characters; at most {MAX_LITERAL:,} are read"
    return _problem(path, text, token, message, "keep it in a file of its own, and name that file")


def _length(token: Token) -> int:
    """How many characters the value of a quoted token has."""
    raw = token.text
    return len(unescape(raw)) - 2 * (3 if raw[:3] in {'"""', "'''"} and len(raw) >= 6 else 1)


def _deepest(brackets: Iterable[str]) -> int | None:
    """Which of ``brackets`` is the first that is too deep."""
    depth = 0
    for place, bracket in enumerate(brackets):
        depth = depth + 1 if bracket in "[(" else max(depth - 1, 0)
        if depth > MAX_DEPTH:
            return place
    return None


def _problem(path: Path, text: str, token: Token, message: str, hint: str) -> Problem:
    return Problem.at(SourceText(str(path), text).span(token.start, token.end), "TTL009", message, hint)
