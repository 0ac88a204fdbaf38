"""The classes above each class, found when asked for: a chain of n classes has n (n + 1) / 2 such pairs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

__all__ = ["Hierarchy"]


class Hierarchy(Mapping[str, frozenset[str]]):
    """Class IRI -> the class and all its superclasses, of the declared classes.

    ``above[node]`` are the direct superclasses of a node. Anonymous ones (beginning with ``_:``) are passed through and
    left out of the answer.
    """

    def __init__(self, declared: Sequence[str], above: Mapping[str, Sequence[str]]) -> None:
        self._declared, self._above = dict.fromkeys(declared), above
        self._known: dict[str, frozenset[str]] = {}

    def __getitem__(self, cls: str) -> frozenset[str]:
        if cls not in self._declared:
            raise KeyError(cls)
        if cls not in self._known:
            found, waiting = {cls}, [cls]
            while waiting:
                further = set(self._above.get(waiting.pop(), ())) - found
                found |= further
                waiting += further
            self._known[cls] = frozenset(one for one in found if not one.startswith("_:"))
        return self._known[cls]

    def __contains__(self, cls: object) -> bool:
        return cls in self._declared

    def __iter__(self) -> Iterator[str]:
        return iter(self._declared)

    def __len__(self) -> int:
        return len(self._declared)
