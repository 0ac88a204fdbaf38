"""The blocks of a Turtle text and every name in it, its queries included, by tokens alone: the text may be broken.

A text of SPARQL (``*.rq``) is one block without a subject. Names in the strings of ``sh:select`` and its like are
resolved as SHACL resolves them, by the query's own prefixes and those of ``sh:declare``, and by the file's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from urllib.parse import urljoin

from onto_compiler.rdf import OWL, PREFIXES, RDF, SH
from onto_compiler.turtle.tokens import Token, position_in_literal, tokens, unescape

__all__ = ["Block", "Name", "Outline", "outline", "query_outline"]

QUERIES = frozenset(SH + name for name in ("ask", "construct", "select", "update"))
_DIRECTIVES = frozenset(("@PREFIX", "@BASE", "@VERSION", "PREFIX", "BASE", "VERSION"))
_NAMED = frozenset(("iri", "name"))
_ESCAPED = "\\"


@dataclass(frozen=True, slots=True)
class Name:
    """An IRI where it is written, from ``start`` up to ``end``.

    ``role`` is subject, predicate, object, class (what ``a`` or ``^^`` is followed by) or query. ``namespace`` is that
    of its prefix; None where it is written in angle brackets, or as ``a``.
    """

    iri: str
    start: int
    end: int
    role: str
    namespace: str | None = None


@dataclass(slots=True)
class Block:
    """A statement from ``start`` up to ``end``: its subject, and the types that it says the subject has."""

    subject: Name
    written: str
    start: int
    end: int
    types: list[str] = field(default_factory=list)
    deprecated: bool = False


@dataclass(slots=True)
class Outline:
    """``prefixes`` are the namespaces by prefix, ``names`` in the order in which they are written."""

    tokens: list[Token] = field(default_factory=list)
    names: list[Name] = field(default_factory=list)
    blocks: list[Block] = field(default_factory=list)
    prefixes: dict[str, str] = field(default_factory=dict)

    def at(self, offset: int) -> Name | None:
        """The name at ``offset``."""
        return next((name for name in self.names if name.start <= offset <= name.end), None)

    def of(self, iri: str) -> Iterator[Name]:
        """Each place where ``iri`` is written, ``a`` apart."""
        return (name for name in self.names if name.iri == iri and name.end - name.start > 1)


@lru_cache(maxsize=32)
def outline(text: str, base: str) -> Outline:
    """The outline of a Turtle text; relative IRIs are resolved against ``base``."""
    found = Outline(list(tokens(text)))
    _Walk(text, base, found).run()
    return found


@lru_cache(maxsize=32)
def query_outline(text: str) -> Outline:
    """The outline of a SPARQL text: its names; prefixes that it does not declare are the project's."""
    found = Outline(list(tokens(text)))
    found.names += _in_query(text, 0, PREFIXES)
    return found


@dataclass(slots=True)
class _Walk:
    """What is expected next at each depth: a subject, predicate, object, or the end of a statement."""

    text: str
    base: str
    found: Outline
    stack: list[str] = field(default_factory=lambda: ["subject"])
    verbs: list[str] = field(default_factory=lambda: [""])  # the last predicate at each depth
    block: Block | None = None
    queries: list[tuple[Token, str]] = field(default_factory=list)
    declared: dict[str, str] = field(default_factory=dict)  # by sh:declare
    half: dict[str, str] = field(default_factory=dict)
    held: str = "end"  # the state that a datatype interrupts

    def run(self) -> None:
        read = self.found.tokens
        at = 0
        while at < len(read):
            token = read[at]
            if self.begins(token):
                self.close(read[at - 1].end if at else token.start)
                self.stack, self.verbs = ["subject"], [""]
            if self.stack == ["subject"] and token.kind in {"at", "word"} and token.text.upper() in _DIRECTIVES:
                at = self.directive(at)
                continue
            at += self.mark(at) if token.kind == "mark" else self.term(token)
        self.close(read[-1].end if read else 0)
        known = {**PREFIXES, **self.found.prefixes, **self.declared}
        for token, value in self.queries:
            self.found.names += _moved(token, value, known)
        self.found.names.sort(key=lambda name: name.start)

    def begins(self, token: Token) -> bool:
        """Whether a statement begins although the one before did not end: at the start of a line."""
        at_start = token.start == 0 or self.text[token.start - 1] in "\r\n"
        directive = token.kind in {"at", "word"} and token.text.upper() in _DIRECTIVES
        ended = self.stack[-1] == "end" if token.kind in _NAMED else directive and self.stack != ["subject"]
        return at_start and ended

    def close(self, end: int) -> None:
        if self.block is not None:
            self.block.end = end
            self.block = None

    def directive(self, at: int) -> int:
        """The index of the token behind a directive."""
        read = self.found.tokens
        kind = read[at].text.upper().lstrip("@")
        rest = read[at + 1 : at + 3]
        used = 1
        if kind == "PREFIX" and len(rest) == 2 and rest[0].kind == "name" and rest[1].kind == "iri":
            self.found.prefixes[rest[0].text[:-1]] = self.resolve(rest[1])
            used = 3
        elif kind == "BASE" and rest and rest[0].kind == "iri":
            self.base = self.resolve(rest[0])
            used = 2
        elif kind == "VERSION" and rest:
            used = 2
        ends = at + used < len(read) and read[at + used].text == "." and read[at].text.startswith("@")
        return at + used + ends

    def mark(self, at: int) -> int:
        """Take a mark; returns how many tokens it is."""
        read = self.found.tokens
        mark, following = read[at].text, "".join(token.text for token in read[at + 1 : at + 3])
        if mark == "<" and following[:1] == "<":
            self.push("subject")
            return 3 if following == "<(" else 2
        if mark == ")" and following[:2] == ">>":
            self.pop()
            return 3
        if mark == ">" and following[:1] == ">":
            self.pop()
            return 2
        if mark in "[(" or (mark == "{" and following[:1] == "|"):
            self.push("list" if mark == "(" else "predicate")
            return 1 if mark != "{" else 2
        if mark in "])" or (mark == "|" and following[:1] == "}"):
            self.pop()
            return 1 if mark != "|" else 2
        if mark == "." and len(self.stack) == 1:
            self.close(read[at].end)
            self.stack[0] = "subject"
        elif mark in ";,":
            self.stack[-1] = "predicate" if mark == ";" else "object"
        elif mark == "~" and self.stack[-1] == "end":
            self.stack[-1] = "object"
        return 1

    def push(self, state: str) -> None:
        self.stack.append(state)
        self.verbs.append("")

    def pop(self) -> None:
        if len(self.stack) > 1:
            self.stack.pop()
            self.verbs.pop()
            self.advance()
        else:  # it closes nothing
            self.stack[-1] = "end"
        if self.half.keys() >= {"prefix", "namespace"}:
            self.declared[self.half.pop("prefix")] = self.half.pop("namespace")

    def advance(self) -> None:
        following = {"subject": "predicate", "predicate": "object", "object": "end"}
        self.stack[-1] = following.get(self.stack[-1], self.stack[-1])

    def term(self, token: Token) -> int:
        """Take any other token."""
        state = self.stack[-1]
        if token.kind == "datatype":
            self.held, self.stack[-1] = state, "datatype"
            return 1
        name = self.name(token, state)
        if name is not None:
            self.found.names.append(name)
        if state == "datatype":
            self.stack[-1] = self.held
            return 1
        if token.kind == "at":
            return 1
        if state == "subject" and len(self.stack) == 1 and name is not None:
            self.block = Block(name, token.text, token.start, token.end)
            self.found.blocks.append(self.block)
        elif state == "predicate":
            self.verbs[-1] = name.iri if name else ""
        elif state == "object":
            self.value(token, name)
        self.advance()
        return 1

    def value(self, token: Token, name: Name | None) -> None:
        verb = self.verbs[-1]
        if name is not None and name.role == "class" and len(self.stack) == 1 and self.block is not None:
            self.block.types.append(name.iri)
        if verb == OWL + "deprecated" and self.block is not None and unescape(token.text).strip("\"'") in {"true", "1"}:
            self.block.deprecated = self.block.deprecated or len(self.stack) == 1
        if token.kind == "string":
            value = _inside(token)
            if verb in QUERIES:
                self.queries.append((token, value))
            elif verb in {SH + "prefix", SH + "namespace"}:
                self.half[verb.removeprefix(SH)] = unescape(value)

    def name(self, token: Token, state: str) -> Name | None:
        if state == "predicate" and token.kind == "word" and token.text == "a":
            return Name(RDF + "type", token.start, token.end, "predicate")
        if token.kind not in _NAMED:
            return None
        role = "class" if state == "datatype" or (state == "object" and self.verbs[-1] == RDF + "type") else state
        role = "object" if role in {"list", "end"} else role
        if token.kind == "iri":
            return Name(self.resolve(token), token.start, token.end, role)
        prefix, _, local = token.text.partition(":")
        namespace = self.found.prefixes.get(prefix)
        if namespace is None:
            return None
        return Name(namespace + _plain(local), token.start, token.end, role, namespace)

    def resolve(self, token: Token) -> str:
        reference = unescape(token.text[1:-1])
        return reference if ":" in reference.partition("/")[0] else urljoin(self.base, reference)


def _inside(token: Token) -> str:
    """The text between the quotes of a string, as written."""
    quote = 3 if token.text[:3] in {'"""', "'''"} and len(token.text) >= 6 else 1
    return token.text[quote:-quote]


def _moved(token: Token, raw: str, known: Mapping[str, str]) -> Iterator[Name]:
    """The names of a query at their places in the file."""
    if _ESCAPED not in raw:
        quote = (len(token.text) - len(raw)) // 2
        yield from _in_query(raw, token.start + quote, known)
        return
    for name in _in_query(unescape(raw), 0, known):
        start, end = (token.start + position_in_literal(token.text, at) for at in (name.start, name.end))
        yield Name(name.iri, start, end, "query", name.namespace)


def _in_query(query: str, begin: int, known: Mapping[str, str]) -> Iterator[Name]:
    """The names of a query that begins at the offset ``begin``."""
    prefixes = dict(known)
    read = list(tokens(query))
    for index, token in enumerate(read):
        if token.kind == "iri":
            before = read[index - 2 : index] if index > 1 else []
            if len(before) == 2 and before[0].text.upper() == "PREFIX" and before[1].kind == "name":
                prefixes[before[1].text[:-1]] = unescape(token.text[1:-1])
            else:
                yield Name(unescape(token.text[1:-1]), begin + token.start, begin + token.end, "query")
        elif token.kind == "name" and not (index and read[index - 1].text.upper() == "PREFIX"):
            prefix, _, local = token.text.partition(":")
            if prefix in prefixes:
                namespace = prefixes[prefix]
                yield Name(namespace + _plain(local), begin + token.start, begin + token.end, "query", namespace)


def _plain(local: str) -> str:
    """A local name without its backslashes."""
    return unescape(local) if _ESCAPED in local else local
