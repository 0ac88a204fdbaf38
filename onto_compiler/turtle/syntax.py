"""Oxigraph's syntax errors in plain words: what was found, what was expected, and where the mistake really is."""

from __future__ import annotations

import re
from pathlib import Path

from onto_compiler.problems import Problem, Span, clipped, near
from onto_compiler.rdf import PREFIXES
from onto_compiler.turtle.tokens import SourceText, Token, tokens

__all__ = ["syntax_problem"]

_PLACE = re.compile(r"line (\d+) column (\d+)|line (\d+) between columns (\d+)")
_PREFIX = re.compile(r"The prefix (.*): has not been declared")
_INVALID = re.compile(r"(?s)(.*) is not a valid (RDF object|predicate|subject or graph name)")
_CODE_POINT = re.compile(r"(?s)Invalid IRI code point '(.*)'")
_EXPECTED = {"RDF object": "an object", "predicate": "a predicate", "subject or graph name": "a subject"}
_PAIRS = {"[": "]", "(": ")"}


def syntax_problem(path: Path, error: SyntaxError, text: str | None = None) -> Problem:
    """The fault that stopped Oxigraph in ``path``, as the narrowest code that fits (TTL001 if none does)."""
    text = path.read_bytes().decode("utf-8", errors="replace") if text is None else text
    source = SourceText(str(path), text.removeprefix("\ufeff"))
    message = re.sub(r"^Parser error (at|between) line .*?: ", "", str(error.msg or error))
    line, column = error.lineno or 0, error.offset or 0
    if not line and (place := _PLACE.search(str(error))):
        line, column = int(place[1] or place[3]), int(place[2] or place[4])
    offset = source.offset(line, column)
    read: list[Token] = []
    found: Token | None = None
    for token in tokens(source.text):
        read.append(token)
        if token.end > offset:
            found = token
            break
    before = [token for token in read if token.end <= offset]
    return (
        _unterminated(source, read, offset)
        or _prefix(source, message, offset)
        or _bracket(source, before, found)
        or _end(source, message, before, found)
        or _invalid(source, message, before, offset)
        or _iri(source, message, offset)
        or _problem(source, offset, "TTL001", f"not Turtle: {_sentence(message)}", "see `onto explain TTL001`")
    )


def _problem(source: SourceText, offset: int, code: str, message: str, hint: str) -> Problem:
    span: Span = source.span(offset, offset + 1)
    return Problem.at(span, code, message, hint)


def _unterminated(source: SourceText, read: list[Token], offset: int) -> Problem | None:
    opened = next((token for token in read if token.kind == "unterminated" and token.start <= offset), None)
    if opened is None:
        return None
    hint = f"close it with {opened.text}"
    if len(opened.text) == 1:
        hint += ', or write """ around a text of several lines'
    return _problem(source, opened.start, "TTL004", "the string that opens here is never closed", hint)


def _prefix(source: SourceText, message: str, offset: int) -> Problem | None:
    match = _PREFIX.search(message)
    if match is None:
        return None
    name = match[1]
    declared = re.findall(r"(?im)^\s*@?prefix\s+([\w.-]*):", source.text)
    if name in PREFIXES:
        hint = f"add `@prefix {name}: <{PREFIXES[name]}> .`"
    else:
        hint = near(name + ":", [f"{known}:" for known in (*declared, *PREFIXES)]) or "declare it with `@prefix`"
    return _problem(source, offset, "TTL003", f"the prefix `{clipped(name)}:` is not declared", hint)


def _bracket(source: SourceText, before: list[Token], found: Token | None) -> Problem | None:
    """A ``.`` or the end of the file inside ``[`` or ``(``: the mistake is at the bracket."""
    if found is not None and found.text != ".":
        return None
    opened: list[Token] = []
    for token in before:
        if token.kind == "mark" and token.text in _PAIRS:
            opened.append(token)
        elif token.kind == "mark" and token.text in _PAIRS.values() and opened:
            opened.pop()
        elif token.kind == "mark" and token.text == ".":
            opened.clear()
    if not opened:
        return None
    bracket = opened[-1]
    closing = _PAIRS[bracket.text]
    return _problem(
        source,
        bracket.start,
        "TTL006",
        f"the `{bracket.text}` that opens here is never closed",
        f"close it with `{closing}`",
    )


def _end(source: SourceText, message: str, before: list[Token], found: Token | None) -> Problem | None:
    """A statement without its dot: the mistake is behind the last token that still belongs to it."""
    if not before or not (message.startswith("A dot is expected") or (found is None and before[-1].text != ".")):
        return None
    hint = "end the statement with `.`"
    if found is not None:
        hint += f", or put `;` here if `{clipped(found.text)}` goes on describing the same subject"
    return _problem(source, before[-1].end, "TTL005", "the statement that ends here has no `.`", hint)


def _invalid(source: SourceText, message: str, before: list[Token], offset: int) -> Problem | None:
    match = _INVALID.fullmatch(message)
    if match is None:
        return None
    what = _EXPECTED[match[2]]
    hint = f"write {what} here"
    if what == "a predicate" and match[1] != "." and len(before) > 1 and before[-2].text == ".":
        line = source.span(before[-2].start, before[-2].end).line
        hint = f"does line {line} end with `.` where `;` is meant?"
    elif what == "an object" and before and before[-1].text == ",":
        hint = "remove the `,` before, or write another object"
    elif what == "an object" and before and before[-1].text == ";":
        hint = "remove one `;`, or write a predicate"
    shown = clipped(" ".join(match[1].split()))
    return _problem(source, offset, "TTL001", f"not Turtle: expected {what}, found `{shown}`", hint)


def _iri(source: SourceText, message: str, offset: int) -> Problem | None:
    match = _CODE_POINT.search(message)
    if match is None:
        return None
    held = {" ": "a space", "\n": "a line end", "\r": "a line end"}.get(match[1], f"`{match[1]}`")
    hint = "close it with `>`, or write the character as %20, %3C and the like"
    return _problem(source, offset, "TTL001", f"not Turtle: the IRI that begins here cannot hold {held}", hint)


def _sentence(message: str) -> str:
    text = clipped(" ".join(message.split()), 200)
    return text[:1].lower() + text[1:]
