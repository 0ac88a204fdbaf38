"""Validates records as they are written: statements in, violations out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from pyoxigraph import NamedNode, Quad, Store, Triple

from onto_compiler.rdf import RDF, node
from onto_compiler.shapes import ShapeResult, compile_shapes, validate
from onto_compiler.validator.facts import NOTHING, Facts, Term, Vocabulary
from onto_compiler.validator.shape import CompiledShape

__all__ = ["Target", "Validator"]

_TYPE = node(RDF + "type")


@dataclass(frozen=True, slots=True)
class Target:
    """Which nodes a shape speaks of."""

    classes: tuple[Term, ...] = ()
    nodes: frozenset[Term] = frozenset()
    subjects_of: frozenset[NamedNode] = frozenset()
    objects_of: frozenset[NamedNode] = frozenset()

    @property
    def elsewhere(self) -> bool:
        """Whether it takes nodes for another reason than their class."""
        return bool(self.nodes or self.subjects_of or self.objects_of)

    def by_types(self, vocabulary: Vocabulary, types: Iterable[Term]) -> bool:
        """Whether it takes a node of these types."""
        return any(each in vocabulary.subclasses(cls) for each in types for cls in self.classes)

    def otherwise(self, facts: Facts) -> Iterator[Term]:
        """The focus nodes among what ``facts`` describe that it takes for another reason than their class."""
        yield from (focus for focus in self.nodes if focus in facts.nodes)
        for predicate in self.subjects_of:
            yield from (subject for subject, properties in facts.nodes.items() if predicate in properties)
        for predicate in self.objects_of:
            for properties in facts.nodes.values():
                yield from properties.get(predicate, NOTHING)

    def takes_any(self, facts: Facts) -> bool:
        """Whether there is a focus node for it at all."""
        described = facts.nodes.values()
        return any(self.by_types(facts.vocabulary, each.get(_TYPE, NOTHING)) for each in described) or any(
            True for _ in self.otherwise(facts)
        )


@dataclass(slots=True)
class Validator:
    """Compiled shapes over a vocabulary, made by :func:`onto_compiler.validator.compile.compile_validator`.

    The focus nodes are those that the statements describe or, where a shape targets objects, point to. What the
    vocabulary alone says of its own terms is for ``onto check``.
    """

    vocabulary: Vocabulary
    shapes: tuple[tuple[Target, CompiledShape], ...]
    foreign: tuple[tuple[Target, Term], ...]  # shapes without a Python form
    statements: tuple[Quad | Triple, ...]  # the vocabulary and the shapes, for those
    _known: dict[tuple[Term, ...], tuple[CompiledShape, ...]] = field(default_factory=dict, repr=False)

    def validate(self, statements: Iterable[Quad | Triple]) -> tuple[ShapeResult, ...]:
        """Every violation of every record that ``statements`` describe, graph names aside.

        Raises:
            OntoError: SHP002, where a shape without a Python form cannot run.

        """
        given = tuple(statements) if self.foreign else ()
        facts = Facts(self.vocabulary, given or statements)
        found: list[ShapeResult] = []
        # Which shapes a combination of types meets is worked out once, for the vocabulary's own class tree.
        known = self._known if facts.vocabulary is self.vocabulary else {}
        for focus, properties in facts.nodes.items():
            types = tuple(properties.get(_TYPE, NOTHING))
            shapes = known.get(types)
            if shapes is None:
                chosen = (shape for target, shape in self.shapes if target.by_types(facts.vocabulary, types))
                known[types] = shapes = tuple(chosen)
            for shape in shapes:
                shape.find(facts, focus, found)
        for target, shape in self.shapes:
            for focus in target.otherwise(facts) if target.elsewhere else ():
                shape.find(facts, focus, found)
        if self.foreign:
            found += self._foreign(facts, given)
        return tuple(dict.fromkeys(found)) if found else ()

    def home(self, shape: Term) -> Term:
        """The targeted shape that ``shape`` is a part of, or ``shape`` itself."""
        return next((root.iri for _, root in self.shapes if root.holds(shape)), shape)

    def _foreign(self, facts: Facts, given: Sequence[Quad | Triple]) -> Iterator[ShapeResult]:
        """What the SPARQL engine finds, by the shapes that have no Python form and a focus node here."""
        roots = {root for target, root in self.foreign if target.takes_any(facts)}
        if not roots:
            return
        store = Store()
        store.extend(Quad(each.subject, each.predicate, each.object) for each in (*self.statements, *given))
        shapes = compile_shapes(store).only(roots)
        yield from (result for result in validate(store, shapes) if result.focus in facts.nodes)
