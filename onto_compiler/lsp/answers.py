"""The answers of the language server, independent of the protocol's types. Lines and columns count from 1."""

from __future__ import annotations

from dataclasses import dataclass

from onto_compiler.problems import Span

__all__ = ["Completion", "Hover"]


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
