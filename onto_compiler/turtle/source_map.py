"""From a triple of a Turtle file to the place where it is written.

A tolerant recursive descent over RDF 1.1 Turtle, section 6.5: it goes on behind the next dot where it cannot read. Of
TriG and N-Quads it reads the triples and passes over the names of their graphs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, cast

from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Quad, RdfFormat, Store, Triple, parse

from onto_compiler.problems import Span
from onto_compiler.rdf import RDF, XSD
from onto_compiler.terms import Term
from onto_compiler.turtle.limits import MAX_DEPTH
from onto_compiler.turtle.tokens import SourceText, Token, position_in_literal, tokens, unescape

__all__ = ["Located", "Prefix", "SourceMap", "Term", "canonical", "map_text", "read_map"]

_FIRST, _REST, _NIL, _TYPE, _REIFIES = (NamedNode(RDF + name) for name in ("first", "rest", "nil", "type", "reifies"))
_DIRECTIVES = frozenset(("@PREFIX", "@BASE", "@VERSION", "PREFIX", "BASE", "VERSION"))
_END = Token("end", "", 0, 0)


class Located(NamedTuple):
    """A triple, and the tokens that its three parts were read from."""

    subject: NamedNode | BlankNode
    predicate: NamedNode
    object: Term
    at_subject: Token
    at_predicate: Token
    at_object: Token


@dataclass(slots=True)
class Prefix:
    """A prefix declaration, and how often it is used behind it."""

    name: str
    namespace: str
    token: Token
    uses: int = 0


@dataclass(slots=True)
class SourceMap:
    """The triples of one file in the order in which they are written."""

    source: SourceText
    triples: list[Located] = field(default_factory=list)
    declared: list[Prefix] = field(default_factory=list)
    _index: dict[tuple[Term, Term | None, Term | None], list[Located]] = field(
        default_factory=dict, repr=False, compare=False
    )

    def span(self, token: Token) -> Span:
        """The place of a token."""
        return self.source.span(token.start, token.end)

    def inside(self, token: Token, index: int, length: int = 1) -> Span:
        """The place of ``length`` characters of a literal's value, from character ``index`` on."""
        start = token.start + position_in_literal(token.text, index)
        end = token.start + position_in_literal(token.text, index + length)
        return self.source.span(start, max(end, start + 1))

    def find(self, subject: Term | None, predicate: Term | None = None, object_: Term | None = None) -> list[Located]:
        """The triples that match, in their order; None is a wildcard, and a blank node is one of this parse."""
        value = None if object_ is None else canonical(object_)
        if subject is None:
            return [
                triple
                for triple in self.triples
                if predicate in {None, triple.predicate} and value in {None, canonical(triple.object)}
            ]
        if not self._index:
            self._fill()
        if predicate is None and value is not None:
            return [triple for triple in self.find(subject) if canonical(triple.object) == value]
        return self._index.get((subject, predicate, value), [])

    def _fill(self) -> None:
        """Index every triple by its subject, by its subject and property, and whole."""
        for triple in self.triples:
            subject, predicate = triple.subject, triple.predicate
            for key in (
                (subject, None, None),
                (subject, predicate, None),
                (subject, predicate, canonical(triple.object)),
            ):
                self._index.setdefault(key, []).append(triple)


def canonical(term: Term) -> Term:
    """``term`` as Oxigraph's store keeps it: numbers, booleans and times lose their lexical form."""
    if (
        not isinstance(term, Literal)
        or not term.datatype.value.startswith(XSD)
        or term.datatype.value == XSD + "string"
    ):
        return term
    return _stored(term)


@lru_cache(maxsize=65536)
def _stored(literal: Literal) -> Literal:
    store = Store()
    store.add(Quad(_NIL, _NIL, literal))
    return cast("Literal", next(iter(store)).object)


def read_map(path: Path, base: str | None = None) -> SourceMap:
    """Read a file's source map.

    Raises:
        OSError, UnicodeDecodeError: the file cannot be read.

    """
    text = path.read_bytes().decode("utf-8-sig")
    return map_text(text, str(path), base or path.as_uri())


def map_text(text: str, file: str, base: str) -> SourceMap:
    """The source map of a text; relative IRIs are resolved against ``base``."""
    result = SourceMap(SourceText(file, text))
    _Walker(result, base).run()
    return result


class _Unreadable(Exception):  # noqa: N818 - no error to its callers: the walker skips to the next dot
    """The walker met a token that it cannot use."""


@dataclass(slots=True)
class _Walker:
    result: SourceMap
    base: str
    prefixes: dict[str, Prefix] = field(default_factory=dict)
    tokens: list[Token] = field(default_factory=list)
    at: int = 0
    blanks: dict[str, BlankNode] = field(default_factory=dict)
    depth: int = 0

    def run(self) -> None:
        self.tokens = list(tokens(self.result.source.text))
        while self.at < len(self.tokens):
            begin, self.depth = self.at, 0
            try:
                self.statement()
            except (_Unreadable, ValueError):  # Oxigraph's word for what is no IRI or no language tag
                self.at = max(self.at, begin + 1)
                while self.at < len(self.tokens) and self.tokens[self.at].text != ".":
                    self.at += 1
                self.at += 1

    # Tokens

    @property
    def peek(self) -> Token:
        return self.tokens[self.at] if self.at < len(self.tokens) else _END

    def next(self) -> Token:
        token = self.peek
        self.at += 1
        return token

    def take(self, *texts: str) -> Token | None:
        return self.next() if self.peek.text in texts and self.peek.kind in {"mark", "word", "at"} else None

    def expect(self, text: str) -> Token:
        token = self.take(text)
        if token is None:
            raise _Unreadable
        return token

    def descend(self, text: str) -> Token:
        """As ``expect``, of a bracket; what is nested deeper than the methods can follow is passed over."""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise _Unreadable
        return self.expect(text)

    # Grammar

    def statement(self) -> None:
        word = self.peek
        if word.kind in {"at", "word"} and word.text.upper() in _DIRECTIVES:
            self.directive()
        elif not self.enters_graph() and self.take("}") is None:
            self.triples()

    def directive(self) -> None:
        word = self.next()
        if word.text.upper().endswith("VERSION"):
            self.next()
        elif word.text.upper().endswith("PREFIX"):
            name = self.next()
            target = self.next()
            if name.kind != "name" or target.kind != "iri":
                raise _Unreadable
            prefix = Prefix(name.text[:-1], self.iri(target).value, name)
            self.prefixes[prefix.name] = prefix
            self.result.declared.append(prefix)
        else:
            self.base = self.iri(self.next()).value
        if word.text.startswith("@"):
            self.expect(".")

    def triples(self) -> None:
        token = self.peek
        if self.peek.text == "[" and self.peek.kind == "mark":
            subject: NamedNode | BlankNode = self.anonymous()
            if self.peek.text != ".":
                self.properties(subject, token)
        else:
            if self.peek.text == "(":
                subject = self.collection()
            elif self.opens("<", "<"):
                subject = self.reified()
                if self.peek.text == ".":  # its triple was all that was to be stated
                    self.next()
                    return
            elif (named := self.resource(self.next())) is not None:
                subject = named
            else:
                raise _Unreadable
            self.properties(subject, token)
        if self.peek.kind in {"iri", "blank"}:
            self.next()  # the graph of an N-Quad
        if self.peek.text != "}" or self.peek.kind != "mark":
            self.expect(".")

    def enters_graph(self) -> bool:
        """Whether a graph's block of TriG begins here; its name and brace are then behind us."""
        ahead = [token.text for token in self.tokens[self.at : self.at + 4]]
        length = ahead.index("{") + 1 if "{" in ahead else 0
        named = length == 3 and (ahead[0].upper() == "GRAPH" or ahead[:2] == ["[", "]"])
        if length not in {1, 2} and not named:
            return False
        self.at += length
        return True

    def properties(self, subject: NamedNode | BlankNode, at_subject: Token) -> None:
        while True:
            verb = self.next()
            predicate = _TYPE if verb.kind == "word" and verb.text == "a" else self.resource(verb)
            if not isinstance(predicate, NamedNode):
                raise _Unreadable
            while True:
                token = self.peek
                value = self.object()
                self.result.triples.append(Located(subject, predicate, value, at_subject, verb, token))
                self.annotations(Triple(subject, predicate, value), token)
                if self.take(",") is None:
                    break
            ended = False
            while self.take(";") is not None:
                ended = True
            if not ended or self.peek.text in {".", "]", "}", "|", ""}:
                return

    def object(self) -> Term:
        token = self.peek
        if token.kind == "mark" and token.text == "[":
            return self.anonymous()
        if token.kind == "mark" and token.text == "(":
            return self.collection()
        if self.opens("<", "<", "("):
            return self.triple_term()
        if self.opens("<", "<"):
            return self.reified()
        self.next()
        named = self.resource(token)
        return named if named is not None else self.literal(token)

    # Turtle 1.2

    def opens(self, *texts: str) -> bool:
        """Whether the next tokens are ``texts``."""
        if self.peek.text != texts[0]:  # of most tokens this is asked in vain
            return False
        return tuple(token.text for token in self.tokens[self.at : self.at + len(texts)]) == texts

    def triple_term(self) -> Triple:
        """``<<( subject predicate object )>>``."""
        self.at += 2
        self.descend("(")
        found = self.parts()
        for mark in ")>>":
            self.expect(mark)
        self.depth -= 1
        return found

    def direction(self) -> BaseDirection | None:
        """``--ltr`` or ``--rtl`` behind a language."""
        if not (self.opens("-", "-", "ltr") or self.opens("-", "-", "rtl")):
            return None
        self.at += 3
        return BaseDirection(self.tokens[self.at - 1].text)

    def reified(self) -> NamedNode | BlankNode:
        """``<< subject predicate object ~ reifier >>``, which states that the reifier reifies the triple."""
        opening = self.next()
        self.descend("<")
        found = self.parts()
        reifier = self.reifier(found, opening) if self.peek.text == "~" else None
        for mark in ">>":
            self.expect(mark)
        self.depth -= 1
        return reifier or self.reifies(BlankNode(), found, opening)

    def parts(self) -> Triple:
        """The three terms of a triple within another."""
        subject, verb = self.object(), self.next()
        predicate = _TYPE if verb.kind == "word" and verb.text == "a" else self.resource(verb)
        if isinstance(subject, (Literal, Triple)) or not isinstance(predicate, NamedNode):
            raise _Unreadable
        return Triple(subject, predicate, self.object())

    def reifier(self, triple: Triple, at: Token) -> NamedNode | BlankNode:
        """``~ name``, where the name may be left out."""
        self.expect("~")
        named = self.resource(self.next()) if self.peek.kind in {"iri", "name", "blank"} else None
        return self.reifies(named or BlankNode(), triple, at)

    def reifies(self, reifier: NamedNode | BlankNode, triple: Triple, at: Token) -> NamedNode | BlankNode:
        self.result.triples.append(Located(reifier, _REIFIES, triple, at, at, at))
        return reifier

    def annotations(self, triple: Triple, at: Token) -> None:
        """``~ reifier {| properties |}`` behind an object, each any number of times; as Oxigraph, a name stays."""
        reifier: NamedNode | BlankNode | None = None
        while self.peek.text == "~" or self.opens("{", "|"):
            if self.peek.text == "~":
                reifier = self.reifier(triple, at)
                continue
            self.at += 2
            self.properties(reifier or self.reifies(BlankNode(), triple, at), at)
            self.expect("|")
            self.expect("}")

    def anonymous(self) -> BlankNode:
        opening = self.descend("[")
        node = BlankNode()
        if self.take("]") is None:
            self.properties(node, opening)
            self.expect("]")
        self.depth -= 1
        return node

    def collection(self) -> NamedNode | BlankNode:
        opening = self.descend("(")
        head: NamedNode | BlankNode = _NIL
        last: BlankNode | None = None
        while self.take(")") is None:
            token = self.peek
            cell = BlankNode()
            if last is None:
                head = cell
            else:
                self.result.triples.append(Located(last, _REST, cell, opening, token, token))
            self.result.triples.append(Located(cell, _FIRST, self.object(), opening, token, token))
            last = cell
        self.depth -= 1
        if last is not None:
            closing = self.tokens[self.at - 1]
            self.result.triples.append(Located(last, _REST, _NIL, opening, closing, closing))
        return head

    def resource(self, token: Token) -> NamedNode | BlankNode | None:
        match token.kind:
            case "iri":
                return self.iri(token)
            case "name":
                return self.name(token)
            case "blank":
                return self.blanks.setdefault(token.text, BlankNode())
            case _:
                return None

    def literal(self, token: Token) -> Literal:
        match token.kind:
            case "number":
                integer = token.text.lstrip("+-").isdigit()
                kind = "integer" if integer else "double" if "e" in token.text.lower() else "decimal"
                return Literal(token.text, datatype=NamedNode(XSD + kind))
            case "word" if token.text in {"true", "false"}:
                return Literal(token.text, datatype=NamedNode(XSD + "boolean"))
            case "string":
                quote = 3 if token.text[:3] in {'"""', "'''"} and len(token.text) >= 6 else 1
                value = unescape(token.text[quote:-quote])
                if self.peek.kind == "at":
                    return Literal(value, language=self.next().text[1:], direction=self.direction())
                if self.peek.kind == "datatype":
                    self.next()
                    datatype = self.resource(self.next())
                    if not isinstance(datatype, NamedNode):
                        raise _Unreadable
                    return Literal(value, datatype=datatype)
                return Literal(value)
            case _:
                raise _Unreadable

    def iri(self, token: Token) -> NamedNode:
        if token.kind != "iri":
            raise _Unreadable
        text = unescape(token.text[1:-1])
        scheme = text.partition(":")[0]
        if ":" in text and scheme and scheme.replace("+", "").replace("-", "").replace(".", "").isalnum():
            return NamedNode(text)
        return _resolve(text, self.base)

    def name(self, token: Token) -> NamedNode:
        prefix, _, local = token.text.partition(":")
        declared = self.prefixes.get(prefix)
        if declared is None:
            raise _Unreadable
        declared.uses += 1
        return NamedNode(declared.namespace + _plain(local))


def _plain(local: str) -> str:
    """A local name without its backslashes."""
    return "".join(_characters(local)) if "\\" in local else local


def _characters(local: str) -> Iterator[str]:
    skip = False
    for character in local:
        if character == "\\" and not skip:
            skip = True
            continue
        skip = False
        yield character


def _resolve(reference: str, base: str) -> NamedNode:
    """RFC 3986 resolution, by the parser that will also have the last word on it."""
    try:
        read = next(iter(parse(f"<{reference}> <x:p> <x:o> .".encode(), format=RdfFormat.TURTLE, base_iri=base)))
    except (SyntaxError, ValueError) as error:
        raise _Unreadable from error
    subject = read.subject if isinstance(read, (Triple, Quad)) else None
    if not isinstance(subject, NamedNode):
        raise _Unreadable
    return subject
