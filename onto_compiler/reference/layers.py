"""A layered drawing of a directed graph: which column a node stands in, and in which order the columns are filled.

The steps are Sugiyama's: layers by longest path, an order within each layer by the mean place of the neighbours, and
straight columns. A graph of some dozen nodes needs no more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

__all__ = ["crossings", "layers", "ordered"]

Edge = tuple[str, str]
_SWEEPS = 8


def layers(nodes: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """The length of the longest path that ends in each node; an edge that closes a cycle is passed over."""
    above: dict[str, list[str]] = {name: [] for name in nodes}
    for start, end in edges:
        if start != end:
            above[end].append(start)
    depth: dict[str, int] = {}
    open_: set[str] = set()

    def measure(name: str) -> int:
        if name not in depth:
            open_.add(name)
            depth[name] = max((measure(other) + 1 for other in above[name] if other not in open_), default=0)
            open_.discard(name)
        return depth[name]

    for name in nodes:
        measure(name)
    return depth


def ordered(columns: Sequence[Sequence[str]], edges: Sequence[Edge]) -> tuple[tuple[str, ...], ...]:
    """The columns, each in the order in which fewest edges were found to cross."""
    best = [list(column) for column in columns]
    order = [list(column) for column in columns]
    for sweep in range(_SWEEPS):
        forward = sweep % 2 == 0
        for index in range(len(order)) if forward else reversed(range(len(order))):
            place = {name: rank / max(len(column) - 1, 1) for column in order for rank, name in enumerate(column)}
            beside = _neighbours(order[index], order, edges, forward=forward)
            order[index].sort(key=lambda name, beside=beside, place=place: _mean(name, beside, place))  # type: ignore[misc]
        if crossings(order, edges) < crossings(best, edges):
            best = [list(column) for column in order]
    return tuple(tuple(column) for column in best)


def crossings(columns: Sequence[Sequence[str]], edges: Sequence[Edge]) -> int:
    """How many pairs of edges between the same two columns cross."""
    column = {name: i for i, names in enumerate(columns) for name in names}
    rank = {name: i for names in columns for i, name in enumerate(names)}
    pairs = sorted(edges)
    return sum(
        (rank[a] - rank[c]) * (rank[b] - rank[d]) < 0
        for i, (a, b) in enumerate(pairs)
        for c, d in pairs[i + 1 :]
        if column[a] == column[c] and column[b] == column[d]
    )


def _neighbours(
    names: Sequence[str], columns: Sequence[Sequence[str]], edges: Sequence[Edge], *, forward: bool
) -> Mapping[str, list[str]]:
    column = {name: i for i, members in enumerate(columns) for name in members}
    beside: dict[str, list[str]] = {name: [] for name in names}
    for start, end in edges:
        mine, other = (end, start) if forward else (start, end)
        if mine in beside and column[mine] != column[other]:
            beside[mine].append(other)
    return beside


def _mean(name: str, beside: Mapping[str, list[str]], place: Mapping[str, float]) -> float:
    near = beside[name]
    return sum(place[other] for other in near) / len(near) if near else place[name]
