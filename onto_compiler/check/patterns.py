"""The triple patterns of a CONSTRUCT query, with the place of each name; enough to see what a rule reads and writes.

No SPARQL parser: Oxigraph has accepted the text before it comes here. Filters, binds and value lists are passed over.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from onto_compiler.rdf import RDF
from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["Construct", "Name", "Step", "read_construct"]

_PASSED_OVER = {"FILTER", "BIND", "VALUES", "HAVING"}
_TERMS = {"iri", "name", "variable", "blank", "string", "number"}
_CLOSING = {"(": ")", "{": "}", "[": "]"}


@dataclass(frozen=True, slots=True)
class Name:
    """An IRI as written in a query."""

    iri: str
    token: Token


@dataclass(frozen=True, slots=True)
class Step:
    """``subject predicate object``; a variable is written without ``?`` or ``$``."""

    subject: str
    predicate: Name
    object: str
    at_object: Token


@dataclass(frozen=True, slots=True)
class Construct:
    """What a rule writes (its template) and reads (its pattern), and every IRI that it names."""

    writes: tuple[Step, ...]
    reads: tuple[Step, ...]
    names: tuple[Name, ...]
    undeclared: tuple[Token, ...]  # names whose prefix nobody declared


def read_construct(text: str, prefixes: Mapping[str, str]) -> Construct:
    """Read ``text``; ``prefixes`` are those that the rule's ``sh:prefixes`` declares, to which the text may add."""
    read = list(tokens(text))
    known = dict(prefixes)
    for keyword, name, iri in zip(read, read[1:], read[2:], strict=False):
        if keyword.text.upper() == "PREFIX" and name.kind == "name" and iri.kind == "iri":
            known[name.text[:-1]] = iri.text[1:-1]
    body = next((at for at, token in enumerate(read) if token.text.upper() in {"CONSTRUCT", "SELECT", "ASK"}), 0)
    opening = next((at for at, token in enumerate(read) if at >= body and token.text == "{"), len(read))
    closing = _closing(read, opening)
    reader = _Reader(known)
    return Construct(
        writes=tuple(reader.steps(read[opening + 1 : closing])),
        reads=tuple(reader.steps(read[closing + 1 :])),
        names=tuple(_names(read[body:], known)),
        undeclared=tuple(
            token for token in read[body:] if token.kind == "name" and token.text.partition(":")[0] not in known
        ),
    )


def _names(read: list[Token], known: Mapping[str, str]) -> Iterator[Name]:
    for token in read:
        if (iri := _iri(token, known)) is not None:
            yield Name(iri, token)


def _iri(token: Token, known: Mapping[str, str]) -> str | None:
    if token.kind == "iri":
        return token.text[1:-1]
    if token.kind == "word" and token.text == "a":
        return RDF + "type"
    prefix, colon, local = token.text.partition(":")
    return known[prefix] + local if token.kind == "name" and colon and prefix in known else None


def _closing(read: list[Token], opening: int) -> int:
    """The index of the bracket that closes the one at ``opening``."""
    depth = 0
    for at in range(opening, len(read)):
        if read[at].kind == "mark":
            depth += (read[at].text in _CLOSING) - (read[at].text in _CLOSING.values())
            if depth == 0:
                return at
    return len(read)


@dataclass(slots=True)
class _Reader:
    known: Mapping[str, str]
    fresh: int = 0

    def steps(self, read: list[Token]) -> Iterator[Step]:
        at = 0
        subject: Token | None = None
        while at < len(read):
            token = read[at]
            if token.text.upper() in _PASSED_OVER and token.kind == "word":
                at = self._pass_over(read, at + 1)
            elif token.kind in _TERMS and subject is None:
                subject, at = token, at + 1
            elif subject is not None and self._opens_path(token):
                path, at = self._path(read, at)
                while at < len(read) and read[at].kind in _TERMS | {"word"}:
                    yield from self._expand(subject, path, read[at])
                    at += 1
                    if at >= len(read) or read[at].text != ",":
                        break
                    at += 1
                if at < len(read) and read[at].text == ";":
                    at += 1
                else:
                    subject = None
            else:
                subject, at = None, at + 1

    @staticmethod
    def _pass_over(read: list[Token], at: int) -> int:
        """Behind ``(...)``; behind ``?x {...}``; at the ``{`` of an EXISTS, whose patterns are read as any other."""
        while at < len(read) and read[at].kind in {"word", "variable"}:
            if read[at].text.upper() == "EXISTS":
                return at + 1
            at += 1
        if at < len(read) and read[at].text in _CLOSING:
            at = _closing(read, at) + 1
            if at < len(read) and read[at].text == "{" and read[at - 1].text == ")":
                at = _closing(read, at) + 1
        return at

    def _opens_path(self, token: Token) -> bool:
        return _iri(token, self.known) is not None or token.kind == "variable" or token.text in {"^", "!", "("}

    def _path(self, read: list[Token], at: int) -> tuple[list[Token], int]:
        """The names of a property path in the order written, and the index behind it."""
        names: list[Token] = []
        while at < len(read):
            if read[at].text == "(":
                end = _closing(read, at)
                names += [token for token in read[at:end] if _iri(token, self.known) is not None]
                at = end + 1
            elif read[at].text in {"^", "!"}:
                at += 1
                continue
            else:
                names.append(read[at])
                at += 1
            while at < len(read) and read[at].kind == "mark" and read[at].text in {"*", "+", "?"}:
                at += 1
            if at < len(read) and read[at].text in {"/", "|"}:
                at += 1
                continue
            break
        return names, at

    def _expand(self, subject: Token, path: list[Token], object_: Token) -> Iterator[Step]:
        node = _node(subject, self.known)
        for place, token in enumerate(path):
            iri = _iri(token, self.known)
            if place == len(path) - 1:
                reached = _node(object_, self.known)
            else:
                self.fresh += 1
                reached = f" {self.fresh}"
            if iri is not None:
                yield Step(node, Name(iri, token), reached, object_)
            node = reached


def _node(token: Token, known: Mapping[str, str]) -> str:
    return _iri(token, known) or token.text.lstrip("?$")
