"""Turtle written from a tree: blank nodes stand inline and values are sorted, so no label and no order can leak."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from pyoxigraph import BlankNode, NamedNode, Triple

from onto_compiler.rdf import PREFIXES
from onto_compiler.terms import Term

__all__ = ["Blank", "Pair", "Seq", "Value", "block", "iri_text", "prefix_lines", "quoted", "term_text"]

_LOCAL = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_USED = re.compile(r"(?<![\w:<\"/#-])([a-z]+):[A-Za-z_]")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


@dataclass(frozen=True, slots=True)
class Blank:
    """A blank node with its properties."""

    pairs: tuple[Pair, ...]


@dataclass(frozen=True, slots=True)
class Seq:
    """An RDF list."""

    members: tuple[Value, ...]


Value = str | Blank | Seq  # a string is a term as Turtle has it
Pair = tuple[str, Value]


def iri_text(iri: str) -> str:
    """``prefix:local`` where one of our prefixes fits, else the IRI in angle brackets."""
    for prefix, namespace in PREFIXES.items():
        if iri.startswith(namespace) and _LOCAL.fullmatch(iri[len(namespace) :]):
            return f"{prefix}:{iri[len(namespace) :]}"
    return f"<{iri}>"


def quoted(text: str) -> str:
    """A string literal."""
    return '"' + "".join(_ESCAPES.get(character, character) for character in text) + '"'


def term_text(term: Term) -> str:
    """A term as Turtle has it; a blank node without its properties."""
    if isinstance(term, NamedNode):
        return iri_text(term.value)
    if isinstance(term, BlankNode):
        return "[]"
    if isinstance(term, Triple):
        return f"<<( {' '.join(map(term_text, (term.subject, term.predicate, term.object)))} )>>"
    if term.language:
        direction = "" if term.direction is None else f"--{term.direction.value}"
        return f"{quoted(term.value)}@{term.language}{direction}"
    kind = iri_text(term.datatype.value)
    return quoted(term.value) if kind == "xsd:string" else f"{quoted(term.value)}^^{kind}"


def block(subject: str, pairs: Iterable[Pair]) -> str:
    """One subject with its properties, ending in a full stop; properties keep their order, equal ones stand once."""
    return f"{subject} " + " ;\n    ".join(_lines(pairs, 1)) + " .\n"


def prefix_lines(body: str) -> str:
    """``@prefix`` lines for the prefixes that ``body`` uses."""
    code = re.sub(r'"(?:\\.|[^"\\])*"|<[^>]*>', " ", body)
    used = set(_USED.findall(code))
    return "".join(f"@prefix {name}: <{iri}> .\n" for name, iri in sorted(PREFIXES.items()) if name in used)


def _lines(pairs: Iterable[Pair], depth: int) -> Iterator[str]:
    yield from dict.fromkeys(f"{name} {_text(value, depth)}" for name, value in pairs)


def _text(value: Value, depth: int) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Seq):
        return f"( {' '.join(_text(member, depth) for member in value.members)} )" if value.members else "()"
    inner = list(_lines(value.pairs, depth + 1))
    if len(inner) == 1 and "\n" not in inner[0]:
        return f"[ {inner[0]} ]"
    pad = "    " * (depth + 1)
    return f"[\n{pad}" + f" ;\n{pad}".join(inner) + f" ;\n{'    ' * depth}]"
