"""The place of a record: the IRI and graph that it is written to, and the subject that it is read from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Store

from onto_compiler.problems import OntoError
from onto_compiler.rdf import RDF, node, shorten

__all__ = ["Known", "Spot", "Statement", "Subject", "Term"]

Term = NamedNode | Literal | BlankNode
Statement = tuple[str, str, str, Term]
"""Graph, subject and property as IRIs, and the value."""


@dataclass(frozen=True, slots=True)
class Known:
    """The context of forms while they write.

    ``thresholds``: IRIs that stand as arguments and are no entities of a scene; ``routes``: IRIs by the names and IRIs
    that proposers give; ``origins``: for an observed ABox, what made it and the observation before it, by its IRI.
    """

    thresholds: frozenset[str] = frozenset()
    routes: Mapping[str, str] = field(default_factory=dict)
    origins: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Spot:
    """The place of ``record`` in a graph, below the one that holds it and, at last, below the IRI ``top``."""

    record: Any
    iri: str
    graph: str
    top: str
    known: Known
    above: Spot | None = None

    def path(self, pattern: str, number: int | None = None) -> str:
        """The IRI that ``pattern`` leads to: from the top (``/required``), from above (``../x``) or from here."""
        step = pattern.replace("{}", str(getattr(self.record, "index", "") if number is None else number))
        if step.startswith("/"):
            return self.top + step
        return f"{self.iri.rpartition('/')[0]}{step[2:]}" if step.startswith("../") else f"{self.iri}/{step}"

    def part(self, record: Any, iri: str, graph: str) -> Spot:  # noqa: ANN401 - of any class
        """The place of a record that this one holds."""
        return Spot(record, iri, graph or self.graph, self.top, self.known, self)

    def holder(self, name: str) -> Any:  # noqa: ANN401 - as above
        """The nearest record that holds this one, or is it, and has a field ``name``."""
        spot: Spot | None = self
        while spot is not None and not hasattr(spot.record, name):
            spot = spot.above
        return None if spot is None else spot.record

    def say(self, predicate: str, *values: Term) -> Iterator[Statement]:
        """Statements of this record."""
        for value in values:
            yield self.graph, self.iri, predicate, value


@dataclass(frozen=True, slots=True)
class Subject:
    """A subject of a store and what is said of it, in whatever graph; ``shared`` is what was read of it before."""

    store: Store
    iri: str
    shared: dict[str, Any] = field(default_factory=dict)

    def all(self, predicate: str) -> list[Term]:
        """Every value of ``predicate``, in the order of their text."""
        quads = self.store.quads_for_pattern(node(self.iri), node(predicate), None, None)
        return sorted({cast("Term", quad.object) for quad in quads}, key=str)

    def one(self, predicate: str) -> Term | None:
        """The one value of ``predicate``, if there is any; raises TRC003 if there are several."""
        found = self.all(predicate)
        if len(found) > 1:
            raise self.fault(f"has {len(found)} values of `{shorten(predicate)}` where one is allowed")
        return found[0] if found else None

    def need(self, predicate: str) -> Term:
        """As :meth:`one`, of a statement that must be there; raises TRC003 if it is not."""
        found = self.one(predicate)
        if found is None:
            raise self.fault(f"lacks `{shorten(predicate)}`")
        return found

    def at(self, iri: str) -> Subject:
        """Another subject of the same store."""
        return Subject(self.store, iri, self.shared)

    def follow(self, predicate: str) -> list[Subject]:
        """The resources that ``predicate`` leads to."""
        return [self.at(term.value) for term in self.all(predicate) if isinstance(term, NamedNode)]

    def back(self, predicate: str) -> list[Subject]:
        """The resources from which ``predicate`` leads here."""
        quads = self.store.quads_for_pattern(None, node(predicate), node(self.iri), None)
        return [self.at(iri) for iri in sorted({q.subject.value for q in quads if isinstance(q.subject, NamedNode)})]

    def is_a(self, kind: str) -> bool:
        """Whether ``kind`` is stated as a class of it."""
        pattern = self.store.quads_for_pattern(node(self.iri), node(RDF + "type"), node(kind), None)
        return next(pattern, None) is not None

    @property
    def number(self) -> int:
        """The number that ends the IRI; raises TRC003 if none does."""
        digits = self.iri.rpartition("/")[2]
        if not digits.isdecimal():
            raise self.fault("is no numbered part of an episode")
        return int(digits)

    def fault(self, what: str) -> OntoError:
        """TRC003 about this subject."""
        return OntoError.of("TRC003", f"the trace is incomplete: <{self.iri}> {what}", "record the episode again")
