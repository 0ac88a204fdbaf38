"""A Turtle file as the tree that its layout follows: statements, properties, brackets, and the comments beside them.

Read only after Oxigraph has accepted the file. Source of the grammar: RDF 1.2 Turtle, section 6.5.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

from onto_compiler.rdf import RDF
from onto_compiler.turtle.remarks import END, Lexeme, Remark, lexemes
from onto_compiler.turtle.tokens import Token

__all__ = [
    "CLOSING",
    "VERSION",
    "Annotated",
    "Bracket",
    "Directive",
    "Item",
    "Node",
    "Property",
    "Triples",
    "TurtleDocument",
    "Unknown",
    "Word",
    "read_document",
]

CLOSING: Final = {"[": "]", "(": ")", "{|": "|}", "<<": ">>", "<<(": ")>>"}
"""The end of each bracket: a bracketed node, a collection, an annotation, a reified triple and a triple term."""
VERSION: Final = "@version"
_OF_PROPERTIES: Final = frozenset(("[", "{|"))
_OF_TRIPLE: Final = frozenset(("<<", "<<("))
_ATOMS: Final = frozenset(("iri", "name", "blank", "number", "string"))


@dataclass(frozen=True, slots=True)
class Word:
    """An IRI, a name or a literal, as it is written."""

    text: str


@dataclass(slots=True)
class Bracket:
    """``[`` or ``{|`` with properties, else with nodes; ``broken`` says that it is written over several lines."""

    opening: str
    items: list[Item] = field(default_factory=list)
    broken: bool = False
    beside: str = ""  # the comment beside the opening bracket
    below: list[Remark] = field(default_factory=list)  # comments behind the last item


@dataclass(slots=True)
class Annotated:
    """An object, and the reifiers (``~ ex:r``) and annotations of its triple."""

    node: Word | Bracket
    notes: list[Word | Bracket]


@dataclass(slots=True)
class Property:
    """A verb and its objects; ``broken`` says that a line ends between two of them."""

    verb: str
    beside: str
    objects: list[Item]
    broken: bool


@dataclass(frozen=True, slots=True)
class Directive:
    """A prefix, or with an empty ``name`` the base; ``iri`` with its angle brackets, ``name`` with its colon.

    Of a version the name is ``VERSION``, and its text stands, in quotation marks, for the IRI.
    """

    name: str
    iri: str


@dataclass(slots=True)
class Triples:
    """A subject and its properties, of which only a bracket may have none."""

    subject: Word | Bracket
    beside: str
    properties: list[Item]


Node = Word | Bracket | Annotated


@dataclass(slots=True)
class Item:
    """Something that can have a line of its own, the comments above it and the one beside its last line."""

    body: Node | Property | Directive | Triples
    above: list[Remark] = field(default_factory=list)
    beside: str = ""
    apart: bool = False  # whether a blank line stands between the comments and it
    broken: bool = False  # whether it begins on a new line


@dataclass(slots=True)
class TurtleDocument:
    """All statements, and the comments behind the last one."""

    statements: list[Item]
    below: list[Remark]


class Unknown(Exception):  # noqa: N818 - not an error to its callers, who make a problem of it
    """A token that Turtle does not have at this place."""

    def __init__(self, token: Token) -> None:
        super().__init__(token.text)
        self.token = token


def read_document(text: str) -> TurtleDocument:
    """The tree of a Turtle text.

    Raises:
        Unknown: the text holds what Turtle does not know.

    """
    reader = _Reader(list(lexemes(text)))
    statements = []
    while reader.peek.token.kind != END:
        statements.append(reader.statement())
    return TurtleDocument(statements, reader.above())


@dataclass(slots=True)
class _Reader:
    lexemes: list[Lexeme]
    at: int = 0
    loose: list[Remark] = field(default_factory=list)  # comments within what is never broken
    typed: set[str] = field(default_factory=lambda: {f"<{RDF}type>"})  # how rdf:type can be written

    # Tokens and comments

    @property
    def peek(self) -> Lexeme:
        return self.lexemes[self.at]

    def next(self) -> Token:
        """The next token; comments before it that are not yet assigned are kept for the item that is being read."""
        lexeme = self.peek
        self.loose += self.above()
        if lexeme.token.kind == END:
            raise Unknown(lexeme.token)
        self.at += 1
        return lexeme.token

    def sees(self, *marks: str) -> bool:
        return self.peek.token.kind == "mark" and self.peek.token.text in marks

    def expect(self, mark: str) -> None:
        if not self.sees(mark):
            raise Unknown(self.peek.token)
        self.next()

    def above(self) -> list[Remark]:
        """All comments before the next token."""
        found, self.peek.before = self.peek.before, []
        return found

    def beside(self) -> str:
        """The comment on the line of the token that was read last, if there is one."""
        before = self.peek.before
        return before.pop(0).text if before and before[0].beside else ""

    def begin(self, body: Word) -> Item:
        """An item at the next token, with the comments that stand before it."""
        return Item(body, self.above(), "", self.peek.apart, self.peek.broken)

    def settle(self, item: Item) -> None:
        """Give ``item`` the comments that were found within it."""
        item.above += [replace(remark, beside=False, apart=False) for remark in self.loose]
        self.loose = []

    def seal(self, item: Item, mark: str) -> bool:
        """Read the separators behind ``item``, and the comment beside the last; whether there was one."""
        found = False
        while self.sees(mark):
            early = self.beside()
            if early and item.beside:
                item.above.append(Remark(item.beside))
            item.beside = early or item.beside
            broken = self.peek.broken
            self.next()
            self.peek.broken |= broken  # a separator that begins a line breaks the list as one that ends it does
            found = True
        if found:
            late = self.beside()
            if late and item.beside:
                item.above.append(Remark(item.beside))
            item.beside = late or item.beside
            self.settle(item)
        return found

    # Grammar

    def statement(self) -> Item:
        item = self.begin(Word(""))
        word = self.peek.token
        if word.kind in {"at", "word"} and word.text.upper().removeprefix("@") in {"PREFIX", "BASE", "VERSION"}:
            item.body = self.directive()
            if word.kind == "at":
                self.seal_dot(item)
                return item
            item.beside = self.beside()
            self.settle(item)
            return item
        item.body = triples = self.triples()
        last = triples.properties[-1] if triples.properties else item
        self.seal_dot(last)
        return item

    def seal_dot(self, item: Item) -> None:
        if not self.seal(item, "."):
            raise Unknown(self.peek.token)

    def directive(self) -> Directive:
        word = self.next()
        name = ""
        if word.text.upper().endswith("PREFIX"):
            name = self.next().text
        iri = self.next().text
        if word.text.upper().endswith("VERSION"):
            name = VERSION
        elif name:
            self.typed.discard(f"{name}type")
            if iri == f"<{RDF}>":
                self.typed.add(f"{name}type")
        return Directive(name, iri)

    def triples(self) -> Triples:
        subject = self.node()
        bare = isinstance(subject, Bracket) and subject.opening in {"[", "<<"} and self.sees(".")
        beside = "" if bare else self.beside()
        return Triples(subject, beside, [] if bare else self.properties())

    def properties(self) -> list[Item]:
        found: list[Item] = []
        while True:
            item = self.begin(Word(""))
            text = self.verb()
            beside = self.beside()
            objects = self.objects()
            item.body = Property(text, beside, objects, any(each.broken for each in objects[1:]))
            found.append(item)
            if not self.seal(item, ";"):
                item.beside = self.beside()
                return found
            if self.sees(".", "]", "|}"):
                return found

    def verb(self) -> str:
        verb = self.next()
        if verb.kind not in {"iri", "name"} and (verb.kind, verb.text) != ("word", "a"):
            raise Unknown(verb)
        return "a" if verb.text in self.typed else verb.text

    def objects(self) -> list[Item]:
        found: list[Item] = []
        while True:
            item = self.begin(Word(""))
            item.body = node = self.node()
            if notes := self.notes():
                item.body = Annotated(node, notes)
            self.settle(item)
            found.append(item)
            if not self.seal(item, ","):
                return found

    def notes(self) -> list[Word | Bracket]:
        """What annotates the triple of the object before."""
        found: list[Word | Bracket] = []
        while self.sees("~", "{|"):
            found.append(self.reifier() if self.sees("~") else self.bracket())
        return found

    def reifier(self) -> Word:
        """``~`` and the name behind it, which may be left out."""
        self.expect("~")
        if self.peek.token.kind in {"iri", "name", "blank"}:
            return Word(f"~ {self.next().text}")
        return Word("~")

    def node(self) -> Word | Bracket:
        if self.sees("[", "(", *_OF_TRIPLE):
            return self.bracket()
        token = self.next()
        if token.kind not in _ATOMS and (token.kind, token.text) not in {("word", "true"), ("word", "false")}:
            raise Unknown(token)
        text = token.text
        if token.kind == "string" and self.peek.token.kind == "at":
            text += self.next().text
        elif token.kind == "string" and self.peek.token.kind == "datatype":
            text += self.next().text
            text += self.next().text
        return Word(text)

    def bracket(self) -> Bracket:
        bracket = Bracket(self.next().text)
        bracket.beside = self.beside()
        closing = CLOSING[bracket.opening]
        if bracket.opening in _OF_PROPERTIES:
            bracket.items = [] if self.sees(closing) else self.properties()
        else:
            while not self.sees(closing):
                item = self.begin(Word(""))
                item.body = self.part(bracket)
                item.beside = self.beside()
                self.settle(item)
                bracket.items.append(item)
        bracket.broken = any(item.broken for item in bracket.items)
        bracket.below = self.above()
        self.expect(closing)
        return bracket

    def part(self, bracket: Bracket) -> Word | Bracket:
        """A member of a collection; of a triple its subject, verb, object or reifier."""
        if bracket.opening not in _OF_TRIPLE:
            return self.node()
        if len(bracket.items) == 1:
            return Word(self.verb())
        return self.reifier() if self.sees("~") else self.node()
