"""The first token of a query that the grammar has no place for."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib import resources

from lark import Lark, UnexpectedInput, UnexpectedToken
from lark import Token as Terminal
from lark.lexer import Lexer

from onto_compiler.problems import near
from onto_compiler.sparql_faults.fault import Fault, fault_at, listed
from onto_compiler.sparql_faults.words import FUNCTIONS, KEYWORDS
from onto_compiler.turtle.tokens import Token

__all__ = ["unexpected"]

_WORDS = {
    "A": "`a`",
    "BLANK": "a blank node",
    "BOOLEAN": "true or false",
    "DASH": "`-`",
    "EXCEPT": "MINUS",
    "FUNCTION": "a function",
    "IRI": "an IRI",
    "LANGUAGE": "a language tag",
    "NAME": "a prefixed name",
    "NUMBER": "a number",
    "SIGNED": "a number",
    "STRING": "a text",
    "VAR": "a variable",
}
_KNOWN = KEYWORDS | FUNCTIONS.keys()
_TERM = {"VAR", "IRI", "NAME", "BLANK", "NUMBER", "STRING"}  # what together is a term
_PAIRS = frozenset(("<<", ">>", "{|", "|}", "||", "&&", "!=", "<=", ">="))
_CLOSING = frozenset(")]}")
_MOST = 5  # expected things that a sentence names


class _Tokens(Lexer):
    """Lark's view of tokens that were read already."""

    def __init__(self, _: object) -> None:
        pass

    def lex(self, data: Iterable[Terminal]) -> Iterator[Terminal]:  # type: ignore[override]  # as Lark allows
        yield from data


@cache
def _parser() -> tuple[Lark, dict[str, str], dict[str, str]]:
    """The grammar, the terminals of its marks, and the marks of those terminals."""
    text = resources.files(__package__).joinpath("grammar.lark").read_text(encoding="utf-8")
    parser = Lark(text, parser="lalr", lexer=_Tokens)
    marks = {re.sub(r"\\(.)", r"\1", one.pattern.value): one.name for one in parser.terminals if one.pattern}
    return parser, marks, {name: text for text, name in marks.items()}


def unexpected(query: str, read: list[Token]) -> Fault | None:
    """The first token that cannot stand where it does."""
    parser, marks, names = _parser()
    terminals = list(_terminals(read, marks))
    try:
        parser.parse(terminals)
    except UnexpectedToken as error:
        if error.token.type == "$END":
            return _unended(read, error, names)
        at = error.token.start_pos or 0
        token = next((one for one in read if one.start <= at < one.end), read[-1])
        return (
            _broken_iri(query, token)
            or _closes_nothing(token, read)
            or _misplaced(token, str(error.token), read, error, names)
        )
    except UnexpectedInput:
        return None
    return None


def _terminals(read: list[Token], marks: Mapping[str, str]) -> Iterator[Terminal]:
    at = 0
    while at < len(read):
        token, behind = read[at], read[at + 1] if at + 1 < len(read) else None
        text = token.text
        if token.kind == "mark" and behind is not None and behind.start == token.end and text + behind.text in _PAIRS:
            text += behind.text
            at += 1
        yield Terminal(_type(token, text, marks, behind), text, start_pos=token.start)
        at += 1


def _type(token: Token, text: str, marks: Mapping[str, str], behind: Token | None) -> str:
    match token.kind:
        case "mark":
            return marks.get(text, "NONE")
        case "number":
            return "SIGNED" if text[0] in "+-" else "NUMBER"
        case "word":
            return _word(text, behind)
        case kind:
            return {"at": "LANGUAGE", "datatype": marks["^^"], "variable": "VAR"}.get(kind, kind.upper())


def _word(text: str, behind: Token | None) -> str:
    word = text.upper()
    if word == "MINUS":
        return "EXCEPT"
    if word in KEYWORDS:
        return word
    if text == "a":
        return "A"
    if word in {"TRUE", "FALSE"}:
        return "BOOLEAN"
    return "FUNCTION" if word in FUNCTIONS and behind is not None and behind.text == "(" else "NONE"


def _unended(read: list[Token], error: UnexpectedToken, names: Mapping[str, str]) -> Fault:
    """A query that ends too soon: at the last bracket that is open, or behind its last token."""
    closing = {")": "(", "]": "[", "}": "{"}
    opened: list[Token] = []
    for token in read:
        if token.kind == "mark" and token.text in closing.values():
            opened.append(token)
        elif token.kind == "mark" and token.text in closing and opened:
            opened.pop()
    if opened:
        mark = {left: right for right, left in closing.items()}[opened[-1].text]
        message = f"the `{opened[-1].text}` is not closed: the query ends before it is complete"
        return fault_at(opened[-1], message, f"add a `{mark}`")
    last = read[-1]
    wanted = _expected(error.accepts or error.expected, names)
    hint = f"behind `{last.text}`, {wanted} can follow" if wanted else ""
    return fault_at(last, "the query ends before it is complete", hint)


def _closes_nothing(token: Token, read: list[Token]) -> Fault | None:
    before = [one.text for one in read if one.kind == "mark" and one.start < token.start]
    if token.kind == "mark" and token.text == "}" and before.count("{") <= before.count("}"):
        return fault_at(token, "the `}` closes nothing", "take it out, or open a `{` before it")
    return None


def _misplaced(token: Token, text: str, read: list[Token], error: UnexpectedToken, names: Mapping[str, str]) -> Fault:
    wanted = error.accepts or error.expected
    words = {name for name in wanted if name in KEYWORDS or name == "EXCEPT"}
    if token.kind == "word" and token.text.upper() not in _KNOWN:
        following = next((one for one in read if one.start >= token.end), None)
        called = "FUNCTION" in wanted and following is not None and following.text == "("
        meant = near(token.text.upper(), sorted(FUNCTIONS if called else {*words, *FUNCTIONS}))
        if called:
            hint = meant or "a function of your own is called by an IRI or a prefixed name"
            return fault_at(token, f"`{token.text}` is no function of SPARQL", hint)
        if meant:
            return fault_at(token, f"`{token.text}` cannot stand here", meant)
    others = _expected(wanted, names)
    if not others and text in _CLOSING:
        others = _expected((name for name in wanted if names.get(name) in _CLOSING), names)
    unclear = f"what begins with `{text}` is not understood"
    message = f"`{text}` cannot stand here; expected {others}" if others else unclear
    return fault_at(token, message, _advice(token, text, wanted, names))


def _broken_iri(query: str, token: Token) -> Fault | None:
    """An IRI that holds what none may, which the scanner takes for the sign `<`."""
    found = re.compile(r"<([^<>\"\n]*)>").match(query, token.start) if token.text == "<" else None
    if found is None:
        return None
    wrong = next((one for one in found[1] if one in " {}|\\^`" or one < " "), "")
    message = f"`{found[0]}` is no IRI" + (f": it holds {'a space' if wrong == ' ' else f'`{wrong}`'}" if wrong else "")
    return Fault(message, "write what an IRI may not hold as %20 and the like", found.start(), len(found[0]))


def _advice(token: Token, text: str, wanted: set[str], names: Mapping[str, str]) -> str:
    if text == "@prefix":
        return "write `PREFIX` without @ and without a dot, before the query"
    if token.kind == "word" and token.text.upper() in FUNCTIONS and "LPAR" in wanted:
        return f"write `({token.text}(...) AS ?name)`"
    if text == "," and "VAR" in wanted:
        return "variables of SELECT stand without commas"
    closers = [names[name] for name in wanted if names.get(name) in _CLOSING]
    if text in _CLOSING and closers and text not in closers:
        return f"close with {listed(sorted(f'`{one}`' for one in closers), 'or')} first"
    return ""


def _expected(wanted: Iterable[str], names: Mapping[str, str]) -> str:
    """What could stand there, shortly; nothing where that is too much to say."""
    found = set(wanted) - {"$END"}
    words: list[str] = []
    if found >= _TERM:
        words.append("a term")
        found -= {*_TERM, "SIGNED", "BOOLEAN", "LSQB", "LPAR", "FUNCTION"} | {n for n in found if names.get(n) == "<<"}
    elif found >= {"IRI", "NAME"}:
        words.append("an IRI or a prefixed name")
        found -= {"IRI", "NAME"}
    words += sorted({_WORDS.get(name) or (f"`{names[name]}`" if name in names else name) for name in found})
    return listed(words, "or") if 0 < len(words) <= _MOST else ""
