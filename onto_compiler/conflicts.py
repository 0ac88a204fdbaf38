"""Whether two facts exclude each other, and whether achieving one satisfies the other.

They exclude each other by opposite polarity, or as sides of one joint that do not meet.
"""

from __future__ import annotations

from onto_compiler.required import Fact
from onto_compiler.schema import JointThreshold, Schema

__all__ = ["entails", "exclude"]


def exclude(one: Fact, other: Fact, schema: Schema) -> bool:
    """Whether ``one`` and ``other`` cannot both be satisfied; False if nothing that is declared says so."""
    if one.predicate == other.predicate and one.arguments == other.arguments:
        return one.polarity != other.polarity
    first, second = _side(one, schema), _side(other, schema)
    if first is None or second is None or one.arguments[0] != other.arguments[0]:
        return False
    (a, every_a), (b, every_b) = first, second
    # Where either asks for any joint only, two joints could satisfy the two.
    return (every_a or every_b) and not _meet(a, b)


def entails(one: Fact, other: Fact, schema: Schema) -> bool:
    """Whether bringing about ``one`` satisfies ``other``.

    They say the same, or ``one`` moves an object elsewhere than where ``other`` forbids it to be.
    """
    if one.predicate == other.predicate and one.arguments == other.arguments:
        return one.polarity == other.polarity
    if other.polarity or not one.polarity:
        return False
    moved, placed = schema.predicates[one.predicate].moves, schema.predicates[other.predicate].moves
    return moved is not None and placed is not None and one.arguments[moved] == other.arguments[placed]


Interval = tuple[float, bool, float, bool]  # low, whether it is in, high, whether it is in


def _side(fact: Fact, schema: Schema) -> tuple[Interval, bool] | None:
    """The joint positions that satisfy a fact, and whether every joint must be there; None for other facts."""
    thresholds = (schema.threshold(argument.type) for argument in fact.arguments[1:])
    threshold: JointThreshold | None = next((each for each in thresholds if each is not None), None)
    if threshold is None:
        return None
    above = threshold.above == fact.polarity
    inclusive = threshold.inclusive == fact.polarity
    bound = threshold.bound
    interval = (bound, inclusive, float("inf"), False) if above else (float("-inf"), False, bound, inclusive)
    # "Not open" is said of every joint where "open" is said of any.
    return interval, threshold.every_joint == fact.polarity


def _meet(a: Interval, b: Interval) -> bool:
    low, low_in = max((a[0], not a[1]), (b[0], not b[1]))
    high, high_in = min((a[2], a[3]), (b[2], b[3]))
    return low < high or (low == high and not low_in and high_in)
