"""What a literal's text means: whether its datatype allows it, and how two literals compare.

Source: XML Schema 1.1 part 2 (lexical spaces); SPARQL 1.1, section 17.3 (which literals ``<`` can compare).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import datetime
from decimal import Decimal

from pyoxigraph import Literal

from onto_compiler.rdf import XSD

__all__ = ["Comparable", "comparable", "number", "well_formed"]

Comparable = tuple[str, float | Decimal | int | str | bool | datetime]

_INTEGER = r"[+-]?[0-9]+"
_ZONE = r"(Z|[+-](0[0-9]|1[0-4]):[0-5][0-9])?"
_DATE = r"[0-9]{4}-[0-9]{2}-[0-9]{2}"
_FLOATING = r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?|[+-]?INF|NaN"
_FORMS = {
    XSD + name: re.compile(form)
    for name, form in {
        "boolean": r"true|false|0|1",
        "decimal": r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)",
        "double": _FLOATING,
        "float": _FLOATING,
        "date": _DATE + _ZONE,
        "dateTime": rf"{_DATE}T[0-9]{{2}}:[0-9]{{2}}:[0-9]{{2}}(\.[0-9]+)?{_ZONE}",
    }.items()
}
_RANGES: dict[str, tuple[int | None, int | None]] = {
    XSD + name: bounds
    for name, bounds in {
        "integer": (None, None),
        "nonNegativeInteger": (0, None),
        "positiveInteger": (1, None),
        "nonPositiveInteger": (None, 0),
        "negativeInteger": (None, -1),
        "long": (-(2**63), 2**63 - 1),
        "int": (-(2**31), 2**31 - 1),
        "short": (-(2**15), 2**15 - 1),
        "byte": (-(2**7), 2**7 - 1),
        "unsignedLong": (0, 2**64 - 1),
        "unsignedInt": (0, 2**32 - 1),
        "unsignedShort": (0, 2**16 - 1),
        "unsignedByte": (0, 2**8 - 1),
    }.items()
}
_WHOLE = re.compile(_INTEGER)
_LONGEST = 4000  # digits
_MOMENTS = {XSD + "date", XSD + "dateTime"}


def well_formed(text: str, datatype: str) -> bool:
    """Whether ``text`` is in the lexical space of ``datatype``; of a datatype that is not known here all are."""
    if datatype in _RANGES:
        least, most = _RANGES[datatype]
        if not _WHOLE.fullmatch(text):
            return False
        # Python refuses to read an integer of thousands of digits, and no bounded type has one.
        short = len(text) <= _LONGEST
        return (least is None or (short and int(text) >= least)) and (most is None or (short and int(text) <= most))
    form = _FORMS.get(datatype)
    if form is None:
        return True
    return form.fullmatch(text) is not None and (datatype not in _MOMENTS or _moment(text) is not None)


def number(literal: Literal) -> float | int | Decimal | None:
    """A numeric literal's value, or None."""
    found = comparable(literal)
    return found[1] if found is not None and found[0] == "number" else None  # type: ignore[return-value]


def comparable(literal: Literal) -> Comparable | None:
    """A value that ``<`` is defined for, with the kind that it can be compared within; None where there is none."""
    datatype, text = literal.datatype.value, literal.value
    read = _READERS.get(datatype)
    return None if read is None or not well_formed(text, datatype) else read(text)


def _whole(text: str) -> Comparable | None:
    return ("number", int(text)) if len(text) <= _LONGEST else None


def _floating(text: str) -> Comparable:
    return "number", float(text.replace("INF", "inf"))


def _dated(text: str) -> Comparable | None:
    found = _moment(text)
    # Without a zone a moment has no fixed place among those that have one.
    return None if found is None else (f"{'T' in text} {found.tzinfo is not None}", found)


def _moment(text: str) -> datetime | None:
    try:
        if "T" in text:
            return datetime.fromisoformat(text)
        return datetime.fromisoformat(f"{text[:10]}T00:00:00{text[10:]}")
    except ValueError:
        return None


_READERS: dict[str, Callable[[str], Comparable | None]] = {
    **dict.fromkeys(_RANGES, _whole),
    **dict.fromkeys(_MOMENTS, _dated),
    **dict.fromkeys((XSD + "double", XSD + "float"), _floating),
    XSD + "boolean": lambda text: ("boolean", text in {"true", "1"}),
    XSD + "decimal": lambda text: ("number", Decimal(text)),
    XSD + "string": lambda text: ("string", text),
}
