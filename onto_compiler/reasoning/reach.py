"""What lies above each node of a graph with circles, of the nodes that matter alone.

Source: Tarjan, "Depth-first search and linear graph algorithms" (1972), without recursion; the members of one circle
share one answer, and so do nodes that only pass another's on.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

__all__ = ["above", "circles"]

Node = TypeVar("Node")


def circles(edges: Mapping[Node, Sequence[Node]]) -> list[tuple[Node, ...]]:
    """The strongly connected components of ``edges``, each behind those that it leads to."""
    search = _Search(edges)
    for node in edges:
        if node not in search.index:
            search.visit(node)
    return search.found


def above(edges: Mapping[Node, Sequence[Node]], wanted: Collection[Node]) -> dict[Node, frozenset[Node]]:
    """For each node of ``edges``, those of ``wanted`` that it leads to, itself included."""
    result: dict[Node, frozenset[Node]] = {}
    for circle in circles(edges):
        own = frozenset(node for node in circle if node in wanted)
        # A node of the same circle has no answer yet, and adds nothing.
        reached = {id(one): one for node in circle for to in edges.get(node, ()) if (one := result.get(to)) is not None}
        sets = [one for one in reached.values() if one]
        total = sets[0] if len(sets) == 1 and not own else own.union(*sets)
        for node in circle:
            result[node] = total
    return result


@dataclass
class _Search(Generic[Node]):
    edges: Mapping[Node, Sequence[Node]]
    index: dict[Node, int] = field(default_factory=dict)
    low: dict[Node, int] = field(default_factory=dict)
    open: dict[Node, None] = field(default_factory=dict)
    found: list[tuple[Node, ...]] = field(default_factory=list)

    def visit(self, root: Node) -> None:
        trail = [(root, iter(self.edges.get(root, ())))]
        self.enter(root)
        while trail:
            node, further = trail[-1]
            for to in further:
                if to not in self.index:
                    self.enter(to)
                    trail.append((to, iter(self.edges.get(to, ()))))
                    break
                if to in self.open:
                    self.low[node] = min(self.low[node], self.index[to])
            else:
                trail.pop()
                if trail:
                    self.low[trail[-1][0]] = min(self.low[trail[-1][0]], self.low[node])
                if self.low[node] == self.index[node]:
                    self.close(node)

    def enter(self, node: Node) -> None:
        self.index[node] = self.low[node] = len(self.index)
        self.open[node] = None

    def close(self, node: Node) -> None:
        circle: list[Node] = []
        while not circle or circle[-1] != node:
            circle.append(self.open.popitem()[0])
        self.found.append(tuple(circle))
