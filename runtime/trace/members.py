"""Fields that hold many values as the records of their members: the entries of an observation, named settings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from onto_compiler.record.places import Spot
from onto_compiler.required import Fact
from onto_compiler.tables import ABSENT, STATUSES
from runtime.loop.diagnosis import evidence_status

__all__ = ["Seen", "Setting", "fact_of", "join", "named_values", "settings", "split"]


@dataclass(frozen=True, slots=True)
class Seen:
    """One entry of the arrays of an observation."""

    status: str
    truth: bool | None
    margin: float
    score: float
    limit: str


def _about(spot: Spot) -> str:
    """The IRI of the ABox whose facts an observed one speaks of."""
    premise = f"{spot.top}/premise"
    return premise if spot.iri.startswith(premise) else f"{spot.top}/required"


def split(value: tuple[Any, ...], spot: Spot) -> list[Seen]:
    """The entries of the aligned arrays ``observed``, ``truth``, ``margin``, ``score`` and ``limit``."""
    observed, truth, margin, score, limit = value
    required = spot.holder("required").required
    facts: tuple[Fact, ...] = required.premise if _about(spot).endswith("/premise") else required.facts
    codes = evidence_status(facts, spot.record)
    return [
        # A source without evidence states no truth value.
        Seen(STATUSES[code], holds if seen or holds else None, float(margin[i]), float(score[i]), limit[i])
        for i, (code, seen, holds) in enumerate(zip(codes, map(bool, observed), map(bool, truth), strict=True))
    ]


def join(rows: Sequence[Seen]) -> tuple[Any, ...]:
    """The arrays that :func:`split` took apart."""
    return (
        np.array([row.status != ABSENT for row in rows], dtype=np.bool_),
        np.array([bool(row.truth) for row in rows], dtype=np.bool_),
        np.array([row.margin for row in rows], dtype=np.float64),
        np.array([row.score for row in rows], dtype=np.float64),
        tuple(row.limit for row in rows),
    )


def fact_of(spot: Spot) -> str:
    """The IRI of the fact that an entry speaks of."""
    return f"{_about(spot)}/fact/{spot.iri.rpartition('/')[2]}"


@dataclass(frozen=True, slots=True)
class Setting:
    """A name with its value."""

    name: str
    value: Any


def settings(pairs: Sequence[tuple[str, Any]], spot: Spot) -> list[Setting]:
    """Named values as settings."""
    del spot
    return [Setting(name, value) for name, value in pairs]


def named_values(found: Sequence[Setting]) -> tuple[tuple[str, Any], ...]:
    """Settings as named values."""
    return tuple((each.name, each.value) for each in found)
