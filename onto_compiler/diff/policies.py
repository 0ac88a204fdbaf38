"""Which change of a property's values breaks what was written with the old version."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from pyoxigraph import BlankNode, NamedNode

from onto_compiler.diff.structure import Descriptions, Structures
from onto_compiler.rdf import OWL
from onto_compiler.terms import Term

__all__ = ["POLICIES", "Known", "Values"]

Values = Mapping[str, Term]
"""Terms by their key, without those of which both sides have the meaning."""
_DEEP = 20  # class expressions within each other
# A type that says more of a property than that it is one.
_NARROWING = {
    f"<{OWL}{name}Property>"
    for name in ("Functional", "InverseFunctional", "Transitive", "Symmetric", "Asymmetric", "Irreflexive", "Reflexive")
}
_INDIVIDUAL = f"<{OWL}NamedIndividual>"


@dataclass(frozen=True, slots=True)
class Known:
    """The terms of the old side, each class of the new side with its direct superclasses, and class expressions."""

    before: frozenset[str]
    parents: Mapping[str, set[str]]
    found: Descriptions
    keys: Structures

    def holds(self, wide: Term, narrow: Term, depth: int = 0) -> bool:
        """Whether every member of ``narrow`` is known to be one of ``wide``."""
        if depth > _DEEP:
            return False
        if self.keys.key(wide) == self.keys.key(narrow) or wide == NamedNode(OWL + "Thing"):
            return True
        for name, test in ((OWL + "unionOf", all), (OWL + "intersectionOf", any)):
            if (members := self._members(narrow, name)) and test(self.holds(wide, one, depth + 1) for one in members):
                return True
        for name, test in ((OWL + "unionOf", any), (OWL + "intersectionOf", all)):
            if (members := self._members(wide, name)) and test(self.holds(one, narrow, depth + 1) for one in members):
                return True
        return isinstance(wide, NamedNode) and isinstance(narrow, NamedNode) and wide.value in self._above(narrow.value)

    def _members(self, term: Term, name: str) -> tuple[Term, ...]:
        said = self.found.about.get(term, ()) if isinstance(term, BlankNode) else ()
        lists = (value for predicate, value in said if predicate == name and isinstance(value, BlankNode))
        return next((self.found.lists.get(value, ()) for value in lists), ())

    def _above(self, cls: str) -> set[str]:
        reached, waiting = {cls}, [cls]
        while waiting:
            fresh = self.parents.get(waiting.pop(), set()) - reached
            reached |= fresh
            waiting += fresh
        return reached


def _class(gone: Values, come: Values, known: Known) -> bool:
    """A class may give way to one that holds all its members; none at all holds everything."""
    if not gone or not come:
        return bool(come)
    return not all(any(known.holds(after, before) for before in gone.values()) for after in come.values())


def _taken(gone: Values, come: Values, known: Known) -> bool:
    return not gone or not come or _class(gone, come, known)


def _super(gone: Values, come: Values, _: Known) -> bool:
    named = any(isinstance(term, NamedNode) for term in gone.values())
    return named or any(isinstance(term, BlankNode) for term in come.values())


def _type(gone: Values, come: Values, _: Known) -> bool:
    return bool({*gone} - {*_NARROWING, _INDIVIDUAL}) or bool({*come} & _NARROWING)


POLICIES: Mapping[str, Callable[[Values, Values, Known], bool]] = {
    "always": lambda _, __, ___: True,
    "class": _class,
    "less": lambda gone, _, __: bool(gone),
    "more": lambda _, come, __: bool(come),
    "never": lambda _, __, ___: False,
    "super": _super,
    "taken": _taken,
    "type": _type,
}
