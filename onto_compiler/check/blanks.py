"""Which blank node of one parse of a file is which of another, by what each parse says of them.

Every parse gives blank nodes new names. Two nodes are the same where they have the same surroundings, a few steps far;
where several look alike, both parses meet them in the order in which they are written.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable
from typing import Protocol

from pyoxigraph import BlankNode

__all__ = ["Statement", "same_blanks"]

_STEPS = 4


class Statement(Protocol):
    """What has the three parts of a triple."""

    @property
    def subject(self) -> Hashable: ...  # noqa: D102
    @property
    def predicate(self) -> Hashable: ...  # noqa: D102
    @property
    def object(self) -> Hashable: ...  # noqa: D102


def same_blanks(one: Iterable[Statement], other: Iterable[Statement]) -> dict[BlankNode, BlankNode]:
    """Each blank node of ``one`` with its like in ``other``; one without a like is left out."""
    numbers: dict[Hashable, int] = {}
    ours, theirs = _alike(list(one), numbers), _alike(list(other), numbers)
    pairs = (zip(nodes, theirs.get(colour, ()), strict=False) for colour, nodes in ours.items())
    return {own: like for pair in pairs for own, like in pair}


def _alike(statements: list[Statement], numbers: dict[Hashable, int]) -> dict[int, list[BlankNode]]:
    """The blank nodes by their colour (a number for each description, the same in all calls), in their order."""
    touching: defaultdict[BlankNode, list[tuple[Hashable, Hashable, Hashable]]] = defaultdict(list)
    for statement in statements:
        parts = (statement.subject, statement.predicate, statement.object)
        for part in {parts[0], parts[2]}:
            if isinstance(part, BlankNode):
                touching[part].append(parts)
    colours = dict.fromkeys(touching, 0)
    for step in range(_STEPS):
        # A node's own number is part of what is numbered, so that a step only ever tells more nodes apart.
        colours = {
            node: _number((step, colours[node], _described(node, triples, colours)), numbers)
            for node, triples in touching.items()
        }
    found: defaultdict[int, list[BlankNode]] = defaultdict(list)
    for node, colour in colours.items():
        found[colour].append(node)
    return found


def _described(
    node: BlankNode, triples: list[tuple[Hashable, Hashable, Hashable]], colours: dict[BlankNode, int]
) -> Hashable:
    def shown(part: Hashable) -> Hashable:
        if part == node:
            return "self"
        return ("blank", colours[part]) if isinstance(part, BlankNode) else part

    return frozenset((shown(subject), predicate, shown(value)) for subject, predicate, value in triples)


def _number(description: Hashable, numbers: dict[Hashable, int]) -> int:
    return numbers.setdefault(description, len(numbers) + 1)
