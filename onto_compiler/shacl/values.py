"""Literals: whether a lexical form belongs to a datatype, and which of two values is the lesser.

Source: XML Schema 1.1, part 2, sections 3.3 and 3.4; SPARQL 1.1, section 17.3, for what may be compared.
"""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from functools import cache, lru_cache
from math import isnan

from pyoxigraph import Literal

from onto_compiler.rdf import RDF, XSD

__all__ = ["is_well_formed", "less", "number"]

_DECIMAL = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)"
_FLOAT = rf"(?:{_DECIMAL}(?:[eE][+-]?\d+)?|[+-]?INF|NaN)"
_ZONE = r"(?P<zone>Z|[+-](?:(?:0\d|1[0-3]):[0-5]\d|14:00))?"
_YEAR = r"(?P<year>-?(?:[1-9]\d{3,}|0\d{3}))"
_MONTH, _DAY = r"(?P<month>0[1-9]|1[0-2])", r"(?P<day>0[1-9]|[12]\d|3[01])"
_DATE = f"{_YEAR}-{_MONTH}-{_DAY}"
_TIME = r"(?:(?P<hour>[01]\d|2[0-3]):(?P<minute>[0-5]\d):(?P<second>[0-5]\d(?:\.\d+)?)|(?P<midnight>24:00:00(?:\.0+)?))"
_DAY_TIME = r"(?:\d+D)?(?:T(?=\d)(?:\d+H)?(?:\d+M)?(?:\d+(?:\.\d+)?S)?)?"
_PATTERNS = {
    "anyURI": r"(?s:.*)",  # whatever may be escaped (part 2, section 3.3.17)
    "base64Binary": r"(?:(?:[A-Za-z0-9+/] ?){4})*(?:(?:[A-Za-z0-9+/] ?){2}= ?=|(?:[A-Za-z0-9+/] ?){3}=)?",
    "boolean": r"true|false|1|0",
    "date": _DATE + _ZONE,
    "dateTime": _DATE + "T" + _TIME + _ZONE,
    "dateTimeStamp": _DATE + "T" + _TIME + _ZONE.removesuffix("?"),
    "dayTimeDuration": rf"-?P(?=[\dT]){_DAY_TIME}",
    "decimal": _DECIMAL,
    "double": _FLOAT,
    "duration": rf"-?P(?=[\dT])(?:\d+Y)?(?:\d+M)?{_DAY_TIME}",
    "float": _FLOAT,
    "gDay": "---" + _DAY + _ZONE,
    "gMonth": "--" + _MONTH + _ZONE,
    "gMonthDay": f"--{_MONTH}-{_DAY}" + _ZONE,
    "gYear": _YEAR + _ZONE,
    "gYearMonth": f"{_YEAR}-{_MONTH}" + _ZONE,
    "hexBinary": r"(?:[0-9A-Fa-f]{2})*",
    "integer": r"[+-]?\d+",
    "language": r"[A-Za-z]{1,8}(?:-[A-Za-z0-9]{1,8})*",
    "Name": r"[^\W\d][\w.\-:\u00b7]*|:[\w.\-:\u00b7]*",
    "NCName": r"[^\W\d][\w.\-\u00b7]*",
    "NMTOKEN": r"[\w.\-:\u00b7]+",
    "normalizedString": r"[^\t\n\r]*",
    "time": _TIME + _ZONE,
    "token": r"(?:[^\s]+(?: [^\s]+)*)?",
    "yearMonthDuration": r"-?P(?=\d)(?:\d+Y)?(?:\d+M)?",
}
_BOUNDS: dict[str, tuple[int | None, int | None]] = {
    "byte": (-(2**7), 2**7 - 1),
    "int": (-(2**31), 2**31 - 1),
    "long": (-(2**63), 2**63 - 1),
    "negativeInteger": (None, -1),
    "nonNegativeInteger": (0, None),
    "nonPositiveInteger": (None, 0),
    "positiveInteger": (1, None),
    "short": (-(2**15), 2**15 - 1),
    "unsignedByte": (0, 2**8 - 1),
    "unsignedInt": (0, 2**32 - 1),
    "unsignedLong": (0, 2**64 - 1),
    "unsignedShort": (0, 2**16 - 1),
}
_ANY_LETTER = {"Name", "NCName", "NMTOKEN"}
_EXACT = {"integer", "decimal", *_BOUNDS}
_DATED = {"date", "dateTime", "dateTimeStamp", "gMonthDay"}
_TIMES = {*_DATED, "time", "gDay", "gMonth", "gYear", "gYearMonth"}
_DURATIONS = {"duration", "dayTimeDuration", "yearMonthDuration"}
_LEAP = 2000  # a year in which each day of a month exists
_REFERENCES = ((1696, 9), (1697, 2), (1903, 3), (1903, 7))  # years and months that a duration is added to
_FOURTEEN_HOURS = Fraction(14 * 3600)
_DURATION = re.compile(r"(-)?P(?:(\d+)Y)?(?:(\d+)M)?(?:(\d+)D)?(?:T(?:(\d+)H)?(?:(\d+)M)?(?:(\d+(?:\.\d+)?)S)?)?")

Key = tuple[str, object, bool]  # what it may be compared with, the value, and whether a time has a zone


@cache
def _form(name: str) -> re.Pattern[str] | None:
    """The lexical forms of a datatype, compiled when they are first asked for; None outside XML Schema."""
    pattern = _PATTERNS.get(name)
    return None if pattern is None else re.compile(pattern, 0 if name in _ANY_LETTER else re.ASCII)


@lru_cache(maxsize=65536)
def is_well_formed(literal: Literal) -> bool:
    """Whether the lexical form is one of the datatype's; of a datatype outside XML Schema nothing is known."""
    datatype = literal.datatype.value
    if datatype == RDF + "langString":
        return literal.language is not None
    name = datatype.removeprefix(XSD)
    text = literal.value
    form = _form("integer" if name in _BOUNDS else name)
    if form is None:
        return True
    match = form.fullmatch(text)
    if match is None:
        return False
    if name in _BOUNDS:
        least, most = _BOUNDS[name]
        number = Decimal(text)
        return (least is None or number >= least) and (most is None or number <= most)
    return name not in _DATED or int(match["day"]) <= _days(match)


def _days(match: re.Match[str]) -> int:
    """How many days the month of a matched date has."""
    year, month = int(match.groupdict().get("year") or _LEAP), int(match["month"])
    leap = year % 4 == 0 and (year % 100 != 0 or year % 400 == 0)
    return (31, 28 + leap, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)[month - 1]


def less(left: Literal, right: Literal, *, or_equal: bool = False) -> bool:
    """Whether ``left < right`` (or ``<=``) holds; false where the two cannot be compared."""
    first, second = _key(left), _key(right)
    if first is None or second is None or first[0] != second[0]:
        return False
    (_, one, zoned), (_, other, zoned_too) = first, second
    if zoned != zoned_too:
        # A time without a zone may lie 14 hours to either side: only what holds in every zone is known.
        return bool(one + _FOURTEEN_HOURS < other)  # type: ignore[operator]
    if isinstance(one, tuple) and isinstance(other, tuple):  # some durations are of any length
        return all(a < b for a, b in zip(one, other, strict=True)) or (or_equal and one == other)
    if isinstance(one, float) or isinstance(other, float):
        one, other = float(one), float(other)  # type: ignore[arg-type]
    return bool(one < other or (or_equal and one == other))  # type: ignore[operator]


def number(literal: Literal) -> Fraction | float | None:
    """A numeric literal's value; None if it is no number, or not a number."""
    found = _key(literal)
    return found[1] if found is not None and found[0] == "number" else None  # type: ignore[return-value]


@lru_cache(maxsize=65536)
def _key(literal: Literal) -> Key | None:
    if not is_well_formed(literal):
        return None
    name, text = literal.datatype.value.removeprefix(XSD), literal.value
    if name in _EXACT:
        return ("number", Fraction(Decimal(text)), True)
    if name in {"double", "float"}:
        return _inexact(text)
    if name in {"string", "boolean"}:
        return (name, text if name == "string" else text in {"true", "1"}, True)
    if name in _TIMES:
        return _timestamp(name.removesuffix("Stamp"), text)
    return ("duration", _duration(text), True) if name in _DURATIONS else None


def _inexact(text: str) -> Key | None:
    number = float(text.replace("INF", "inf"))
    return None if isnan(number) else ("number", number, True)


def _timestamp(kind: str, text: str) -> Key | None:
    """Seconds on a line; years before 1 and beyond 9999 are placed by whole cycles of 400 years."""
    form = _form(kind)
    match = None if form is None else form.fullmatch(text)
    if match is None:
        return None
    parts = match.groupdict()
    seconds = Fraction(_month(int(parts.get("year") or _LEAP), int(parts.get("month") or 1)))
    seconds += (int(parts.get("day") or 1) - 1) * 86400
    if parts.get("midnight"):
        seconds += 86400 if kind == "dateTime" else 0
    elif parts.get("hour"):
        seconds += int(parts["hour"]) * 3600 + int(parts["minute"]) * 60 + Fraction(parts["second"])
    zone = parts.get("zone")
    if zone and zone != "Z":
        offset = timedelta(hours=int(zone[1:3]), minutes=int(zone[4:6]))
        seconds -= int(offset.total_seconds()) * (1 if zone[0] == "+" else -1)
    return (kind, seconds, zone is not None)


def _duration(text: str) -> tuple[Fraction, ...]:
    """Seconds from each of the four :data:`_REFERENCES` to the time that lies the duration behind it.

    Source: XML Schema 1.1, part 2, section 3.3.6.1: one duration is less than another where it is from all four.
    """
    match = _DURATION.fullmatch(text)
    assert match is not None  # noqa: S101 - the form was matched before
    sign, years, months, days, hours, minutes, seconds = match.groups()
    whole = int(years or 0) * 12 + int(months or 0)
    rest = Fraction(int(days or 0) * 86400 + int(hours or 0) * 3600 + int(minutes or 0) * 60) + Fraction(seconds or 0)
    if sign:
        whole, rest = -whole, -rest
    return tuple(_month(year, month + whole) - _month(year, month) + rest for year, month in _REFERENCES)


def _month(year: int, month: int) -> int:
    """Seconds from the beginning of a cycle of 400 years to that of a month, which may lie beyond the year."""
    cycles, year = divmod(year + (month - 1) // 12, 400)
    begin = datetime(year + _LEAP, (month - 1) % 12 + 1, 1, tzinfo=UTC)
    return ((begin - datetime(_LEAP, 1, 1, tzinfo=UTC)).days + cycles * 146097) * 86400
