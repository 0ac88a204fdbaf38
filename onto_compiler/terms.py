"""RDF terms in words: how a sentence, a table or a message shows a node, a literal or a triple term."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.problems import clipped
from onto_compiler.rdf import PREFIXES, RDF, RDFS, SH, XSD
from onto_compiler.shacl.values import is_well_formed

__all__ = ["Namespaces", "Sentence", "ShapeOf", "Term", "prefixes_of", "sentence", "show", "text_of"]

Term = NamedNode | BlankNode | Literal | Triple
Namespaces = Iterable[tuple[str, str]]
"""Prefixes with their namespaces; the first that fits is taken."""


@dataclass(frozen=True, slots=True)
class ShapeOf:
    """A shape in a sentence."""

    node: Term


Sentence = str | tuple[str | Term | ShapeOf, ...]
"""A sentence: text, and the terms and shapes that are named in it once it is known where it is read."""

_COMMON = (("rdf", RDF), ("rdfs", RDFS), ("xsd", XSD), ("sh", SH))
_BARE = frozenset(XSD + name for name in ("boolean", "decimal", "double", "integer"))  # what Turtle writes unquoted
_STRING = XSD + "string"
_LOCAL = re.compile(r"[\w:](?:[\w:.-]*[\w:-])?")  # of a name, without what Turtle escapes
_LONG = 60  # characters of a literal that are shown


def text_of(term: Term) -> str:
    """The IRI, the label of a blank node, the lexical form of a literal; of a triple term all three parts."""
    return show(term) if isinstance(term, Triple) else term.value


def show(term: Term, namespaces: Namespaces = (), *, whole: bool = False) -> str:
    """A term as Turtle writes it, with ``namespaces``, or else the usual prefixes; a blank node is ``[]``.

    A long literal is shown without its middle, unless the ``whole`` is wanted.
    """
    namespaces = tuple(namespaces)
    match term:
        case NamedNode():
            return _iri(term.value, prefixes_of(namespaces))
        case Literal():
            return _literal(term, namespaces, whole=whole)
        case Triple():
            parts = (term.subject, term.predicate, term.object)
            return f"<<( {' '.join(show(part, namespaces, whole=whole) for part in parts)} )>>"
        case _:
            return "[]"


def sentence(said: Sentence, name: Callable[[Term], str], shape: Callable[[Term], str]) -> str:
    """A sentence with each of its terms as ``name`` calls it, in backticks, and each shape as ``shape`` does."""
    if isinstance(said, str):
        return said
    parts = (shape(p.node) if isinstance(p, ShapeOf) else p if isinstance(p, str) else f"`{name(p)}`" for p in said)
    return "".join(parts)


@lru_cache(maxsize=64)
def prefixes_of(namespaces: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
    """What :func:`show` writes with: ``namespaces``, and each usual prefix whose name they leave free."""
    known: dict[str, str] = {}
    for prefix, namespace in (*namespaces, *_COMMON, *PREFIXES.items()):
        known.setdefault(prefix, namespace)
    return tuple(known.items())


def _iri(iri: str, namespaces: Iterable[tuple[str, str]]) -> str:
    for prefix, namespace in namespaces:
        local = iri.removeprefix(namespace) if namespace else iri
        if local != iri and _LOCAL.fullmatch(local):
            return f"{prefix}:{local}"
    return f"<{iri}>"


def _literal(term: Literal, namespaces: Namespaces, *, whole: bool) -> str:
    datatype, text = term.datatype.value, term.value if whole else clipped(term.value, _LONG)
    if term.language is not None:
        return f"{_quoted(text)}@{term.language}{_direction(term)}"
    if datatype in _BARE and _is_bare(term):
        return text
    return _quoted(text) if datatype == _STRING else f"{_quoted(text)}^^{show(term.datatype, namespaces)}"


def _direction(term: Literal) -> str:
    return "" if term.direction is None else f"--{term.direction.value}"


def _is_bare(term: Literal) -> bool:
    """Whether Turtle reads the lexical form without quotation marks as this very literal."""
    text, kind = term.value, term.datatype.value.removeprefix(XSD)
    if kind == "boolean":
        return text in {"true", "false"}
    exponent = "e" in text.lower()
    shape = "double" if exponent else "decimal" if "." in text else "integer"
    return shape == kind and is_well_formed(term) and not text.endswith(".")


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\r", "\\r")
    return f'"{escaped}"'
