"""Regular expressions of XPath, which ``sh:pattern`` speaks: in Python's own where both mean the same.

Source: XQuery and XPath Functions and Operators 3.1, section 5.6.1 (flags, and where ``$`` matches).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import cast

from pyoxigraph import Literal, QuerySolutions, Store

__all__ = ["matcher"]

_FLAGS = {"i": re.IGNORECASE, "s": re.DOTALL, "m": re.MULTILINE, "x": re.VERBOSE}
_XPATH_ONLY = re.compile(r"\\[pPiIcC]|-\[")  # what Python's expressions do not know


def matcher(pattern: str, flags: str = "") -> Callable[[str], bool]:
    """A test whether a text has a match of ``pattern``; Oxigraph runs what Python's expressions do not know.

    Raises:
        ValueError: the pattern or the flags are none; says so in a clause.
    """
    if "q" in flags:
        pattern, flags = re.escape(pattern), flags.replace("q", "")
    if _XPATH_ONLY.search(pattern):
        return _oxigraph_matcher(pattern, flags)
    if set(flags) - _FLAGS.keys():
        raise ValueError(f"`{flags}` are no flags of a pattern")
    combined = 0
    for flag in flags:
        combined |= _FLAGS[flag]
    try:
        expression = re.compile(pattern if "m" in flags else _strict_end(pattern), combined)
    except (re.error, OverflowError, RecursionError) as error:
        raise ValueError(f"the pattern is not a regular expression: {error}") from error
    return lambda text: expression.search(text) is not None


def _strict_end(pattern: str) -> str:
    """``$`` also matches before a last line break in Python, and nowhere but at the end in XPath."""
    written, escaped, inside = "", False, False
    for character in pattern:
        if character == "$" and not escaped and not inside:
            written += r"\Z"
        else:
            written += character
        if not escaped:
            inside = (inside or character == "[") and character != "]"
        escaped = character == "\\" and not escaped
    return written


def _oxigraph_matcher(pattern: str, flags: str) -> Callable[[str], bool]:
    store, known = Store(), dict[str, bool]()
    head, tail = "SELECT (REGEX(", f", {Literal(pattern)}, {Literal(flags)}) AS ?matches) WHERE {{}}"

    def match(text: str) -> bool:
        if text not in known:
            (row,) = cast("QuerySolutions", store.query(head + str(Literal(text)) + tail))
            if row["matches"] is None:
                raise ValueError("the pattern is no regular expression")
            known[text] = row["matches"].value == "true"
        return known[text]

    match("")
    return match
