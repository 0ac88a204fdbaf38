"""A Turtle file in the canonical layout: the same triples in the same order, and the same comments.

Prefixes come first and sorted, ``rdf:type`` becomes ``a``, and the rest is a matter of lines and spaces: strings,
numbers and names stay as they are written. Line ends stay those of the file; a byte order mark goes.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Final

from pyoxigraph import BlankNode, Quad, Store, Triple

from onto_compiler.problems import OntoError, Problem
from onto_compiler.sources import read_into
from onto_compiler.terms import Term
from onto_compiler.turtle.printer import print_document
from onto_compiler.turtle.remarks import END, Remark
from onto_compiler.turtle.tokens import SourceText, Token
from onto_compiler.turtle.tree import VERSION, Directive, Item, TurtleDocument, Unknown, read_document

__all__ = ["format_turtle", "read_turtle"]

_LINE_END: Final = re.compile(r"\r\n|\n|\r")
_ABSOLUTE: Final = re.compile(r"<[A-Za-z][A-Za-z0-9+.-]*:")


def read_turtle(path: Path) -> str:
    """The text of a file, its byte order mark included.

    Raises:
        OntoError: TTL002, the file cannot be read or is not UTF-8.

    """
    try:
        return path.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise OntoError(*read_into(Store(), path)) from error


def format_turtle(text: str, path: Path) -> str:
    """``text``, the content of ``path``, as it should be laid out.

    Raises:
        OntoError: TTL0nn, ``text`` is not Turtle; FMT001, its layout would not read as the same triples.

    """
    before = _read(path, text)
    text = text.removeprefix("\ufeff")
    try:
        document = read_document(text)
    except Unknown as error:
        raise OntoError(_unknown(path, text, error.token)) from error
    first = _LINE_END.search(text)
    end = "\r\n" if first is not None and first[0] == "\r\n" else "\n"
    printed = "".join(line + end for line in print_document(_sorted(document)))
    if _anonymous(_read(path, printed)) != _anonymous(before):
        raise OntoError(_unknown(path, text, Token(END, "", 0, 0)))
    return printed


def _read(path: Path, text: str) -> list[Quad]:
    written: list[Quad] = []
    problems = read_into(Store(), path.resolve(), text, written)
    if problems:
        raise OntoError(*(replace(problem, file=str(path)) for problem in problems))
    return written


def _anonymous(quads: Iterable[Quad]) -> Counter[tuple[str, ...]]:
    """Statements without the names of blank nodes, which differ at each reading; their order is the reader's own."""
    return Counter(tuple(map(_nameless, (one.subject, one.predicate, one.object))) for one in quads)


def _nameless(term: Term) -> str:
    if isinstance(term, Triple):
        return f"<<( {' '.join(map(_nameless, (term.subject, term.predicate, term.object)))} )>>"
    return "" if isinstance(term, BlankNode) else str(term)


def _unknown(path: Path, text: str, token: Token) -> Problem:
    span = SourceText(str(path), text).span(token.start, token.end)
    message = "this file holds what `onto fmt` cannot lay out without changing it"
    if token.text:
        message = f"`onto fmt` does not know `{token.text}` here"
    return Problem.at(span, "FMT001", message, "leave this file out, or write what is here in another way")


def _sorted(document: TurtleDocument) -> TurtleDocument:
    """Version, base and prefixes before everything else, each once and by name, where that changes no meaning."""
    statements = document.statements
    directives = [item for item in statements if isinstance(item.body, Directive)]
    if not directives or not _movable(statements):
        return document
    header: list[Remark] = []
    if statements[0] is directives[0]:
        header, directives[0].above = directives[0].above, []
    kept: dict[Directive, Item] = {}
    for item in directives:
        body = item.body
        if isinstance(body, Directive) and (known := kept.setdefault(body, item)) is not item:
            known.above += [*item.above, *([Remark(item.beside)] if item.beside else [])]
    below: list[Item] = []
    apart = False
    for item in statements:
        if isinstance(item.body, Directive):
            apart = apart or item.apart
        else:
            _set_off(item, apart=apart or not below)
            below.append(item)
            apart = False
    above = [kept[body] for body in sorted(kept, key=lambda body: (body.name != VERSION, body.name != "", body.name))]
    separate = directives[0].apart
    for item in above:
        item.apart = False
        item.above = [Remark(remark.text) for remark in item.above]
    above[0].above = [*header, *above[0].above]
    if header:
        _separate(above[0], len(header), apart=separate)
    return TurtleDocument([*above, *below], document.below)


def _separate(item: Item, header: int, *, apart: bool) -> None:
    """A blank line between the file's header and what comes after it, where there was one."""
    if header < len(item.above):
        item.above[header] = Remark(item.above[header].text, apart=apart)
    else:
        item.apart = apart


def _set_off(item: Item, *, apart: bool) -> None:
    """Put a blank line before an item and its comments."""
    if apart and item.above:
        item.above[0] = Remark(item.above[0].text, apart=True)
    elif apart:
        item.apart = True


def _movable(statements: list[Item]) -> bool:
    """Whether the directives mean the same at the top: no name has two IRIs, and no IRI depends on their order."""
    bodies = [item.body for item in statements]
    prefixes = {body for body in bodies if isinstance(body, Directive) and body.name}
    if len({body.name for body in prefixes}) < len(prefixes):
        return False
    bases = [index for index, body in enumerate(bodies) if isinstance(body, Directive) and not body.name]
    if not bases:
        return True
    early = bodies[: bases[0]]
    return len(bases) == 1 and all(
        isinstance(body, Directive) and (body.name == VERSION or _ABSOLUTE.match(body.iri) is not None)
        for body in early
    )
