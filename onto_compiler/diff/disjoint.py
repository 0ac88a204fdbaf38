"""Disjoint classes: what two sides say of pairs, however they write it.

``owl:disjointWith``, ``owl:AllDisjointClasses`` and ``owl:disjointUnionOf`` make groups whose members share nothing.
Groups that both sides have need no pairs, of which there are as many as the square of a group's size.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pyoxigraph import BlankNode, NamedNode, Quad

from onto_compiler.diff.structure import Descriptions
from onto_compiler.rdf import OWL, RDF

__all__ = ["AXIOMS", "DISJOINT", "Groups", "unmatched"]

DISJOINT = OWL + "disjointWith"
AXIOMS = OWL + "AllDisjointClasses"
_LISTED = frozenset((OWL + "members", OWL + "disjointUnionOf"))


@dataclass(frozen=True, slots=True)
class Groups:
    """The groups of one side, and for each class those that hold it."""

    groups: frozenset[frozenset[str]]
    holding: Mapping[str, Sequence[frozenset[str]]]

    @classmethod
    def of(cls, quads: Sequence[Quad], found: Descriptions) -> Groups:
        """Read them from the statements of a side."""
        all_disjoint = {
            quad.subject for quad in quads if quad.object == NamedNode(AXIOMS) and quad.predicate.value == RDF + "type"
        }
        groups: set[frozenset[str]] = set()
        for quad in quads:
            name, subject, value = quad.predicate.value, quad.subject, quad.object
            if name == DISJOINT and isinstance(subject, NamedNode) and isinstance(value, NamedNode):
                groups.add(frozenset((subject.value, value.value)))
            elif (
                name in _LISTED
                and isinstance(value, BlankNode)
                and (subject in all_disjoint or name != OWL + "members")
            ):
                items = found.lists.get(value, ())
                groups.add(frozenset(item.value for item in items if isinstance(item, NamedNode)))
        holding: dict[str, list[frozenset[str]]] = defaultdict(list)
        for group in groups:
            for member in group:
                holding[member].append(group)
        return cls(frozenset(groups), holding)

    def share(self, one: str, other: str) -> bool:
        """Whether some group holds both."""
        return any(other in group for group in self.holding.get(one, ()))


def unmatched(these: Groups, those: Groups) -> Iterator[tuple[str, tuple[str, ...]]]:
    """What only ``these`` say: a class and those that are disjoint with it, each pair once.

    Of a group of three or more that has no likeness among ``those``, all members stand behind the first.
    """
    pairs: dict[str, set[str]] = defaultdict(set)
    for group in sorted(these.groups - those.groups, key=sorted):
        alike = Counter(other for member in group for other in those.holding.get(member, ()))
        nearest = max(alike, key=lambda other: (alike[other], sorted(other)), default=frozenset())
        fresh = group - nearest if len(group & nearest) > 1 else group
        apart = (
            (one, other) for one in sorted(fresh) for other in group if one != other and not those.share(one, other)
        )
        if len(fresh) == len(group) > 2:
            if any(True for _ in apart):
                yield min(group), tuple(sorted(group))
            continue
        for one, other in apart:
            if one not in pairs[other]:
                pairs[one].add(other)
    yield from ((one, tuple(sorted(others))) for one, others in sorted(pairs.items()) if others)
