"""An ontology as its reference shows it: every documented term, its anchor, and what was compiled from all of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from pyoxigraph import Literal, NamedNode, QuerySolutions, Store

import ontology
from onto_compiler.check.model import load_model
from onto_compiler.compile_schema import compile_schema
from onto_compiler.html import Html, code, element, joined
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH, SKOS, shorten
from onto_compiler.rules import Rule, read_rules
from onto_compiler.schema import Schema, local_name
from onto_compiler.tables import RuleTables, compile_tables

__all__ = ["Reference", "Values", "read_reference"]

Values = Mapping[str, tuple[NamedNode | Literal, ...]]  # by property IRI, in a fixed order
_ALL = "SELECT DISTINCT ?s ?p ?o WHERE { ?s ?p ?o FILTER (isIRI(?s) && !isBLANK(?o)) }"
_FIRST = tuple(
    f"{BASE}{name}#" for name in ("core", "manipulation", "navigation", "trace", "libero", "pointmaze", "rules")
)
_KINDS = frozenset(
    (
        *(
            OWL + name
            for name in ("Class", "ObjectProperty", "DatatypeProperty", "AnnotationProperty", "NamedIndividual")
        ),
        SH + "SPARQLRule",
    )
)


@dataclass(frozen=True)
class Reference:
    """``facts`` holds every triple by subject; ``anchors`` gives each documented term its place on the page."""

    schema: Schema
    tables: RuleTables
    rules: tuple[Rule, ...]
    facts: Mapping[str, Values]
    anchors: Mapping[str, str]
    questions: tuple[Path, ...]

    def iris(self, subject: str, predicate: str) -> tuple[str, ...]:
        """The IRIs that ``subject`` has for ``predicate``, sorted."""
        values = self.facts.get(subject, {}).get(predicate, ())
        return tuple(value.value for value in values if isinstance(value, NamedNode))

    def texts(self, subject: str, predicate: str) -> tuple[str, ...]:
        """The literals that ``subject`` has for ``predicate``, sorted."""
        values = self.facts.get(subject, {}).get(predicate, ())
        return tuple(value.value for value in values if isinstance(value, Literal))

    def label(self, iri: str) -> str:
        """The label, or another name that our alignments give a term of others, or the local name."""
        named = (*self.texts(iri, RDFS + "label"), *self.texts(iri, SKOS + "altLabel"))
        return next(iter(named), local_name(iri))

    def definition(self, iri: str) -> str:
        """The definition, or nothing."""
        return next(iter(self.texts(iri, SKOS + "definition")), "")

    def of_type(self, *types: str) -> tuple[str, ...]:
        """The documented terms that are declared as one of ``types``, in the order of their names."""
        wanted = set(types)
        return tuple(iri for iri in self.anchors if wanted & set(self.iris(iri, RDF + "type")))

    def instances(self, cls: str) -> tuple[str, ...]:
        """The documented individuals of a class or of one of its subclasses."""
        return tuple(
            iri for iri in self.anchors if any(self.schema.is_a(kind, cls) for kind in self.iris(iri, RDF + "type"))
        )

    def link(self, iri: str) -> Html:
        """A term's name, leading to its entry; a term of another vocabulary leads to that vocabulary."""
        if iri in self.anchors:
            return element("a", code(local_name(iri)), href=f"#{self.anchors[iri]}")
        if iri.startswith(("http://", "https://")):
            return element("a", code(shorten(iri)), href=iri)
        return code(iri)

    def links(self, iris: Iterable[str]) -> Html:
        """Several terms in the order given, with commas between them."""
        parts: list[object] = []
        for iri in iris:
            parts += [", ", self.link(iri)] if parts else [self.link(iri)]
        return joined(parts)


def read_reference(paths: Sequence[Path | str] = ()) -> Reference:
    """The shipped ontology with the user's own Turtle on top; an own file may take a shipped one's place.

    Raises:
        OntoError: TTL0nn, for a file that is missing or is not Turtle; SCH001 and RUN002, as ``compile_schema`` and
            ``compile_tables``.

    """
    store = load_model(paths).store
    schema = compile_schema(store)
    facts = _facts(store)
    return Reference(
        schema=schema,
        tables=compile_tables(store, schema),
        rules=read_rules(store),
        facts=facts,
        anchors=_anchors(facts, schema),
        questions=ontology.query_files("competency"),
    )


def _facts(store: Store) -> dict[str, dict[str, tuple[NamedNode | Literal, ...]]]:
    rows = cast("QuerySolutions", store.query(_ALL, use_default_graph_as_union=True))
    found: dict[str, dict[str, list[NamedNode | Literal]]] = {}
    for row in rows:
        value = cast("NamedNode | Literal", row["o"])
        found.setdefault(row["s"].value, {}).setdefault(row["p"].value, []).append(value)
    return {
        subject: {predicate: tuple(sorted(values, key=str)) for predicate, values in sorted(about.items())}
        for subject, about in sorted(found.items())
    }


def _anchors(facts: Mapping[str, Values], schema: Schema) -> dict[str, str]:
    """One anchor per documented term: its local name, or with its prefix where another term came first.

    Shipped vocabularies come first, so that an own ontology moves no anchor that somebody may have linked to.
    """
    ontologies = {
        subject for subject, about in facts.items() if NamedNode(OWL + "Ontology") in about.get(RDF + "type", ())
    }
    kinds = _KINDS | set(schema.classes)
    terms = [
        subject
        for subject, about in facts.items()
        if any(value.value in kinds for value in about.get(RDF + "type", ()))
        and any(value.value in ontologies for value in about.get(RDFS + "isDefinedBy", ()))
    ]
    taken: set[str] = set()
    anchors: dict[str, str] = {}
    for iri in sorted(terms, key=_precedence):
        name = local_name(iri)
        anchor = name if name not in taken else shorten(iri).replace(":", "-").replace("/", "-")
        taken.add(anchor)
        anchors[iri] = anchor
    return dict(sorted(anchors.items(), key=lambda pair: (local_name(pair[0]).casefold(), pair[0])))


def _precedence(iri: str) -> tuple[int, str]:
    return next((i for i, namespace in enumerate(_FIRST) if iri.startswith(namespace)), len(_FIRST)), iri
