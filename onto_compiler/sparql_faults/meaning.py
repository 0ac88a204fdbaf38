"""Queries of the right form that mean nothing: what the grammar allows and Oxigraph does not."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from onto_compiler.sparql_faults.fault import Fault, fault_at
from onto_compiler.sparql_faults.words import FUNCTIONS
from onto_compiler.turtle.tokens import SourceText, Token
from onto_compiler.wording import plural

__all__ = ["meaningless"]

_SENTENCE = re.compile(r"(?:expected(?: one of)?|,) ((?:The|BIND|Nested|Duplicate|Aggregate|Prefix|IRI) [^,\[\]]*\w)")
_PLACE = re.compile(r"error at (\d+):(\d+): ")


def meaningless(query: str, read: list[Token], said: str) -> Fault:
    """What Oxigraph says of a query, at the variable or the function that it speaks of."""
    found = _SENTENCE.search(" ".join(said.split()))
    sentence = found[1] if found else ""
    if "unbound" in sentence and (free := _ungrouped(read)) is not None:
        message = f"`{free.text}` is selected, but the groups have no single value for it"
        return fault_at(
            free, message, f"add `{free.text}` to GROUP BY, or take one value of each group, as with SAMPLE"
        )
    if not sentence and (fault := _miscounted(read)) is not None:
        return fault
    if (not sentence or "overrid" in sentence) and (twice := _assigned(read)) is not None:
        return fault_at(twice, f"`{twice.text}` is assigned, but has a value already", "choose another name behind AS")
    place = _PLACE.match(said)
    at = SourceText("", query).offset(int(place[1]), int(place[2])) if place else 0
    token = next((one for one in read if one.start <= at < one.end or one.start >= at), read[-1])
    if sentence.startswith("IRI"):
        token = next((one for one in read if one.kind == "iri" and one.end >= at), token)
        return fault_at(token, f"`{token.text}` is no IRI by itself", "write an absolute IRI, or declare a BASE")
    said = f"{sentence[:1].lower()}{sentence[1:]}" if sentence else f"the query is not SPARQL near `{token.text}`"
    return fault_at(token, said, "compare it with the grammar of SPARQL 1.1")


def _ungrouped(read: list[Token]) -> Token | None:
    """The first variable of a projection that its GROUP BY lacks."""
    words = [token.text.upper() if token.kind == "word" else token.text for token in read]
    grouped = {
        token.text[1:]
        for at, word in enumerate(words)
        if word == "GROUP"
        for token in _until(read[at:], {"HAVING", "ORDER", "LIMIT", "OFFSET", "}", "VALUES"})
        if token.kind == "variable"
    }
    for at, word in enumerate(words):
        if word != "SELECT":
            continue
        depth = 0
        for token in _until(read[at:], {"WHERE", "{", "FROM"}):
            depth += (token.text == "(") - (token.text == ")")
            if token.kind == "variable" and depth == 0 and token.text[1:] not in grouped:
                return token
    return None


def _assigned(read: list[Token]) -> Token | None:
    """The first variable behind an AS that a pattern or an AS before it has too."""
    known: set[str] = set()
    inside = False
    for at, token in enumerate(read):
        inside = inside or token.text == "{"
        if token.kind == "variable":
            assigned = read[at - 1].text.upper() == "AS" if at else False
            if assigned and token.text[1:] in known:
                return token
            if assigned or inside:
                known.add(token.text[1:])
    first = next((at for at, token in enumerate(read) if token.text == "{"), len(read))
    return next(
        (two for one, two in pairwise(read[:first]) if one.text.upper() == "AS" and two.text[1:] in known), None
    )


def _miscounted(read: list[Token]) -> Fault | None:
    """The first function that has too many arguments, or too few."""
    for at, token in enumerate(read[:-1]):
        least, most = FUNCTIONS.get(token.text.upper(), (0, -1)) if token.kind == "word" else (0, -1)
        if most < 0 or read[at + 1].text != "(":
            continue
        depth, commas, anything = 0, 0, False
        for one in read[at + 1 :]:
            depth += (one.text in {"(", "{"}) - (one.text in {")", "}"})
            if depth == 0:
                break
            commas += one.text == "," and depth == 1
            anything = anything or one.text != "("
        found = commas + anything
        if not least <= found <= most:
            wanted = f"{least}" if least == most else f"{least} to {most}"
            return fault_at(token, f"`{token.text}` takes {wanted} {plural(most, 'argument')}, not {found}")
    return None


def _until(read: list[Token], ends: set[str]) -> Iterator[Token]:
    for token in read:
        if token.text.upper() in ends:
            return
        yield token
