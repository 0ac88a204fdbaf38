"""Turtle (and the inside of a SPARQL query) cut into tokens; nothing is rejected here.

Source: the terminals of RDF 1.1 Turtle, section 6.5, and of SPARQL 1.1, section 19.8. Letters are those of PN_CHARS
and what else Python counts as such; a file that uses the difference has already been rejected by Oxigraph.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple, cast

from onto_compiler.problems import Span

__all__ = ["SourceText", "Token", "position_in_literal", "tokens", "unescape"]

# Every repetition gives nothing back (`*+`), so that no text makes the scanner read it more than a few times.
_MORE = (  # letters of PN_CHARS that are none to Python: combining characters, and places without one
    r"\u00b7\u02c2-\u02df\u02e5-\u02eb\u02ed\u02ef-\u02ff\u0300-\u037d\u037f-\u167f\u1681-\u1fff\u200c\u200d\u203f\u2040"
    r"\u2070-\u218f\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
_ONE_MORE = r"\u00b7"  # stands for them all where the text is ASCII and has none
_LINE_END = re.compile(r"[\n\r]|\Z")
_ESCAPE = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|(.))", re.DOTALL)
_SIMPLE = {"t": "\t", "b": "\b", "n": "\n", "r": "\r", "f": "\f"}


@cache
def _token(more: str) -> re.Pattern[str]:
    """The pattern of a token; ``more`` are the letters beside Python's own. Such large sets take long to compile."""
    local = rf"(?:[\w:\-{more}]|%[0-9A-Fa-f]{{2}}|\\[_~.\-!$&'()*+,;=/?\#@%]|\.++(?=[\w:\-%\\{more}]))*+"
    head = rf"(?:[^\W\d]|[{more}])(?:[\w\-{more}]|\.++(?=[\w\-{more}]))*+"
    blank = rf"_:[\w{more}](?:[\w\-.{more}]*[\w\-{more}])?"
    return re.compile(
        r"""
        (?:\s++|\#[^\n\r]*+)*+(?:
          (?P<iri><(?:[^\x00-\x20<>"{}|^`\\]|\\u[0-9A-Fa-f]{4}|\\U[0-9A-Fa-f]{8})*>)
        | (?P<string>\"{3}(?:\"{0,2}+(?:[^"\\]|\\.))*+\"{3}|'{3}(?:'{0,2}+(?:[^'\\]|\\.))*+'{3}
            |(?!\"{3}|'{3})(?:"(?:[^"\\\n\r]|\\.)*+"|'(?:[^'\\\n\r]|\\.)*+'))
        | (?P<unterminated>\"{3}|'{3}|"|')
        | (?P<at>@[A-Za-z]+(?:-[A-Za-z0-9]+)*)
        | (?P<datatype>\^\^)
        | (?P<blank>"""
        + blank
        + r""")
        | (?P<variable>[?$]\w+)
        | (?P<number>[+-]?(?:\d+\.\d*[eE][+-]?\d+|\.\d+[eE][+-]?\d+|\d+[eE][+-]?\d+|\d*\.\d+|\d+))
        | (?P<name>(?:"""
        + head
        + r")?:"
        + local
        + r""")
        | (?P<word>"""
        + head
        + r""")
        | (?P<mark>.)
        )""",
        re.VERBOSE | re.DOTALL,
    )


class Token(NamedTuple):
    """``kind`` is a group name of the pattern above; ``start`` and ``end`` are offsets, the end exclusive."""

    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class SourceText:
    """A file's text, with the offsets at which its lines begin."""

    file: str
    text: str
    starts: tuple[int, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        starts = (0, *(match.end() for match in re.finditer(r"\r\n|\n|\r", self.text)))
        object.__setattr__(self, "starts", starts)

    def span(self, start: int, end: int) -> Span:
        """The place of the characters from ``start`` up to ``end``."""
        return Span(self.file, *self._place(start), *self._place(end))

    def offset(self, line: int, column: int) -> int:
        """The offset of a place; lines and columns count from 1, and what lies beyond the text is its end."""
        if line > len(self.starts):
            return len(self.text)
        return min(self.starts[max(line, 1) - 1] + max(column, 1) - 1, len(self.text))

    def _place(self, offset: int) -> tuple[int, int]:
        line = bisect_right(self.starts, offset)
        return line, offset - self.starts[line - 1] + 1


def tokens(text: str) -> Iterator[Token]:
    """Every token of ``text`` that is neither space nor a comment."""
    at = 0
    pattern = _token(_ONE_MORE if text.isascii() else _MORE)
    while (match := pattern.match(text, at)) is not None:
        kind = match.lastgroup or "mark"
        start, at = match.span(kind)
        yield Token(kind, match[kind], start, at)
        if kind == "unterminated":
            # What follows on the line is text that was meant to be quoted.
            at = cast("re.Match[str]", _LINE_END.search(text, at)).start()


def unescape(text: str) -> str:
    """Replace Turtle's string and numeric escapes by the characters that they stand for."""
    return _ESCAPE.sub(_unescaped, text) if "\\" in text else text


def position_in_literal(raw: str, index: int) -> int:
    """The offset within ``raw``, a quoted literal as written, of character ``index`` of its value."""
    quote = 3 if raw[:3] in {'"""', "'''"} else 1
    at = quote
    for _ in range(index):
        match = _ESCAPE.match(raw, at)
        at = match.end() if match else at + 1
    return min(at, max(len(raw) - quote, quote))


def _unescaped(match: re.Match[str]) -> str:
    digits = match[1] or match[2]
    return chr(int(digits, 16)) if digits else _SIMPLE.get(match[3], match[3])
