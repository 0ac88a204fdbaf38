"""Tokens of a Turtle file with what stands between them: comments, blank lines and line ends."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["END", "Lexeme", "Remark", "lexemes"]

END: Final = "end"
"""The kind of the token behind the last one."""
_COMMENT: Final = re.compile(r"#[^\n\r]*")
_MARKS: Final = frozenset(("<<(", ")>>", "<<", ">>", "{|", "|}"))
_DIRECTED: Final = re.compile(r"@[A-Za-z0-9-]+--(?:ltr|rtl)")
_LINE_END: Final = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class Remark:
    """A comment: ``beside`` a token that ends on its line, or on a line of its own, ``apart`` below a blank line."""

    text: str
    beside: bool = False
    apart: bool = False


@dataclass(slots=True)
class Lexeme:
    """A token, and what stands before it: ``broken`` says that a line ends there, ``apart`` that a blank one does."""

    token: Token
    before: list[Remark] = field(default_factory=list)
    broken: bool = False
    apart: bool = False


def lexemes(text: str) -> Iterator[Lexeme]:
    """Every token of ``text``, and at last one of kind ``END`` that holds the comments behind them."""
    at = 0
    for token in _joined(list(tokens(text))):
        yield _lexeme(token, text[at : token.start], first=at == 0)
        at = token.end
    yield _lexeme(Token(END, "", len(text), len(text)), text[at:], first=at == 0)


def _joined(parts: Sequence[Token]) -> Iterator[Token]:
    """The tokens that RDF 1.2 adds, of which :func:`tokens` gives the parts: marks, and a language's direction."""
    at = 0
    while at < len(parts):
        first, size = parts[at], 1
        if first.kind in {"mark", "at"}:
            size = next((size for size in (4, 3, 2) if _is_one(parts[at : at + size], size)), 1)
        last = parts[at + size - 1]
        yield Token(first.kind, "".join(part.text for part in parts[at : at + size]), first.start, last.end)
        at += size


def _is_one(parts: Sequence[Token], size: int) -> bool:
    text = "".join(part.text for part in parts)
    whole = len(parts) == size and parts[-1].end - parts[0].start == len(text)
    return whole and (text in _MARKS or _DIRECTED.fullmatch(text) is not None)


def _lexeme(token: Token, gap: str, *, first: bool) -> Lexeme:
    """``gap`` holds nothing but space and comments."""
    before: list[Remark] = []
    at = 0
    for comment in _COMMENT.finditer(gap):
        ends = _line_ends(gap[at : comment.start()])
        before.append(Remark(comment[0].rstrip(), beside=not first and at == 0 and not ends, apart=ends > 1))
        at = comment.end()
    return Lexeme(token, before, broken=_line_ends(gap) > 0, apart=_line_ends(gap[at:]) > 1)


def _line_ends(space: str) -> int:
    return len(_LINE_END.findall(space))
