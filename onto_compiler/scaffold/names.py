"""One name as each kind of term writes it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from onto_compiler.problems import OntoError

__all__ = ["WordedName", "read_name"]

_WORD = re.compile(r"[A-Z]?[a-z0-9]+|[A-Z]+(?![a-z])")


@dataclass(frozen=True, slots=True)
class WordedName:
    """The words of a name, in lower case."""

    words: tuple[str, ...]

    @property
    def snake(self) -> str:
        """As individuals and files are written: ``served_on``."""
        return "_".join(self.words)

    @property
    def camel(self) -> str:
        """As classes are written: ``ServedOn``."""
        return "".join(word.capitalize() for word in self.words)

    @property
    def text(self) -> str:
        """As labels are written: ``served on``."""
        return " ".join(self.words)


def read_name(given: str) -> WordedName:
    """A name from what a person gives: ``served_on``, ``ServedOn``, ``served-on`` and ``"served on"`` are the same.

    Raises:
        OntoError: NEW001 if it holds other characters or starts with a digit.

    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(?:[ _-]+[A-Za-z0-9]+)*", given):
        raise OntoError.of(
            "NEW001",
            f"`{given}` cannot become the name of a term",
            "write words of ASCII letters and digits, joined by `_`, the first one starting with a letter",
        )
    return WordedName(tuple(word.lower() for word in _WORD.findall(given)))
