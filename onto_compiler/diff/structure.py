"""Blank nodes by what they say: two are the same where their statements are, whatever their labels and their order.

Each blank node gets the number of its class of equal descriptions: from the leaves up, and where blank nodes form a
circle, by refining classes until none splits. The cost is linear in the number of statements outside of circles.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Triple

from onto_compiler.lexical.terms import stored
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH
from onto_compiler.terms import Term

__all__ = ["Descriptions", "Structures"]

_FIRST, _REST, _NIL, _TYPE = (RDF + name for name in ("first", "rest", "nil", "type"))
# Properties whose list is a set: its order means nothing.
UNORDERED = frozenset(
    [OWL + name for name in ("unionOf", "intersectionOf", "oneOf", "members", "distinctMembers", "disjointUnionOf")]
    + [OWL + name for name in ("hasKey", "withRestrictions")]
    + [SH + name for name in ("in", "and", "or", "xone", "ignoredProperties", "languageIn", "union", "intersection")]
)
# What tells people about a shape, and constrains nothing.
_WORDING = frozenset(
    [SH + name for name in ("message", "name", "description", "order", "group")]
    + [RDFS + "label", RDFS + "comment", BASE + "shapes#hint", BASE + "shapes#code"]
)
_Statements = Mapping[BlankNode, Sequence[tuple[str, Term]]]


@dataclass(frozen=True, slots=True)
class Descriptions:
    """The statements about each blank node as (predicate, object), and the members of each well-formed list."""

    about: _Statements
    lists: Mapping[BlankNode, tuple[Term, ...]]

    @classmethod
    def of(cls, quads: Sequence[Quad]) -> Descriptions:
        """Read them; blank nodes of several files have names of their own."""
        about: dict[BlankNode, list[tuple[str, Term]]] = defaultdict(list)
        heads = []
        for quad in quads:
            if isinstance(quad.subject, BlankNode):
                about[quad.subject].append((quad.predicate.value, quad.object))
            if isinstance(quad.object, BlankNode) and quad.predicate.value != _REST:
                heads.append(quad.object)
        cells = {node: cell for node, said in about.items() if (cell := _cell(said)) is not None}
        lists: dict[BlankNode, tuple[Term, ...]] = {}
        inner: set[BlankNode] = set()
        for head in heads:
            if head in cells and head not in lists:
                walked, items = _walk(head, cells)
                if items is not None:
                    lists[head] = items
                    inner |= walked - {head}
        kept = {node: said for node, said in about.items() if node in lists or node not in inner}
        return cls(kept, lists)

    def within(self, term: Term) -> Iterator[BlankNode]:
        """The blank nodes that a term's description is made of."""
        if isinstance(term, BlankNode):
            parts = self.lists.get(term) or [value for _, value in self.about.get(term, ())]
            yield from chain.from_iterable(map(_blanks, parts))


def _cell(said: Sequence[tuple[str, Term]]) -> tuple[Term, Term] | None:
    values = dict(said)
    extra = len(said) - 2 - (values.get(_TYPE) == NamedNode(RDF + "List"))
    return (values[_FIRST], values[_REST]) if not extra and _FIRST in values and _REST in values else None


def _walk(
    head: BlankNode, cells: Mapping[BlankNode, tuple[Term, Term]]
) -> tuple[set[BlankNode], tuple[Term, ...] | None]:
    """The cells of a list, and its members; None where it does not end in ``rdf:nil``."""
    seen: set[BlankNode] = set()
    items = []
    at: Term = head
    while isinstance(at, BlankNode):
        if at in seen or at not in cells:
            return seen, None
        seen.add(at)
        first, at = cells[at]
        items.append(first)
    return seen, tuple(items) if at == NamedNode(_NIL) else None


def _blanks(term: Term) -> Iterator[BlankNode]:
    if isinstance(term, BlankNode):
        yield term
    elif isinstance(term, Triple):
        yield from _blanks(term.subject)
        yield from _blanks(term.object)


@dataclass(slots=True)
class Structures:
    """Keys of terms: equal where the terms say the same.

    With ``meaning``, numbers are equal by value, and messages and names of shapes are left out.
    """

    found: Descriptions
    meaning: bool = False
    _numbers: dict[BlankNode, str] = field(default_factory=dict)
    _interned: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Number every blank node."""
        waiting = {node: set(self.found.within(node)) for node in self.found.about}
        users: dict[BlankNode, list[BlankNode]] = defaultdict(list)
        for node, inner in waiting.items():
            for one in inner:
                users[one].append(node)
        ready = [node for node in {*waiting, *users} if not waiting.get(node)]
        while ready:
            node = ready.pop()
            self._numbers[node] = self._intern(self._signature(node))
            for user in users.get(node, ()):
                waiting[user].discard(node)
                if not waiting[user]:
                    ready.append(user)
        self._refine([node for node, inner in waiting.items() if inner])

    def key(self, term: Term, predicate: str = "") -> str:
        """The key of ``term`` as a value of ``predicate``: an IRI in angle brackets, else something that is none."""
        if isinstance(term, NamedNode):
            return f"<{term.value}>"
        if isinstance(term, Triple):
            return f"<<( {self.key(term.subject)} <{term.predicate.value}> {self.key(term.object)} )>>"
        if isinstance(term, Literal):
            # Its datatype stands beside the value, which a store may spell as one of another datatype.
            return f"{stored(term)} {term.datatype.value}" if self.meaning else str(term)
        if predicate in UNORDERED and term in self.found.lists:
            return f"{{{' '.join(sorted(map(self.key, self.found.lists[term])))}}}"
        return self._numbers.get(term, "[]")

    def _signature(self, node: BlankNode) -> str:
        if node in self.found.lists:
            return f"({' '.join(map(self.key, self.found.lists[node]))})"
        said = self.found.about.get(node, ())
        parts = {f"{name} {self.key(value, name)}" for name, value in said if not self.meaning or name not in _WORDING}
        return f"[{' ; '.join(sorted(parts))}]"

    def _intern(self, signature: str) -> str:
        return self._interned.setdefault(signature, f"_:{len(self._interned)}")

    def _refine(self, circular: Sequence[BlankNode]) -> None:
        """Number what leads into a circle of blank nodes."""
        self._numbers |= dict.fromkeys(circular, "_:")
        classes = 0
        while circular:
            signatures = {node: self._signature(node) for node in circular}
            order = {signature: number for number, signature in enumerate(dict.fromkeys(signatures.values()))}
            self._numbers |= {node: f"_:o{order[signature]}" for node, signature in signatures.items()}
            if len(order) == classes:
                return
            classes = len(order)
