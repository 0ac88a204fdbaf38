"""A query over marked literals: wherever it computes with a term, it asks for the term's value first.

Only tokens are read. Patterns compare terms, so that a variable there stays as it is and a constant is marked as the
data are. In an expression, an operator, an effective boolean value, ORDER BY and the functions that compute with
numbers and times take values; the other functions (STR, for one) take the term as it is written.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

from pyoxigraph import Literal, NamedNode

from onto_compiler.lexical.terms import mark
from onto_compiler.rdf import RDFS, XSD
from onto_compiler.turtle.tokens import Token, tokens, unescape

__all__ = ["DATATYPE", "EXTREMES", "STRDT", "VALUE", "Kept", "keep"]

_NAMES = "urn:onto-evwm:lexical:"
VALUE, DATATYPE, STRDT = (NamedNode(_NAMES + name) for name in ("value", "datatype", "strdt"))
EXTREMES = {name: NamedNode(_NAMES + name.lower()) for name in ("MIN", "MAX")}

_RENAMED = {"DATATYPE": DATATYPE, "STRDT": STRDT, **EXTREMES}
# Functions whose arguments are numbers or times.
_COMPUTING = "ABS AVG CEIL DAY FLOOR HOURS ISNUMERIC MINUTES MONTH ROUND SECONDS SUBSTR SUM TIMEZONE TZ YEAR"
_OF_VALUES = frozenset(_COMPUTING.split())
_RETURNS_TERM = frozenset(("COALESCE", "IF", "OBJECT", "STRDT", "SAMPLE", "MIN", "MAX"))
_BEHIND_GROUPS = frozenset(("GROUP", "HAVING", "ORDER", "LIMIT", "OFFSET", "VALUES"))
# What is held against an IRI needs no value; these signs bind less, so that they do not compute with it.
_EQUALS, _BESIDE = frozenset(("=", "!=")), frozenset(("", "&&", "||"))
_END = Token("end", "", 0, 0)


@dataclass(frozen=True, slots=True)
class Kept:
    """``text`` asks for the same over marked literals; ``forms``: so it must, as it writes such literals itself."""

    text: str
    forms: bool


class _Primary(NamedTuple):
    """A part of an expression: what to insert at its ends, or within, where its value or its term is wanted."""

    start: int
    end: int
    is_term: bool = False  # it may be a marked literal
    constant: str = ""  # the marked spelling of a constant
    is_iri: bool = False


@lru_cache(maxsize=1024)
def keep(text: str, prefixes: tuple[tuple[str, str], ...] = ()) -> Kept:
    """``text`` over marked literals; what is no SPARQL comes back in some form that is none either."""
    reader = _Rewriter(list(tokens(text)), text, dict(prefixes))
    try:
        reader.query()
    except RecursionError:  # nested deeper than any parser goes
        return Kept(text, forms=False)
    written, at = "", 0
    for start, end, new in sorted(reader.edits):
        written += text[at:start] + new
        at = max(at, end)
    return Kept(written + text[at:], reader.forms)


@dataclass(slots=True)
class _Rewriter:
    tokens: list[Token]
    text: str
    prefixes: dict[str, str]
    at: int = 0
    edits: list[tuple[int, int, str]] = field(default_factory=list)
    forms: bool = False

    # Tokens

    @property
    def peek(self) -> Token:
        return self.tokens[self.at] if self.at < len(self.tokens) else _END

    @property
    def word(self) -> str:
        """The next token in upper case, where it is a word."""
        return self.peek.text.upper() if self.peek.kind == "word" else ""

    def next(self) -> Token:
        token = self.peek
        self.at += 1
        return token

    def sees(self, *texts: str) -> bool:
        """Whether the next tokens are ``texts``."""
        ahead = self.tokens[self.at : self.at + len(texts)]
        return len(ahead) == len(texts) and all(
            token.text.upper() == text for token, text in zip(ahead, texts, strict=True)
        )

    def take(self, text: str) -> bool:
        if self.sees(text) and self.peek.kind in {"mark", "word"}:
            self.at += 1
            return True
        return False

    # Queries and patterns

    def query(self) -> None:
        """The whole text: prologue, head, groups and what stands behind them."""
        while self.at < len(self.tokens):
            if self.word == "PREFIX":
                self.prefix()
            elif self.sees("{"):
                self.group()
            elif self.word == "SELECT":
                self.next()
                self.projection()
            elif not self.behind_groups():
                self.next()

    def prefix(self) -> None:
        self.next()
        name, target = self.next(), self.next()
        if name.kind == "name" and target.kind == "iri":
            self.prefixes[name.text[:-1]] = unescape(target.text[1:-1])

    def projection(self) -> None:
        """``?x (expression AS ?y)``, up to the group."""
        while self.at < len(self.tokens) and not self.sees("{") and self.word not in {"WHERE", "FROM"}:
            if not self.bracketed():
                self.next()

    def bracketed(self) -> bool:
        """``(expression AS ?y)``, where it stands next: the term is passed on as it is."""
        if not self.take("("):
            return False
        self.as_term(self.expression())
        while self.at < len(self.tokens) and not self.take(")"):
            self.next()
        return True

    def group(self) -> None:
        """A group of patterns, with the groups and the subqueries in it."""
        self.next()
        while self.at < len(self.tokens) and not self.take("}"):
            word = self.word
            if self.sees("{"):
                self.group()
            elif word == "FILTER":
                self.next()
                self.constraint()
            elif word == "BIND":
                self.next()
                self.bracketed()
            elif word == "SELECT":
                self.next()
                self.projection()
            elif word == "VALUES" or not self.behind_groups():
                self.pattern_token()

    def pattern_token(self) -> None:
        """One token of a pattern; a constant is marked."""
        if self.peek.kind in {"string", "number"} or self.word in {"TRUE", "FALSE"}:
            self.as_term(self.constant())
        else:
            self.next()

    def behind_groups(self) -> bool:
        """GROUP BY, HAVING, ORDER BY, LIMIT and OFFSET, where one stands next."""
        word = self.word
        if word in {"LIMIT", "OFFSET"}:
            self.at += 2
        elif word in {"GROUP", "ORDER"}:
            self.at += 2
            self.conditions(values=word == "ORDER")
        elif word == "HAVING":
            self.next()
            while self.begins_constraint():
                self.constraint()
        elif word == "VALUES":
            self.next()
            while self.at < len(self.tokens) and not self.sees("{"):
                self.next()
            while self.at < len(self.tokens) and not self.take("}"):
                self.pattern_token()
        else:
            return False
        return True

    def begins_constraint(self) -> bool:
        token = self.peek
        if self.word in _BEHIND_GROUPS:
            return False
        return token.text == "(" or token.kind in {"iri", "name", "word", "variable"}

    def conditions(self, *, values: bool) -> None:
        """What GROUP BY and ORDER BY list."""
        while self.begins_constraint():
            if self.word in {"ASC", "DESC"}:
                self.next()
                self.arguments([True])
            elif not values and self.sees("("):
                self.bracketed()
            else:
                found = self.primary()
                if values:
                    self.as_value(found)
                else:
                    self.as_term(found)

    def constraint(self) -> None:
        """What stands behind FILTER and HAVING: its effective boolean value counts."""
        self.as_value(self.primary())

    # Expressions

    def expression(self) -> _Primary:
        """An expression; what is returned is a term only where nothing computes with it."""
        operands, signs = [self.operand()], [""]
        while sign := self.operator():
            operands.append(self.members() if sign == "IN" else self.operand())
            signs.append(sign)
        if len(operands) == 1:
            return operands[0]
        for at, one in enumerate(operands):
            around = [
                (signs[at], operands[at - 1]),
                *zip(signs[at + 1 : at + 2], operands[at + 1 : at + 2], strict=True),
            ]
            equated = any(sign in _EQUALS and other.is_iri for sign, other in around)
            if not equated or not all(sign in _EQUALS | _BESIDE for sign, _ in around):
                self.as_value(one)
        return _Primary(operands[0].start, operands[-1].end)

    def operator(self) -> str:
        """Step over an operator; ``?a<?b && ?c>?d`` may have been read as if an IRI stood in it."""
        token = self.peek
        if token.kind == "iri":
            again = tokens(self.text[token.start + 1 :])
            behind = [one._replace(start=one.start + token.start + 1, end=one.end + token.start + 1) for one in again]
            self.tokens[self.at :] = [Token("mark", "<", token.start, token.start + 1), *behind]
        if self.peek.kind == "number" and self.peek.text[0] in "+-":
            return self.peek.text[0]
        if self.sees("IN") or self.sees("NOT", "IN"):
            self.at += 1 + self.sees("NOT")
            return "IN"
        sign = ""
        while self.peek.kind == "mark" and self.peek.text in "=!<>&|*/" and not (sign and self.begins_operand()):
            sign += self.next().text
        if not sign and self.peek.kind == "mark" and self.peek.text in {"+", "-"}:
            sign = self.next().text
        return sign

    def members(self) -> _Primary:
        """The list behind IN; each member is compared by its value."""
        start = self.peek.start
        self.arguments([True])
        return _Primary(start, self.behind())

    def begins_operand(self) -> bool:
        """Whether the mark that stands next belongs to the operand and not to the operator before it."""
        return self.peek.text == "!" or self.sees("<", "<")

    def operand(self) -> _Primary:
        """A primary, with the signs in front of it."""
        start = self.peek.start
        signs = 0
        while self.peek.kind == "mark" and self.peek.text in {"!", "+", "-"}:
            self.next()
            signs += 1
        found = self.primary()
        if not signs:
            return found
        self.as_value(found)
        return _Primary(start, found.end)

    def primary(self) -> _Primary:
        token = self.peek
        if token.kind == "mark" and (token.text == "(" or self.sees("<", "<", "(")):
            return self.parenthesis() if token.text == "(" else self.triple()
        if token.kind in {"string", "number"} or self.word in {"TRUE", "FALSE"}:
            return self.constant()
        if token.kind == "variable":
            self.next()
            return _Primary(token.start, token.end, is_term=True)
        if token.kind in {"iri", "name"}:
            return self.call()
        return self.builtin() if token.kind == "word" else _Primary(token.start, self.next().end)

    def parenthesis(self) -> _Primary:
        start = self.next().start
        found = self.expression()
        self.as_term(found)
        self.take(")")
        return _Primary(start, self.behind(), is_term=found.is_term)

    def triple(self) -> _Primary:
        """``<<( s p o )>>``."""
        start = self.peek.start
        while self.at < len(self.tokens) and not self.sees(")", ">", ">"):
            self.pattern_token()
        self.at += 3
        return _Primary(start, self.behind(), is_term=True)

    def constant(self) -> _Primary:
        token = self.next()
        end = token.end
        if token.kind != "string":
            datatype = "boolean" if token.kind == "word" else _kind(token.text)
            literal = Literal(token.text, datatype=NamedNode(XSD + datatype))
        elif self.peek.kind == "datatype":
            self.next()
            named = self.next()
            end = named.end
            literal = Literal(_content(token.text), datatype=NamedNode(self.iri(named) or RDFS + "Literal"))
        else:
            if self.peek.kind == "at":
                end = self.next().end
            return _Primary(token.start, end)
        marked = mark(literal)
        if marked is literal:
            return _Primary(token.start, end)
        self.forms = True
        return _Primary(token.start, end, is_term=True, constant=str(marked))

    def call(self) -> _Primary:
        """An IRI, or the call of the function that it names: a cast takes values, and gives one."""
        token = self.next()
        if not self.sees("("):
            return _Primary(token.start, token.end, is_iri=True)
        iri = self.iri(token)
        casts = iri.startswith(XSD) and iri != XSD + "string"
        self.arguments([casts])
        return _Primary(token.start, self.behind(), is_term=not iri.startswith(XSD))

    def builtin(self) -> _Primary:
        """A function of SPARQL's own, or EXISTS with its group."""
        token = self.next()
        name = token.text.upper()
        self.take("EXISTS")  # behind NOT
        if self.sees("{"):
            self.group()
        if not self.sees("("):
            return _Primary(token.start, self.behind())
        if name in _RENAMED:
            self.edits.append((token.start, token.end, str(_RENAMED[name])))
            self.forms = self.forms or name == "STRDT"
        if name in EXTREMES and self.sees("(", "DISTINCT"):  # the same without it, which no function may have
            distinct = self.tokens[self.at + 1]
            self.edits.append((distinct.start, distinct.end, ""))
        self.arguments([True, False] if name == "IF" else [name in _OF_VALUES])
        return _Primary(token.start, self.behind(), is_term=name in _RETURNS_TERM)

    def arguments(self, values: list[bool]) -> None:
        """A call's arguments; ``values`` says of each whether its value is wanted, the last also for those behind."""
        self.next()
        number = 0
        while self.at < len(self.tokens) and not self.take(")"):
            if self.word == "DISTINCT" or self.peek.text in {",", "*", ";"}:
                self.next()
            elif self.word == "SEPARATOR":
                self.at += 3
            else:
                before = self.at
                found = self.expression()
                if values[min(number, len(values) - 1)]:
                    self.as_value(found)
                else:
                    self.as_term(found)
                number += 1
                self.at = max(self.at, before + 1)

    def behind(self) -> int:
        """Where the last token ends."""
        return self.tokens[min(self.at, len(self.tokens)) - 1].end

    def iri(self, token: Token) -> str:
        if token.kind == "iri":
            return unescape(token.text[1:-1])
        prefix, _, local = token.text.partition(":")
        return self.prefixes.get(prefix, f"{prefix}:") + local

    # Edits

    def as_value(self, found: _Primary) -> None:
        if found.is_term and not found.constant:
            self.edits.append((found.start, found.start, f"{VALUE}("))
            self.edits.append((found.end, found.end, ")"))

    def as_term(self, found: _Primary) -> None:
        if found.constant:
            self.edits.append((found.start, found.end, found.constant))


def _kind(number: str) -> str:
    if number.lstrip("+-").isdigit():
        return "integer"
    return "double" if "e" in number.lower() else "decimal"


def _content(quoted: str) -> str:
    quote = 3 if quoted[:3] in {'"""', "'''"} and len(quoted) >= 6 else 1
    return unescape(quoted[quote:-quote])
