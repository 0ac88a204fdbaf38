"""A finding of a check, before it is located in a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

__all__ = ["Finding", "Term"]

Term = NamedNode | BlankNode | Literal


@dataclass(frozen=True, slots=True)
class Finding:
    """A fault of one triple: ``predicate`` and ``object`` are None if the subject (or all its values) is meant.

    ``message`` and ``hint`` may hold ``{subject}``, ``{object}`` and any name of ``values``; terms are written with the
    prefixes of the file that the finding is then placed in. ``inside`` is the character of the literal ``object`` that
    the fault begins at, and how many it covers.
    """

    code: str
    severity: str
    message: str
    hint: str
    subject: Term | Triple | None
    predicate: Term | None = None
    object: Term | Triple | None = None
    graph: NamedNode | None = None  # where only the triple of one file is meant
    values: Mapping[str, Term | Triple | str] = field(default_factory=dict)
    inside: tuple[int, int] | None = None
    near: str = ""  # the value that a declared name may be meant for
    result: Mapping[str, Any] | None = field(default=None, compare=False)  # of SHACL, as JSON has it
    general: bool = False  # gives way to any other finding of the same triple
