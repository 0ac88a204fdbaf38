"""Two sides in, the list of changes and the verdict on versions out."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

from onto_compiler.diff.facets import FACETS, HEADER, OTHER
from onto_compiler.diff.sides import Side
from onto_compiler.emit.turtle import iri_text
from onto_compiler.rdf import CORE, OWL, RDF, SH

__all__ = ["Change", "Comparison", "Release", "compare"]

About = Mapping[str, frozenset[str]]

_TYPE, _DEPRECATED = RDF + "type", OWL + "deprecated"
_KINDS = {
    OWL + "Ontology": "ontology",
    OWL + "Class": "class",
    OWL + "ObjectProperty": "property",
    OWL + "DatatypeProperty": "property",
    OWL + "AnnotationProperty": "property",
    SH + "NodeShape": "shape",
    SH + "SPARQLRule": "rule",
}
_ROOTS = {
    CORE + "Predicate": "predicate",
    CORE + "CorrectionRoute": "route",
    CORE + "Binding": "binding",
    CORE + "Threshold": "threshold",
}
# A type that says more of a property than that it is one.
_NARROWING = {
    f"owl:{name}Property"
    for name in ("Functional", "InverseFunctional", "Transitive", "Symmetric", "Asymmetric", "Irreflexive", "Reflexive")
}


@dataclass(frozen=True, slots=True, order=True)
class Change:
    """One change of one term; ``old`` and ``new`` are values as Turtle has them."""

    ontology: str  # IRI, or empty if no header claims the term
    term: str  # IRI
    change: str  # "added" | "removed" | "deprecated" | "changed"
    kind: str  # "class", "property", "predicate", "route", ...
    facet: str = ""  # of a change: "signature", "domain", "unit", ...
    property: str = ""  # IRI
    old: tuple[str, ...] = ()
    new: tuple[str, ...] = ()
    breaking: bool = False


@dataclass(frozen=True, slots=True)
class Release:
    """An ontology's version before and after; ``enough``: it breaks nothing, or the version says that it does."""

    ontology: str
    old: str
    new: str
    breaking: int
    enough: bool


@dataclass(frozen=True, slots=True)
class Comparison:
    """The changes in the order of ontology and term, and one release for every ontology that changed."""

    changes: tuple[Change, ...]
    releases: tuple[Release, ...]

    @property
    def ok(self) -> bool:
        """Whether every breaking change came with a version that says so."""
        return all(release.enough for release in self.releases)


def compare(old: Side, new: Side) -> Comparison:
    """Compare term by term. The version must rise in its major part or, below 1.0, in its minor part."""
    changes = tuple(sorted(_changes(old, new)))
    names = sorted({change.ontology for change in changes})
    return Comparison(changes, tuple(_release(name, changes, old, new) for name in names))


def _release(name: str, changes: tuple[Change, ...], old: Side, new: Side) -> Release:
    breaking = sum(change.breaking for change in changes if change.ontology == name)
    before, after = old.versions.get(name, ""), new.versions.get(name, "")
    fresh = name in new.versions and name not in old.versions
    return Release(name, before, after, breaking, not breaking or fresh or _raised(before, after))


def _raised(before: str, after: str) -> bool:
    old, new = (re.match(r"v?(\d+)\.(\d+)", version) for version in (before, after))
    if old is None or new is None:
        return False
    first, second = (tuple(map(int, match.groups())) for match in (old, new))
    return second[0] > first[0] or (first[0] == second[0] == 0 and second[1] > first[1])


@dataclass(frozen=True, slots=True)
class _Known:
    """As Turtle texts: the terms of the old side, and each class of the new side with its superclasses."""

    before: frozenset[str]
    above: Mapping[str, frozenset[str]]


def _changes(old: Side, new: Side) -> Iterator[Change]:
    known = _Known(frozenset(map(iri_text, old.terms)), _texts(new))
    before_kinds, after_kinds = _kinds(old), _kinds(new)
    for iri in sorted({*old.terms, *new.terms}):
        before, after = old.terms.get(iri), new.terms.get(iri)
        side, kinds = (new, after_kinds) if after is not None else (old, before_kinds)
        types = side.terms[iri].get(_TYPE, frozenset())
        kind = next((kind for text, kind in kinds.items() if text in types), "individual")
        ontology = side.ontology.get(iri, "")
        if before is None:
            yield Change(ontology, iri, "added", kind, breaking=kind == "shape")
        elif after is None:
            # A term that a program may name is gone; a header or a shape that is gone asks for less.
            yield Change(ontology, iri, "removed", kind, breaking=kind not in {"ontology", "shape"})
        else:
            yield from _changed(before, after, Change(ontology, iri, "changed", kind), known)


def _changed(before: About, after: About, change: Change, known: _Known) -> Iterator[Change]:
    none: frozenset[str] = frozenset()
    for name in sorted({*before, *after} - HEADER):
        was, now = before.get(name, none), after.get(name, none)
        if was == now:
            continue
        facet = FACETS.get(name, OTHER)
        gone, come = tuple(sorted(was - now)), tuple(sorted(now - was))
        deprecated = name == _DEPRECATED and any(value.startswith('"true"') for value in come)
        yield replace(
            change,
            change="deprecated" if deprecated else "changed",
            facet=facet.name,
            property=name,
            old=gone,
            new=come,
            breaking=_POLICIES[facet.breaks](gone, come, known),
        )


def _texts(side: Side) -> dict[str, frozenset[str]]:
    return {iri_text(cls): frozenset(map(iri_text, above)) for cls, above in side.above.items()}


def _kinds(side: Side) -> dict[str, str]:
    """For each class that makes a term more than an individual, as Turtle text, what it makes of it."""
    found = {iri_text(cls): kind for cls, kind in _KINDS.items()}
    for root, kind in _ROOTS.items():
        found |= {iri_text(cls): kind for cls, above in side.above.items() if root in above}
        found[iri_text(root)] = kind
    return found


Values = tuple[str, ...]


def _less(gone: Values, _: Values, __: _Known) -> bool:
    return bool(gone)


def _more(_: Values, come: Values, __: _Known) -> bool:
    return bool(come)


def _pair(_: Values, come: Values, known: _Known) -> bool:
    """A class that is new cannot be disjoint with anything that was written before."""
    return any(value in known.before for value in come)


def _class(gone: Values, come: Values, known: _Known) -> bool:
    """A class may give way to one that holds all its members; none at all holds everything."""
    if not gone or not come:
        return bool(come)
    return not all(any(value in known.above.get(before, ()) for before in gone) for value in come)


def _taken(gone: Values, come: Values, known: _Known) -> bool:
    return not gone or not come or _class(gone, come, known)


def _super(gone: Values, come: Values, _: _Known) -> bool:
    return any(not value.startswith("[") for value in gone) or any(value.startswith("[") for value in come)


def _type(gone: Values, come: Values, _: _Known) -> bool:
    return bool({*gone} - {*_NARROWING, "owl:NamedIndividual"}) or bool({*come} & _NARROWING)


_POLICIES: Mapping[str, Callable[[Values, Values, _Known], bool]] = {
    "always": lambda _, __, ___: True,
    "class": _class,
    "less": _less,
    "more": _more,
    "never": lambda _, __, ___: False,
    "pair": _pair,
    "super": _super,
    "taken": _taken,
    "type": _type,
}
