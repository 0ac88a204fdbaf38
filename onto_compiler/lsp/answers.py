"""The answers of the language server, independent of the protocol's types.

Lines and columns of spans count from 1; ``start`` and ``end`` are offsets into a text.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from onto_compiler.problems import Span

__all__ = ["Change", "Colour", "Completion", "Hover", "Place", "RefusedError", "Symbol"]


class RefusedError(Exception):
    """What was asked for is not done; the message is a sentence for the user."""


@dataclass(frozen=True, slots=True)
class Completion:
    """A completion: ``text`` takes the place of what stands between ``start`` and the cursor (offsets)."""

    text: str
    start: int
    detail: str = ""
    about: str = ""
    kind: str = "name"  # "class" | "property" | "predicate" | "name" | "prefix"


@dataclass(frozen=True, slots=True)
class Hover:
    """The documentation of the word at ``span``, in Markdown."""

    markdown: str
    span: Span


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """The characters of a file from ``start`` up to ``end``."""

    file: Path
    start: int
    end: int


@dataclass(frozen=True, slots=True, order=True)
class Change:
    """Put ``text`` in the place of the characters of a file from ``start`` up to ``end``."""

    file: Path
    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True)
class Symbol:
    """Something that a file declares, from ``start`` up to ``end``; its name stands at ``name_start``."""

    name: str
    kind: str  # "ontology" | "class" | "property" | "shape" | "individual" | "section" | "object" | "region" | "fact"
    detail: str
    start: int
    end: int
    name_start: int
    name_end: int
    deprecated: bool = False
    children: tuple[Symbol, ...] = field(default=())


@dataclass(frozen=True, slots=True, order=True)
class Colour:
    """What the characters from ``start`` up to ``end`` are: ``kind`` is a token type of the protocol."""

    start: int
    end: int
    kind: str
    declares: bool = False
