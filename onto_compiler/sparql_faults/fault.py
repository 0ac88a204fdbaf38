"""A fault of a query, and how it is put in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from onto_compiler.turtle.tokens import Token

__all__ = ["FORMS", "Fault", "fault_at", "listed"]

FORMS = ("SELECT", "ASK", "CONSTRUCT", "DESCRIBE")
"""The words that a query begins with."""


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a query from character ``start`` on, ``length`` characters long; of syntax without a code."""

    message: str
    hint: str = ""
    start: int = 0
    length: int = 1
    code: str = ""


def fault_at(token: Token, message: str, hint: str = "") -> Fault:
    """The fault of a token."""
    return Fault(message, hint, token.start, token.end - token.start)


def listed(words: Iterable[str], conjunction: str) -> str:
    """``a, b or c``."""
    *first, last = words
    return f"{', '.join(first)} {conjunction} {last}" if first else last
