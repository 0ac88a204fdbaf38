"""Numbers with singular and plural nouns."""

from __future__ import annotations

__all__ = ["counted", "plural"]


def plural(number: int, noun: str, several: str = "") -> str:
    """``noun`` for one thing, and otherwise ``several``, or ``noun`` with an s where that is not given."""
    return noun if number == 1 else several or f"{noun}s"


def counted(number: int, noun: str, several: str = "") -> str:
    """``1 task``, ``2 tasks``, ``1,200 tasks``; ``several`` is a plural that is irregular."""
    return f"{number:,} {plural(number, noun, several)}"
