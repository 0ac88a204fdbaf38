"""Two sides in, the list of changes and the verdict on versions out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from pyoxigraph import BlankNode, NamedNode, Quad

from onto_compiler.diff.disjoint import AXIOMS, DISJOINT, Groups, unmatched
from onto_compiler.diff.expressions import Texts
from onto_compiler.diff.facets import FACETS, HEADER, OTHER, WORDING
from onto_compiler.diff.policies import POLICIES, Known
from onto_compiler.diff.sides import Side
from onto_compiler.diff.structure import Descriptions, Structures
from onto_compiler.diff.versions import raised
from onto_compiler.rdf import CORE, OWL, RDF, RDFS, SH
from onto_compiler.sources import load_store
from onto_compiler.terms import Term

__all__ = ["Change", "Comparison", "Release", "compare"]

_TYPE, _DEPRECATED, _SUBCLASS = RDF + "type", OWL + "deprecated", RDFS + "subClassOf"
_KINDS = {
    OWL + "Ontology": "ontology",
    OWL + "Class": "class",
    OWL + "ObjectProperty": "property",
    OWL + "DatatypeProperty": "property",
    OWL + "AnnotationProperty": "property",
    SH + "NodeShape": "shape",
    SH + "PropertyShape": "shape",
    SH + "SPARQLRule": "rule",
}
_ROOTS = {
    CORE + "Predicate": "predicate",
    CORE + "CorrectionRoute": "route",
    CORE + "Binding": "binding",
    CORE + "Threshold": "threshold",
}


@dataclass(frozen=True, slots=True, order=True)
class Change:
    """One change of one term: values in Turtle (``old``, ``new``), and the same as people read them (``was``, ``now``).

    Of an axiom or a shape without a name, ``term`` is empty, and what it says is in ``old`` or ``new``.
    """

    ontology: str  # IRI, or empty if no header claims the term
    term: str  # IRI
    change: str  # "added" | "removed" | "deprecated" | "changed"
    kind: str  # "class", "property", "predicate", "route", ...
    facet: str = ""  # of a change: "signature", "domain", "unit", ...
    property: str = ""  # IRI
    old: tuple[str, ...] = ()
    new: tuple[str, ...] = ()
    was: tuple[str, ...] = ()
    now: tuple[str, ...] = ()
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
    """The changes in the order of ontology and term, and one release for every ontology that changed.

    ``prefixes``: what the texts of the changes are written with, as (name, namespace).
    """

    changes: tuple[Change, ...]
    releases: tuple[Release, ...]
    prefixes: tuple[tuple[str, str], ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every breaking change came with a version that says so."""
        return all(release.enough for release in self.releases)


def compare(old: Side, new: Side) -> Comparison:
    """Compare term by term. The version must rise in its major part or, below 1.0, in its minor part."""
    both = _Both(old, new)
    changes = tuple(sorted([*_terms(both), *_disjoint(both), *_anonymous(both)]))
    names = sorted({change.ontology for change in changes})
    return Comparison(changes, tuple(_release(name, changes, old, new) for name in names), both.prefixes)


def _release(name: str, changes: tuple[Change, ...], old: Side, new: Side) -> Release:
    breaking = sum(change.breaking for change in changes if change.ontology == name)
    before, after = old.versions.get(name), new.versions.get(name)
    fresh = before is None and after is not None
    by_iri = bool(before and after and before.info == after.info and before.iri != after.iri)
    was, now = (((side.iri if by_iri else side.info) or side.iri) if side else "" for side in (before, after))
    enough = not breaking or fresh or bool(before and after and raised(before, after))
    return Release(name, was, now, breaking, enough)


@dataclass
class _Both:
    """What a comparison reads: both sides, and their blank nodes by structure."""

    old: Side
    new: Side

    def __post_init__(self) -> None:
        self.found = Descriptions.of((*self.old.quads, *self.new.quads))
        self.written, self.meant = Structures(self.found), Structures(self.found, meaning=True)
        self.texts = Texts(self.found, self.prefixes)

    @cached_property
    def prefixes(self) -> tuple[tuple[str, str], ...]:
        """The prefixes of both sides, without a name that stands for several namespaces."""
        declared = dict.fromkeys((*self.new.prefixes, *self.old.prefixes))
        names = Counter(name for name, _ in declared)
        return tuple(pair for pair in declared if names[pair[0]] == 1)

    @cached_property
    def parents(self) -> tuple[Mapping[str, set[str]], Mapping[str, set[str]]]:
        """For either side, a class and what it is declared to be below, the shipped ontology included."""
        shipped = load_store().quads_for_pattern(None, NamedNode(_SUBCLASS), None, None)
        common = _parents(shipped)
        sides = []
        for side in (self.old, self.new):
            own = _parents(quad for quad in side.quads if quad.predicate.value == _SUBCLASS)
            sides.append({cls: common.get(cls, set()) | own.get(cls, set()) for cls in {*common, *own}})
        return sides[0], sides[1]

    @cached_property
    def known(self) -> Known:
        return Known(frozenset(self.old.terms), self.parents[1], self.found, self.meant)


def _parents(quads: Iterable[Quad]) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for quad in quads:
        if isinstance(quad.subject, NamedNode) and isinstance(quad.object, NamedNode):
            found.setdefault(quad.subject.value, set()).add(quad.object.value)
    return found


def _terms(both: _Both) -> Iterator[Change]:
    old, new = both.old, both.new
    kinds = [_kinds(parents) for parents in both.parents]
    for iri in sorted({*old.terms, *new.terms}):
        before, after = old.terms.get(iri), new.terms.get(iri)
        side, known = (new, kinds[1]) if after is not None else (old, kinds[0])
        kind = _kind(side.terms[iri].get(_TYPE, ()), known, "individual")
        ontology = side.ontology.get(iri, "")
        if before is None:
            yield Change(ontology, iri, "added", kind, breaking=kind == "shape")
        elif after is None:
            # A term that a program may name is gone; a header or a shape that is gone asks for less.
            yield Change(ontology, iri, "removed", kind, breaking=kind not in {"ontology", "shape"})
        else:
            yield from _changed(before, after, Change(ontology, iri, "changed", kind), both)


def _changed(
    before: Mapping[str, frozenset[Term]], after: Mapping[str, frozenset[Term]], change: Change, both: _Both
) -> Iterator[Change]:
    for name in sorted({*before, *after} - HEADER - {DISJOINT}):
        sides = before.get(name, frozenset()), after.get(name, frozenset())
        was, now = ({both.written.key(term, name): term for term in side} for side in sides)
        if was.keys() == now.keys():
            continue
        meant = [{both.meant.key(term, name): term for term in side} for side in sides]
        gone, come = ({key: one[key] for key in one.keys() - other.keys()} for one, other in (meant, meant[::-1]))
        facet = FACETS.get(name, OTHER) if gone or come else WORDING
        deprecated = name == _DEPRECATED and any(key.startswith('"true"') for key in come)
        lost, won = ([one[key] for key in one.keys() - other.keys()] for one, other in ((was, now), (now, was)))
        yield _with_values(
            replace(
                change,
                change="deprecated" if deprecated else "changed",
                facet=facet.name,
                property=name,
                breaking=POLICIES[facet.breaks](gone, come, both.known),
            ),
            lost, won, both,
        )  # fmt: skip


def _with_values(change: Change, old: Sequence[Term], new: Sequence[Term], both: _Both) -> Change:
    turtle, legible = both.texts.turtle, both.texts.legible
    return replace(
        change,
        old=tuple(sorted(map(turtle, old))),
        new=tuple(sorted(map(turtle, new))),
        was=tuple(sorted(map(legible, old))),
        now=tuple(sorted(map(legible, new))),
    )


def _disjoint(both: _Both) -> Iterator[Change]:
    """Pairs of classes that share no member on one side alone; a new class has no members that could be wrong."""
    old, new = (Groups.of(side.quads, both.found) for side in (both.old, both.new))
    before = both.old.terms
    for these, those, come in ((old, new, False), (new, old, True)):
        for one, others in unmatched(these, those):
            group = one in others
            side = both.new if one in both.new.terms else both.old
            kind = _kind(side.terms.get(one, {}).get(_TYPE, ()), _kinds({}), "class")
            known = [other for other in others if other in before]
            breaks = come and (len(known) > 1 if group else one in before and bool(known))
            change = Change(
                side.ontology.get(one, ""), one, "changed", kind, "disjointness", AXIOMS if group else DISJOINT
            )
            values = [NamedNode(other) for other in others]
            yield _with_values(replace(change, breaking=breaks), [] if come else values, values if come else [], both)


def _anonymous(both: _Both) -> Iterator[Change]:
    """Shapes, axioms and other blank nodes that nothing with a name holds."""
    sides = [_roots(side, both.found) for side in (both.old, both.new)]
    keys = [{node: both.written.key(node) for node in side} for side in sides]
    meanings = [{both.meant.key(node) for node in side} for side in sides]
    for which, change in ((0, "removed"), (1, "added")):
        spare = Counter(keys[1 - which].values())
        for node, graph in sides[which].items():
            if spare[keys[which][node]]:
                spare[keys[which][node]] -= 1
                continue
            said = both.found.about.get(node, ())
            kind = _kind([value for name, value in said if name == _TYPE], _kinds({}), "node")
            if kind in {"class", "node"} and any(name in {_SUBCLASS, OWL + "equivalentClass"} for name, _ in said):
                kind = "axiom"
            fresh = both.meant.key(node) not in meanings[1 - which]
            ontology = (both.old, both.new)[which].headers.get(graph, "")
            found = Change(ontology, "", change, kind, breaking=bool(which) and fresh and kind in {"axiom", "shape"})
            yield _with_values(found, [] if which else [node], [node] if which else [], both)


def _roots(side: Side, found: Descriptions) -> dict[BlankNode, str]:
    """The blank nodes that no other term leads to, with their graphs; of those in a circle, one."""
    subjects = {quad.subject: str(quad.graph_name) for quad in side.quads if isinstance(quad.subject, BlankNode)}
    subjects = {node: graph for node, graph in subjects.items() if node in found.about}
    inner = {one for node in subjects for one in found.within(node)}
    reached: set[BlankNode] = set()

    def reach(waiting: list[BlankNode]) -> None:
        while waiting:
            node = waiting.pop()
            if node not in reached:
                reached.add(node)
                waiting.extend(found.within(node))

    reach(
        [
            quad.object
            for quad in side.quads
            if isinstance(quad.subject, NamedNode) and isinstance(quad.object, BlankNode)
        ]
    )
    roots = []
    for node in sorted(subjects, key=lambda node: node in inner):
        if node not in reached:
            roots.append(node)
            reach([node])
    axiom = NamedNode(AXIOMS)
    return {node: subjects[node] for node in roots if not any(value == axiom for _, value in found.about[node])}


def _kinds(parents: Mapping[str, set[str]]) -> dict[str, str]:
    """For each class that makes a term more than an individual, what it makes of it."""
    children: dict[str, list[str]] = {}
    for cls, above in parents.items():
        for one in above:
            children.setdefault(one, []).append(cls)
    found = dict(_KINDS)
    for root, kind in _ROOTS.items():
        waiting, seen = [root], {root}
        while waiting:
            below = set(children.get(waiting.pop(), ())) - seen
            seen |= below
            waiting += below
        found |= dict.fromkeys(seen, kind)
    return found


def _kind(types: Iterable[Term], kinds: Mapping[str, str], otherwise: str) -> str:
    names = {term.value for term in types if isinstance(term, NamedNode)}
    return next((kind for cls, kind in kinds.items() if cls in names), otherwise)
