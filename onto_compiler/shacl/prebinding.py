"""SPARQL with pre-bound variables (SHACL, sections 5.2.1 and appendix A): ``$this`` stands for a node everywhere.

A variable with an IRI or a literal is replaced in the text, which Oxigraph then looks up by its index. A blank node
cannot be written in a query: a function that returns it is bound at the beginning of every group instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any

from pyoxigraph import BlankNode, NamedNode, Triple

from onto_compiler.lexical.query import keep
from onto_compiler.lexical.store import LexicalStore, Rows
from onto_compiler.lexical.terms import mark
from onto_compiler.shacl.graph import Term
from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["Query", "ask", "is_joined", "read_query", "unsupported"]

_FUNCTION = "urn:onto-evwm:prebound:"
_OPTIONAL = {"shapesGraph", "currentShape"}
_CLAUSE_END = {"LIMIT", "OFFSET", "HAVING", "VALUES"}
Functions = dict[NamedNode, Callable[..., Any]]


@dataclass(frozen=True, slots=True)
class Query:
    """A query cut at its pre-bound variables. A slot is the variable's name and the form that takes its place."""

    text: str
    pieces: tuple[str | tuple[str, str], ...]
    openings: tuple[int, ...]  # where in ``text`` each group begins
    names: frozenset[str] = frozenset()  # of the variables that may be pre-bound

    def bind(self, given: Mapping[str, Term]) -> tuple[str, Functions]:
        """The text with ``given`` in place, and the functions that it calls."""
        if any(_is_nameless(term) for term in given.values()):
            return self.bind_by_function(given)
        written = []
        for piece in self.pieces:
            if isinstance(piece, str):
                written.append(piece)
                continue
            name, form = piece
            term = given.get(name)
            written.append(f"?{name}" if term is None else form.replace("\0", str(term)))
        return "".join(written), {}

    def bind_by_function(self, given: Mapping[str, Term]) -> tuple[str, Functions]:
        """As :meth:`bind`, for terms that a query cannot name where they stand."""
        functions: Functions = {}
        bindings = ""
        used = {piece[0] for piece in self.pieces if not isinstance(piece, str)}
        for name in sorted(used & given.keys()):
            iri = NamedNode(_FUNCTION + name)
            functions[iri] = partial(_same, given[name])
            bindings += f" BIND ({iri}() AS ?{name})"
        text, at = "", 0
        for opening in self.openings:
            text += self.text[at:opening] + bindings
            at = opening
        return text + self.text[at:], functions


def _same(term: Term) -> Term:
    return term


def _is_nameless(term: Term) -> bool:
    """Whether a query has no way to write ``term``, as it is a blank node or holds one; a triple is not written."""
    return isinstance(term, (BlankNode, Triple))


def ask(
    store: LexicalStore,
    query: Query,
    given: Mapping[str, Term],
    functions: Mapping[NamedNode, Callable[..., Any]] | None = None,
    *,
    union: bool = True,
) -> Rows:
    """The answer to ``query`` with ``given`` pre-bound; ``functions`` are those that it may call.

    Raises:
        SyntaxError: it is not SPARQL. ValueError, RuntimeError, OSError: it cannot be evaluated.

    """
    kept = store.keeps(query.text, given.values())
    if kept:
        query, given = _kept(query.text, query.names), {name: mark(term) for name, term in given.items()}
    try:
        text, extra = query.bind(given)
        return store.ask(text, functions={**(functions or {}), **extra}, union=union, kept=kept)
    except SyntaxError:
        # A literal cannot be written as a subject: bound by a function, it merely matches nothing.
        text, extra = query.bind_by_function(given)
        return store.ask(text, functions={**(functions or {}), **extra}, union=union, kept=kept)


@lru_cache(maxsize=1024)
def _kept(text: str, names: frozenset[str]) -> Query:
    return read_query(keep(text).text, names)


def read_query(text: str, names: Iterable[str]) -> Query:
    """Cut ``text``; ``names`` are those of the variables that may be pre-bound."""
    wanted = set(names)
    read = [token for token in tokens(text) if token.kind != "space"]
    manners = _manners(read)
    pieces: list[str | tuple[str, str]] = []
    at = 0
    for place, token in enumerate(read):
        if token.kind != "variable" or token.text[1:] not in wanted or manners[place] == "kept":
            continue
        start, end = token.start, token.end
        if manners[place] == "bound":
            start, end = read[place - 2].start, read[place + 1].end
        pieces += [text[at:start], (token.text[1:], _form(token.text[1:], manners[place], place))]
        at = end
    return Query(text, (*pieces, text[at:]), tuple(_openings(read)), frozenset(wanted))


def _form(name: str, manner: str, place: int) -> str:
    match manner:
        case "bound":
            return "(true)"
        case "grouped":
            return "(\0)"
        case "projected":
            return f"(\0 AS ?{name})"
        case "nested":  # two projections in one scope must not assign the same name
            return f"(\0 AS ?{name}_{place})"
        case _:
            return "\0"


def _manners(read: list[Token]) -> list[str]:
    """How a variable at each place would be replaced."""
    manners = []
    clause, depth, selects = "", 0, 0
    for place, token in enumerate(read):
        word = token.text.upper() if token.kind == "word" else ""
        if word == "SELECT":
            clause, depth = ("nested" if selects else "projected"), 0
            selects += 1
        elif word in {"GROUP", "ORDER"} and place + 1 < len(read) and read[place + 1].text.upper() == "BY":
            clause, depth = "grouped", 0
        elif token.text in {"{", "}"} or word in {"WHERE", "FROM"} or word in _CLAUSE_END:
            clause = ""
        elif clause and token.text in {"(", ")"}:
            depth += 1 if token.text == "(" else -1
        before = read[place - 1].text.upper() if place else ""
        if before == "AS":
            manners.append("kept")
        elif before == "(" and place > 1 and read[place - 2].text.upper() == "BOUND":
            manners.append("bound")
        else:
            manners.append(clause if clause and depth == 0 else "plain")
    return manners


def _openings(read: list[Token]) -> Iterator[int]:
    """The ends of the braces that open a group of patterns."""
    template = False
    for place, token in enumerate(read):
        if token.kind == "word" and token.text.upper() == "CONSTRUCT":
            template = True
        if token.text != "{":
            continue
        following = read[place + 1].text.upper() if place + 1 < len(read) else ""
        if template and read[place - 1].text.upper() == "CONSTRUCT":
            template = False
        elif following != "SELECT" and read[place - 1].text.upper() != "EXISTS":
            yield token.end


def is_joined(text: str, name: str) -> bool:
    """Whether a CONSTRUCT uses ``name`` in the patterns of its outermost group alone.

    Solutions for many nodes can then be had at once: to join with them is to bind them everywhere.
    """
    read = list(tokens(text))
    words = [token.text.upper() for token in read]
    begin = words.index("WHERE") if "WHERE" in words else len(read)
    braces = brackets = 0
    joined = False
    for token in read[begin:]:
        braces += (token.text == "{") - (token.text == "}")
        brackets += (token.text == "(") - (token.text == ")")
        if token.kind == "variable" and token.text[1:] == name:
            if braces != 1 or brackets:
                return False
            joined = True
    return joined and "SELECT" not in words


def unsupported(text: str, names: Iterable[str]) -> tuple[str, Token] | None:
    """What in a query may not stand beside pre-bound variables (appendix A), in words, and where; None for nothing."""
    wanted = set(names)
    read = list(tokens(text))
    for token, following in pairwise([*read, None]):
        assert token is not None  # noqa: S101 - only the last has nothing behind it
        word = token.text.upper() if token.kind == "word" else ""
        if word in {"MINUS", "VALUES"}:
            return f"`{word}` may not stand in the query of a shape", token
        if word == "AS" and following is not None and following.kind == "variable" and following.text[1:] in wanted:
            return f"`{following.text}` is given and cannot be assigned", following
    for place, token in enumerate(read):
        if token.text == "{" and place + 1 < len(read) and read[place + 1].text.upper() == "SELECT":
            missing = wanted - _OPTIONAL - _projected(read, place + 2)
            if missing:
                return f"a subquery does not return `${min(missing)}`", read[place + 1]
    return None


def _projected(read: list[Token], at: int) -> set[str]:
    """The variables that a SELECT returns; of ``*`` those that its patterns bind."""
    found: set[str] = set()
    while at < len(read) and read[at].text != "{":
        if read[at].text == "*" and read[at - 1].text.upper() in {"SELECT", "DISTINCT", "REDUCED"}:
            return _bound_by_patterns(read, at + 1)
        if read[at].kind == "variable":
            found.add(read[at].text[1:])
        at += 1
    return found


def _bound_by_patterns(read: list[Token], at: int) -> set[str]:
    """The variables of the group behind ``at`` that stand outside of brackets, where filters and expressions are."""
    found: set[str] = set()
    braces = brackets = 0
    for place in range(at, len(read)):
        token = read[place]
        braces += (token.text == "{") - (token.text == "}")
        brackets += (token.text == "(") - (token.text == ")")
        if token.kind == "variable" and (brackets == 0 or read[place - 1].text.upper() == "AS"):
            found.add(token.text[1:])
        if braces == 0 and token.text == "}":
            break
    return found
