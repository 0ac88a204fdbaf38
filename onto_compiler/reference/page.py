"""The reference as one page: deterministic, without script, font or picture from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from itertools import groupby
from pathlib import Path

from onto_compiler.html import Html, code, element, joined, page, table
from onto_compiler.rdf import BASE, CORE, OWL, PREFIXES, RDF
from onto_compiler.reference.decisions import routes_section, rules_section
from onto_compiler.reference.lifting import bindings_section, categories_section, thresholds_section
from onto_compiler.reference.model import Reference, read_reference
from onto_compiler.reference.predicates import predicates_section
from onto_compiler.reference.scores import scores_section
from onto_compiler.reference.terms import class_tree, individuals_table, is_trace, properties_table
from onto_compiler.schema import local_name

__all__ = ["reference_html"]

_TERMS = "http://purl.org/dc/terms/"
_PROPERTIES = (OWL + "ObjectProperty", OWL + "DatatypeProperty", OWL + "AnnotationProperty")
# Individuals that have a section of their own.
_ELSEWHERE = ("Predicate", "CorrectionRoute", "Binding", "Threshold", "Category", "RegionCategory", "Default")


def reference_html(paths: Sequence[Path | str] = ()) -> str:
    """The reference of the shipped ontology with ``paths`` on top; the same files give the same bytes.

    Raises:
        OntoError: as :func:`onto_compiler.reference.model.read_reference`.

    """
    reference = read_reference(paths)
    sections = _sections(reference)
    style = files("onto_compiler.reference").joinpath("reference.css").read_text(encoding="utf-8")
    contents = [element("li", element("a", title, href=f"#section-{key}")) for key, title, _ in sections]
    body = [element("section", element("h2", title, id=f"section-{key}"), content) for key, title, content in sections]
    title = _title(reference)
    return page(
        title,
        style,
        element("a", "Skip to the reference", href="#main", class_="skip"),
        _header(reference, title),
        element("nav", element("ol", *contents), aria_label="Contents"),
        element("main", *body, id="main"),
        element("footer", element("p", "Written by ", code("onto docs"), " from the ontology itself.")),
    )


def _sections(reference: Reference) -> list[tuple[str, str, Html]]:
    classes = reference.of_type(OWL + "Class")
    properties = reference.of_type(*_PROPERTIES)
    caption = "How the parts of the vocabulary are related"
    return [
        ("predicates", "Predicates", predicates_section(reference)),
        ("routes", "Failures and routes", routes_section(reference)),
        ("rules", "Rules", rules_section(reference)),
        ("vocabularies", "Statuses and other finite vocabularies", _vocabularies(reference, trace=False)),
        ("classes", "Classes", class_tree(reference, [c for c in classes if not is_trace(reference, c)])),
        (
            "properties",
            "Properties",
            properties_table(reference, [p for p in properties if not is_trace(reference, p)], caption),
        ),
        ("bindings", "Bindings", bindings_section(reference)),
        ("thresholds", "Thresholds", thresholds_section(reference)),
        ("categories", "Categories of assets", categories_section(reference)),
        ("scores", "Scores of plans", scores_section(reference)),
        ("trace", "Records and traces", _trace(reference, classes, properties)),
        ("questions", "Competency questions", _questions(reference)),
        ("ontologies", "Ontologies", _ontologies(reference)),
        ("index", "Index of terms", _index(reference)),
    ]


def _ontology_iris(reference: Reference) -> list[str]:
    return [
        iri
        for iri, about in reference.facts.items()
        if any(t.value == OWL + "Ontology" for t in about.get(RDF + "type", ()))
    ]


def _first(reference: Reference, iri: str, name: str) -> str:
    return next(iter(reference.texts(iri, name)), "")


def _title(reference: Reference) -> str:
    """Own ontologies give the page its title; without any it is the shipped ontology's."""
    own = [iri for iri in _ontology_iris(reference) if not iri.startswith(BASE)]
    titles = [_first(reference, iri, _TERMS + "title") for iri in own]
    return f"{', '.join(filter(None, titles)) or 'Onto-EV-WM'}: ontology reference"


def _header(reference: Reference, title: str) -> Html:
    core = BASE + "core"
    counts = [
        ("version", _first(reference, core, OWL + "versionInfo")),
        ("licence", joined(_licences(reference, core))),
        ("terms", str(len(reference.anchors))),
        ("classes", str(len(reference.of_type(OWL + "Class")))),
        ("predicates", str(len(reference.schema.predicates))),
        ("rules", str(len({rule.iri for rule in reference.rules}))),
        ("routes", str(len(reference.schema.routes))),
    ]
    items = [element("li", f"{name} ", element("b", value)) for name, value in counts]
    lead = (
        "What can be required of a task, how it can fail, and where each failure is sent; as the ontology declares it."
    )
    return element(
        "header", element("h1", title), element("p", lead, class_="quiet"), element("ul", *items, class_="versions")
    )


def _licences(reference: Reference, iri: str) -> list[Html]:
    return [element("a", local_name(url), href=url) for url in reference.iris(iri, _TERMS + "license")]


def _ontologies(reference: Reference) -> Html:
    rows = [
        (
            joined([element("p", _first(reference, iri, _TERMS + "title")), element("a", code(iri), href=iri)]),
            joined(reference.texts(iri, OWL + "versionInfo")),
            joined(_licences(reference, iri)),
            ", ".join(reference.texts(iri, _TERMS + "creator")),
            joined(element("p", code(other)) for other in reference.iris(iri, OWL + "imports")),
            _first(reference, iri, _TERMS + "description"),
        )
        for iri in _ontology_iris(reference)
    ]
    columns = ("ontology", "version", "licence", "creator", "imports", "what it holds")
    return table("The files that this reference was made from", columns, rows)


def _vocabularies(reference: Reference, *, trace: bool) -> Html:
    elsewhere = {iri for name in _ELSEWHERE for iri in reference.instances(CORE + name)}
    elsewhere |= set(reference.instances(PREFIXES["plan"] + "Score"))
    left = [
        iri
        for iri in reference.of_type(OWL + "NamedIndividual")
        if iri not in elsewhere and is_trace(reference, iri) is trace
    ]
    kinds: dict[str, list[str]] = {}
    for iri in left:
        types = [kind for kind in reference.iris(iri, RDF + "type") if kind != OWL + "NamedIndividual"]
        kinds.setdefault(types[0] if types else "", []).append(iri)
    tables = [
        individuals_table(
            reference, members, f"{reference.label(kind) if kind else 'other'}: {reference.definition(kind)}"
        )
        for kind, members in sorted(kinds.items(), key=lambda item: reference.label(item[0]))
    ]
    return element("div", *tables, class_="stack")


def _trace(reference: Reference, classes: Sequence[str], properties: Sequence[str]) -> Html:
    mine = [iri for iri in properties if is_trace(reference, iri)]
    return joined(
        [
            element("h3", "Records"),
            class_tree(reference, [iri for iri in classes if is_trace(reference, iri)]),
            element("h3", "Properties of records"),
            properties_table(reference, mine, "What records say"),
            element("h3", "Outcomes and modes"),
            _vocabularies(reference, trace=True),
        ]
    )


def _questions(reference: Reference) -> Html:
    entries = []
    for path in reference.questions:
        text = path.read_text(encoding="utf-8")
        comment = [line.lstrip("# ") for line in text.splitlines() if line.startswith("#")]
        query = "\n".join(line for line in text.splitlines() if not line.startswith("#")).strip()
        entries.append(
            element(
                "details",
                element("summary", " ".join(comment), " ", code(path.stem)),
                element(
                    "div",
                    element("p", "Ask it: ", code(f"onto trace query --named {path.stem}")),
                    element("pre", query),
                ),
            )
        )
    return joined(entries)


def _index(reference: Reference) -> Html:
    letters = groupby(reference.anchors, key=lambda iri: local_name(iri)[:1].upper())
    parts = []
    for letter, members in letters:
        items = [
            element("li", reference.link(iri), element("span", f" {_home(iri)}", class_="quiet")) for iri in members
        ]
        parts += [element("h3", letter), element("ul", *items, class_="index")]
    return joined(parts)


def _home(iri: str) -> str:
    return iri.removesuffix(local_name(iri)).rstrip("#/").rpartition("/")[2]
