"""The loaded ontology as the emitters read it: triples of all files together, and the schema compiled from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import cast

from pyoxigraph import BlankNode, Literal, NamedNode, Store

from onto_compiler.check.model import load_model
from onto_compiler.compile_schema import compile_schema
from onto_compiler.emit.imports import unresolved, with_imports
from onto_compiler.problems import OntoError
from onto_compiler.rdf import OWL, RDF, RDFS, SKOS, XSD, node
from onto_compiler.schema import Schema, local_name

__all__ = ["TBox", "Term", "read_tbox"]

Term = NamedNode | BlankNode | Literal


@dataclass(frozen=True)
class TBox:
    """``store`` holds one named graph per file; every method answers in a fixed order."""

    store: Store
    schema: Schema

    def values(self, subject: Term, predicate: str) -> tuple[Term, ...]:
        """The objects of ``subject predicate ?``, sorted, blank nodes as they come."""
        if isinstance(subject, Literal):
            return ()
        quads = self.store.quads_for_pattern(subject, node(predicate), None, None)
        found = dict.fromkeys(cast("Term", quad.object) for quad in quads)
        return tuple(sorted(found, key=lambda term: "" if isinstance(term, BlankNode) else str(term)))

    def iris(self, subject: Term | str, predicate: str) -> tuple[str, ...]:
        """The objects of ``subject predicate ?`` that are IRIs, sorted."""
        start = node(subject) if isinstance(subject, str) else subject
        return tuple(term.value for term in self.values(start, predicate) if isinstance(term, NamedNode))

    def subjects(self, predicate: str, value: Term | str) -> tuple[str, ...]:
        """The IRIs that have ``value``, sorted."""
        end = node(value) if isinstance(value, str) else value
        quads = self.store.quads_for_pattern(None, node(predicate), end, None)
        return tuple(sorted({quad.subject.value for quad in quads if isinstance(quad.subject, NamedNode)}))

    def blank_subjects(self, predicate: str, value: str) -> tuple[BlankNode, ...]:
        """The blank nodes that have ``value``, as they come."""
        quads = self.store.quads_for_pattern(None, node(predicate), node(value), None)
        return tuple(dict.fromkeys(quad.subject for quad in quads if isinstance(quad.subject, BlankNode)))

    def items(self, head: Term) -> tuple[Term, ...]:
        """The members of an RDF list; of one that does not end, those before it repeats itself."""
        members: list[Term] = []
        seen: set[Term] = set()
        while head.value != RDF + "nil" and head not in seen:
            seen.add(head)
            members += self.values(head, RDF + "first")[:1]
            head = next(iter(self.values(head, RDF + "rest")), node(RDF + "nil"))
        return tuple(members)

    def text(self, iri: str, predicate: str) -> str:
        """The first literal value, or nothing."""
        return next((term.value for term in self.values(node(iri), predicate) if isinstance(term, Literal)), "")

    def definition(self, iri: str) -> str:
        """The ``skos:definition`` of a term, or nothing."""
        return self.text(iri, SKOS + "definition")

    def label(self, iri: str) -> str:
        """The ``rdfs:label`` of a term, or its local name."""
        return self.text(iri, RDFS + "label") or local_name(iri)

    def name(self, iri: str) -> str:
        """The ``skos:notation`` of a term, which records write, or its local name."""
        return self.schema.notations.get(iri, local_name(iri))

    def below(self, iri: str) -> tuple[str, ...]:
        """The class and its subclasses, sorted."""
        return tuple(sorted({cls for cls, above in self.schema.classes.items() if iri in above} | {iri}))

    def individuals(self, cls: str) -> tuple[str, ...]:
        """The IRIs of the individuals of a class and of its subclasses, sorted."""
        return tuple(sorted({one for kind in self.below(cls) for one in self.subjects(RDF + "type", kind)}))

    def declared(self, *kinds: str) -> tuple[str, ...]:
        """The IRIs that are declared as one of ``kinds`` (local names of OWL), sorted."""
        return tuple(sorted({iri for kind in kinds for iri in self.subjects(RDF + "type", OWL + kind)}))

    @cached_property
    def datatypes(self) -> frozenset[str]:
        """The IRIs of the datatypes that the ontology declares."""
        return frozenset(self.subjects(RDF + "type", RDFS + "Datatype"))

    def is_datatype(self, iri: str) -> bool:
        """Whether an IRI names a datatype: one of XSD's, or a declared one."""
        return iri.startswith(XSD) or iri in {RDFS + "Literal", RDF + "langString"} or iri in self.datatypes


def read_tbox(paths: Sequence[Path | str] = ()) -> TBox:
    """The shipped ontology with the user's own Turtle and its imports on top; own files may take shipped ones' places.

    Raises:
        OntoError: TTL0nn, for every file that is missing or is not Turtle; OWL003, for an import that no file declares;
            SCH001, as ``compile_schema``.
    """
    store = load_model(with_imports(paths)).store
    if problems := list(unresolved(store)):
        raise OntoError(*problems)
    return TBox(store, compile_schema(store))
