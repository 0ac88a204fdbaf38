"""One name as each kind of term writes it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.util import find_spec
from keyword import iskeyword

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


def read_name(given: str, *, module: bool = False) -> WordedName:
    """A name from what a person gives: ``served_on``, ``ServedOn``, ``served-on`` and ``"served on"`` are the same.

    Raises:
        OntoError: NEW001 if it holds other characters or starts with a digit, or cannot be the name of a Python
            ``module``; NEW002 if an installed module has that name.

    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(?:[ _-]+[A-Za-z0-9]+)*", given):
        raise OntoError.of(
            "NEW001",
            f"`{given}` cannot become the name of a term",
            "write words of ASCII letters and digits, joined by `_`, the first one starting with a letter",
        )
    name = WordedName(tuple(word.lower() for word in _WORD.findall(given)))
    if module and iskeyword(name.snake):
        raise OntoError.of(
            "NEW001", f"`{name.snake}` is a word of Python and cannot name a module", "choose another name"
        )
    if module and (found := find_spec(name.snake)) is not None and found.origin is not None:
        message = f"a module `{name.snake}` is installed already, and one of the two would hide the other"
        raise OntoError.of("NEW002", message, "choose another name")
    return name
