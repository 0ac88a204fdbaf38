"""Entries of terms: classes as a tree, and tables of properties and of individuals."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from onto_compiler.html import Html, badge, code, element, joined, table
from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SKOS
from onto_compiler.reference.model import Reference
from onto_compiler.schema import local_name

__all__ = ["about", "class_tree", "individuals_table", "is_trace", "named", "properties_table", "remarks"]

_MAPPINGS = (
    (OWL + "equivalentClass", "the same as"),
    (OWL + "equivalentProperty", "the same as"),
    (SKOS + "exactMatch", "means the same as"),
    (SKOS + "closeMatch", "is close to"),
    (SKOS + "broadMatch", "is narrower than"),
    (SKOS + "narrowMatch", "is broader than"),
    (SKOS + "relatedMatch", "is related to"),
)
_PROPERTIES = {"ObjectProperty": "object", "DatatypeProperty": "data", "AnnotationProperty": "annotation"}


def is_trace(reference: Reference, iri: str) -> bool:
    """Whether the vocabulary of records defines the term."""
    return BASE + "trace" in reference.iris(iri, RDFS + "isDefinedBy")


def named(reference: Reference, iri: str) -> Html:
    """A term's name as the target of every link to it."""
    return element("span", code(local_name(iri)), id=reference.anchors[iri], class_="term", title=iri)


def about(reference: Reference, iri: str) -> Html:
    """The definition with whatever else the ontology says in words."""
    return joined([reference.definition(iri), remarks(reference, iri)])


def remarks(reference: Reference, iri: str) -> Html:
    """Examples, notes, mappings to other vocabularies, and whether the term is to be avoided."""
    parts: list[Html] = []
    if "true" in reference.texts(iri, OWL + "deprecated"):
        instead = reference.iris(iri, "http://purl.org/dc/terms/isReplacedBy")
        use = joined([" use ", reference.links(instead)]) if instead else ""
        parts.append(element("p", badge("deprecated", "bad"), use))
    examples = reference.texts(iri, SKOS + "example")
    parts += [element("p", "Example: ", code(example), class_="quiet") for example in examples]
    for name in ("scopeNote", "editorialNote"):
        parts += [element("p", note, class_="quiet") for note in reference.texts(iri, SKOS + name)]
    for predicate, words in _MAPPINGS:
        others = reference.iris(iri, predicate)
        if others:
            parts.append(element("p", f"It {words} ".replace("It the", "It is the"), reference.links(others), "."))
    outside = [
        above
        for above in reference.iris(iri, RDFS + "subClassOf") + reference.iris(iri, RDFS + "subPropertyOf")
        if above not in reference.anchors
    ]
    if outside:
        parts.append(element("p", "It is a special ", reference.links(outside), "."))
    return joined(parts)


def class_tree(reference: Reference, classes: Sequence[str]) -> Html:
    """``classes`` below those among them that they are subclasses of; a class with two parents stands in both places.

    Its entry is in the first place, and the other one leads there.
    """
    members = set(classes)
    above = {cls: [c for c in reference.iris(cls, RDFS + "subClassOf") if c in members] for cls in classes}
    below: dict[str, list[str]] = {cls: [] for cls in classes}
    for cls in classes:
        for parent in above[cls]:
            below[parent].append(cls)
    shown: set[str] = set()

    def branch(cls: str) -> Html:
        if cls in shown:
            return element("li", reference.link(cls), element("span", " (above)", class_="quiet"))
        shown.add(cls)
        head = element("p", named(reference, cls), " ", element("span", reference.label(cls), class_="quiet"))
        text = element("div", about(reference, cls), class_="said")
        inner = element("ul", *map(branch, below[cls])) if below[cls] else ""
        return element("li", head, text, inner)

    roots = [branch(cls) for cls in classes if not above[cls]]
    # Whatever is left belongs to a cycle, which has no top.
    roots += [branch(cls) for cls in classes if cls not in shown]
    return element("ul", *roots, class_="tree")


def properties_table(reference: Reference, properties: Iterable[str], caption: str) -> Html:
    """One row per property: of what, to what, and its meaning."""
    rows = [
        (
            named(reference, iri),
            " ".join(_kind(reference, iri)),
            reference.links(reference.iris(iri, RDFS + "domain")) or "anything",
            reference.links(reference.iris(iri, RDFS + "range")) or "anything",
            about(reference, iri),
        )
        for iri in properties
    ]
    return table(caption, ("property", "kind", "of", "to", "meaning"), rows)


def _kind(reference: Reference, iri: str) -> Iterator[str]:
    types = {local_name(kind) for kind in reference.iris(iri, RDF + "type")}
    yield from (word for name, word in _PROPERTIES.items() if name in types)
    if "FunctionalProperty" in types:
        yield "(at most one)"


def individuals_table(reference: Reference, individuals: Iterable[str], caption: str) -> Html:
    """One row per individual: its name in records, and its meaning."""
    rows = [
        (
            named(reference, iri),
            reference.label(iri),
            joined(code(notation) for notation in reference.texts(iri, SKOS + "notation")),
            about(reference, iri),
        )
        for iri in individuals
    ]
    return table(caption, ("term", "label", "in records", "meaning"), rows)
