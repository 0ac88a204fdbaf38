"""Whether one version is above another: by its numbers or its date; a version IRI without either, where it is another.

The numbers of an IRI may stand anywhere in it: ``.../1.4/Brick``, ``.../gistCore13.0.0``, ``.../2024-05-01/``.
"""

from __future__ import annotations

import re

from onto_compiler.diff.sides import Version

__all__ = ["raised"]

_NUMBERS = re.compile(r"\d+(?:[.-]\d+)*")
_YEAR = 1000  # a number from here on is a year, and any later date is a new version


def raised(before: Version, after: Version) -> bool:
    """Whether ``owl:versionInfo`` or ``owl:versionIRI`` says that the later version may break users of the earlier."""
    if before.info and after.info and _is_above(before.info, after.info):
        return True
    if not before.iri or not after.iri or before.iri == after.iri:
        return False
    olds, news = (_NUMBERS.findall(iri) for iri in (before.iri, after.iri))
    same = all(old == new for old, new in zip(olds, news, strict=False))  # `alpha` and `beta` have no order
    return same or _is_above(before.iri, after.iri)


def _is_above(before: str, after: str) -> bool:
    """Whether the first numbers that differ rise: in the major part, or below 1.0 in the minor part."""
    olds, news = ([_parts(numbers) for numbers in _NUMBERS.findall(text)] for text in (before, after))
    for old, new in zip(olds, news, strict=False):
        if old != new:
            if old[0] >= _YEAR:
                return new > old
            return new[0] > old[0] or (new[0] == old[0] == 0 and new[1:2] > old[1:2])
    return False


def _parts(numbers: str) -> tuple[int, ...]:
    return tuple(map(int, re.split(r"[.-]", numbers)))
