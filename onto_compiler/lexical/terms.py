"""Literals that Oxigraph would spell again, or finds too long to compute with, in a spelling that it leaves alone."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from typing import Any, TypeVar, cast

from pyoxigraph import Literal, NamedNode, Quad, Store, Triple

from onto_compiler.rdf import XSD, double

__all__ = ["mark", "respelled", "stored", "unmark", "value"]

_MARK = "urn:onto-evwm:written:"
_TEXTS = frozenset(XSD + name for name in ("string", "anyURI", "normalizedString", "token", "language"))
# Short numbers that Oxigraph writes as they stand: most literals are known to be sound without asking it.
_NUMBERS = frozenset(XSD + name for name in ("integer", "decimal", "double"))
_PLAIN = re.compile(r"(?!-0\Z)-?(?:0|[1-9][0-9]{0,6})(?:\.[0-9]{0,6}[1-9])?")
_EXACT = re.compile(r"([+-]?[0-9]+)(?:\.([0-9]*))?")
_BOUNDED = frozenset(
    (
        "integer",
        "decimal",
        "nonNegativeInteger",
        "positiveInteger",
        "negativeInteger",
        "nonPositiveInteger",
        "unsignedLong",
    )
)
_LONG, _DIGITS, _PLACES = 2**63, 19, 18
_SCRATCH = NamedNode("urn:onto-evwm:term")
_Any = TypeVar("_Any")


def mark(term: _Any) -> _Any:
    """``term`` with every literal that Oxigraph would spell anew under a datatype of ours; most stay as they are."""
    if isinstance(term, Literal):
        return _marked(term) if _may_differ(term) and respelled((term,)) else term  # type: ignore[return-value]
    if isinstance(term, Triple):
        return Triple(mark(term.subject), term.predicate, mark(term.object))  # type: ignore[return-value]
    return term


def unmark(term: _Any) -> _Any:
    """What :func:`mark` was given."""
    if isinstance(term, Literal):
        datatype = term.datatype.value
        if datatype.startswith(_MARK):
            return Literal(term.value, datatype=NamedNode(datatype[len(_MARK) :]))  # type: ignore[return-value]
    elif isinstance(term, Triple):
        return Triple(unmark(term.subject), term.predicate, unmark(term.object))  # type: ignore[return-value]
    return term


def value(term: _Any) -> _Any:
    """What Oxigraph can compute with in the place of a marked term: a number too long for it becomes a double."""
    plain = unmark(term)
    if isinstance(plain, Literal) and plain is not term and _is_too_long(plain):
        return double(float(plain.value))  # type: ignore[return-value]
    return plain


def stored(literal: Literal) -> Literal:
    """``literal`` as Oxigraph spells it: equal for two spellings of one value, such as ``1.50`` and ``1.5``."""
    return _stored(literal) if _may_differ(literal) else literal


@lru_cache(maxsize=65536)
def _marked(literal: Literal) -> Literal:
    return Literal(literal.value, datatype=NamedNode(_MARK + literal.datatype.value))


def _may_differ(literal: Literal) -> bool:
    datatype = literal.datatype.value
    if not datatype.startswith(XSD) or datatype in _TEXTS:
        return False
    return datatype not in _NUMBERS or _PLAIN.fullmatch(literal.value) is None


def respelled(terms: Iterable[Any]) -> bool:
    """Whether one of ``terms`` is, or holds, a literal that Oxigraph spells again."""
    literals: set[Literal] = set()
    for term in terms:
        if isinstance(term, Literal):
            if _may_differ(term):
                literals.add(term)
        elif isinstance(term, Triple) and respelled((term.subject, term.object)):
            return True
    return any(_is_respelled(literal) for literal in literals)


def _is_too_long(literal: Literal) -> bool:
    """Whether a number is beyond Oxigraph's 64 bits of an integer, or 128 bits and 18 places of a decimal."""
    number = _EXACT.fullmatch(literal.value)
    if number is None:
        return False
    whole, places = number.groups(default="")
    if literal.datatype.value == XSD + "decimal":
        return len(places.rstrip("0")) > _PLACES or len(whole.lstrip("+-0")) > _PLACES
    digits = whole.lstrip("+-0")
    return not places and (len(digits) > _DIGITS or abs(int(whole)) >= _LONG)


@lru_cache(maxsize=65536)
def _is_respelled(literal: Literal) -> bool:
    if literal.datatype.value.removeprefix(XSD) in _BOUNDED and _is_too_long(literal):
        return True
    return bool(_stored(literal) != literal)


@lru_cache(maxsize=65536)
def _stored(literal: Literal) -> Literal:
    store = Store()
    store.add(Quad(_SCRATCH, _SCRATCH, literal))
    return cast("Literal", next(iter(store)).object)
