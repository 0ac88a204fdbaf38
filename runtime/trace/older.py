"""Reads the format of former versions: vectors, addresses and settings as JSON in a string."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyoxigraph import Literal

from onto_compiler.rdf import XSD, shorten
from onto_compiler.record.places import Subject

__all__ = ["from_json", "pairs", "vector"]


def from_json(term: str, of: Callable[[Any], Any]) -> Callable[[Subject], Any]:
    """A reader of the JSON string that is the value of ``term``; it finds None if there is no such string."""

    def older(subject: Subject) -> Any:  # noqa: ANN401 - whatever ``of`` makes
        found = [
            each for each in subject.all(term) if isinstance(each, Literal) and each.datatype.value == XSD + "string"
        ]
        try:
            return of(json.loads(found[0].value)) if found else None
        except (ValueError, TypeError, AttributeError) as error:
            raise subject.fault(f"has the unusable value `{found[0].value}` of `{shorten(term)}`") from error

    return older


def vector(values: Any) -> NDArray[np.float64]:  # noqa: ANN401 - a list of numbers
    """An array of a list of numbers."""
    return np.array(values, dtype=np.float64)


def pairs(values: Any) -> tuple[tuple[str, Any], ...]:  # noqa: ANN401 - an object of JSON
    """Names with their values."""
    return tuple(values.items())
