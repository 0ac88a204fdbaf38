"""The guard of users' queries, which must not reach the network, change the store, or query graphs that are not in it.

Oxigraph calls the endpoint of a ``SERVICE`` as soon as a query is asked, and it accepts the keyword without a space
after it (``SERVICE:x``, ``SERVICESILENT<x>``), so that cutting the text into tokens decides nothing. Its parser does:
where a query still parses with the word spelled differently wherever it occurs, no occurrence was the keyword.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from pyoxigraph import Store

from onto_compiler.turtle.tokens import Token, tokens

__all__ = ["Refusal", "refusal"]

_SERVICE = re.compile("service", re.IGNORECASE | re.ASCII)
_UPDATES = {"ADD", "CLEAR", "COPY", "CREATE", "DELETE", "DROP", "INSERT", "LOAD", "MOVE", "WITH"}


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a query is not run; ``word`` is the keyword at fault, upper case."""

    code: str
    message: str
    hint: str
    word: str

    def place(self, text: str) -> tuple[int, int]:
        """Where the keyword stands in ``text``, as (index, length)."""
        found = _keyword(text, self.word)
        if found is not None:
            return found.start, found.end - found.start
        at = text.upper().find(self.word)
        return (at, len(self.word)) if at >= 0 else (0, 1)


def refusal(
    query: str, *, prefixes: Mapping[str, str] | None = None, graphs: Container[str] = frozenset()
) -> Refusal | None:
    """Why ``query`` must not be run; None if it may.

    ``prefixes`` need no declaration in it, and ``graphs`` are the IRIs of the named graphs that its FROM may name.

    Raises:
        SyntaxError: the query is not SPARQL, as Oxigraph says it. Only a query that mentions SERVICE is parsed here.

    """
    read = list(tokens(query))
    first = next(_outside_prologue(read), None)
    if first is not None and first.text.upper() in _UPDATES:
        word = first.text.upper()
        message = f"`{word}` is an update, and a query belongs here: nothing is changed or loaded"
        return Refusal("QRY002", message, "write a SELECT, ASK, CONSTRUCT or DESCRIBE query", word)
    if _calls_service(query, prefixes):
        message = "`SERVICE` asks another machine, and no query reaches the network"
        hint = "take the SERVICE out; put the data that it would fetch into a file and name that file beside the others"
        return Refusal("QRY001", message, hint, "SERVICE")
    for graph in _datasets(read, prefixes or {}):
        if graph not in graphs:
            message = f"`FROM` names <{graph}>, which is not among the queried graphs; nothing is fetched"
            return Refusal("QRY003", message, "leave out FROM: all graphs that were read are asked together", "FROM")
    return None


def _calls_service(query: str, prefixes: Mapping[str, str] | None) -> bool:
    if _SERVICE.search(query) is None:
        return False
    harmless = _SERVICE.sub(lambda match: f"{match[0][:4]}x{match[0][5:]}", query)
    try:
        Store().query(harmless, prefixes=dict(prefixes or {}))
    except SyntaxError:
        if _keyword(query, "SERVICE") is None:
            raise
        return True
    except (OSError, RuntimeError, ValueError):
        pass  # it was parsed, and evaluated over nothing
    return False


def _keyword(query: str, word: str) -> Token | None:
    """The first token that holds ``word`` as a keyword, as ``{SERVICE:x {`` does too."""
    for token, following in pairwise([*tokens(query), Token("end", "", 0, 0)]):
        if token.kind == "word" and word in token.text.upper():
            return token
        if token.kind == "name" and following.text == "{" and word in token.text.partition(":")[0].upper():
            return token
    return None


def _outside_prologue(read: list[Token]) -> Iterator[Token]:
    """The tokens behind the last PREFIX or BASE."""
    at = 0
    while at < len(read) and read[at].kind == "word" and read[at].text.upper() in {"BASE", "PREFIX"}:
        at += 2 if read[at].text.upper() == "BASE" else 3
    yield from read[at:]


def _datasets(read: list[Token], prefixes: Mapping[str, str]) -> Iterator[str]:
    """The IRIs behind FROM and FROM NAMED of the outermost query."""
    known = dict(prefixes)
    depth = 0
    for at, token in enumerate(read):
        depth += (token.text == "{") - (token.text == "}")
        word = token.text.upper() if token.kind == "word" else ""
        following = read[at + 1 : at + 3]
        if word == "PREFIX" and len(following) == 2:
            known[following[0].text.removesuffix(":")] = following[1].text.strip("<>")
        elif word == "FROM" and depth == 0:
            named = [one for one in following if one.text.upper() != "NAMED"][:1]
            for one in named:
                prefix, _, local = one.text.partition(":")
                if one.kind == "iri":
                    yield one.text.strip("<>")
                elif one.kind == "name" and prefix in known:
                    yield known[prefix] + local
