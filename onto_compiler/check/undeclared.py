"""Classes and properties that nothing declares, in namespaces of which the checked files declare others.

RDF lets anybody use any name, and OWL 2 DL wants each declared. Where no property of a namespace is declared, a shape
that has it as its path describes it. A namespace of which the files use more names than they
declare has its ontology elsewhere, and nothing is said of it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator

from pyoxigraph import NamedNode, Quad

from onto_compiler.check.finding import Finding
from onto_compiler.check.imports import HINT
from onto_compiler.check.model import Model
from onto_compiler.rdf import OWL, PREFIXES, RDF, RDFS, SH, namespace_of
from onto_compiler.sources import graph_of
from onto_compiler.vocabularies import TERMS

__all__ = ["KINDS", "check_imports", "check_undeclared"]

_TYPE, _IMPORTS, _PATH = NamedNode(RDF + "type"), NamedNode(OWL + "imports"), NamedNode(SH + "path")
_PROPERTIES = frozenset(
    NamedNode(iri)
    for iri in (
        RDF + "Property",
        *(OWL + name for name in ("ObjectProperty", "DatatypeProperty", "AnnotationProperty")),
    )
)
KINDS = _PROPERTIES | {NamedNode(RDFS + "Class"), NamedNode(RDFS + "Datatype"), NamedNode(OWL + "Class")}
"""What declares a class or a property."""
_NAMING = frozenset(
    NamedNode(iri)
    for iri in (
        RDF + "type",
        *(RDFS + name for name in ("subClassOf", "subPropertyOf", "domain", "range")),
        *(OWL + name for name in ("disjointWith", "equivalentClass", "equivalentProperty", "inverseOf")),
        *(OWL + name for name in ("onProperty", "onClass", "someValuesFrom", "allValuesFrom")),
        *(SH + name for name in ("class", "path", "targetClass", "targetObjectsOf", "targetSubjectsOf")),
    )
)
"""The properties whose value is a class or a property."""
_SHARED = frozenset((*TERMS, *PREFIXES.values()))
_FEW = 3  # undeclared names, which a small file may have by mistake
_HINT = "declare the term, or correct its name"


def check_undeclared(model: Model) -> Iterator[Finding]:
    """Each use of such a name as a class or as a property, in the reported files."""
    declared = _declared(model, KINDS)
    if not declared:
        return
    with_properties = _declared(model, _PROPERTIES)
    described = {quad.subject for quad in model.written}
    paths = (quad.object for quad in model.store.quads_for_pattern(None, _PATH, None, None))
    described |= {one for one in paths if isinstance(one, NamedNode) and namespace_of(one.value) not in with_properties}
    uses: dict[NamedNode, list[tuple[Quad, str]]] = defaultdict(list)
    for quad in model.written:
        if quad.graph_name in model.graphs:
            uses[quad.predicate].append((quad, "predicate"))
            if quad.predicate in _NAMING and isinstance(quad.object, NamedNode):
                uses[quad.object].append((quad, "object"))
    unknown = {term: namespace_of(term.value) for term in uses if term not in described}
    names = Counter(unknown.values())
    for term, namespace in unknown.items():
        if namespace in declared and names[namespace] <= max(len(declared[namespace]), _FEW):
            yield from (_finding(quad, part) for quad, part in uses[term])


def _declared(model: Model, kinds: Iterable[NamedNode]) -> dict[str, set[NamedNode]]:
    """The terms of ``kinds`` that the reported files and their imports declare, by namespace.

    Left out are namespaces that several ontologies share, and those whose terms say what defines them: a query sees to
    their names.
    """
    graphs = {*model.graphs, *(graph_of(path) for path in model.imported)}
    found: dict[str, set[NamedNode]] = defaultdict(set)
    for kind in kinds:
        for quad in model.store.quads_for_pattern(None, _TYPE, kind, None):
            if quad.graph_name in graphs and isinstance(quad.subject, NamedNode):
                found[namespace_of(quad.subject.value)].add(quad.subject)
    defined = {
        namespace_of(quad.subject.value)
        for quad in model.store.quads_for_pattern(None, NamedNode(RDFS + "isDefinedBy"), None, None)
        if isinstance(quad.subject, NamedNode)
    }
    return {name: terms for name, terms in found.items() if name and name not in _SHARED and name not in defined}


def _finding(quad: Quad, part: str) -> Finding:
    code, said = ("VOC002", "the property `{predicate}`") if part == "predicate" else ("VOC001", "`{object}`")
    value = None if part == "predicate" else quad.object
    message, named = f"{said} is not declared", {part: getattr(quad, part)}
    return Finding(code, "warning", message, _HINT, quad.subject, quad.predicate, value, values=named, near=part)


def check_imports(model: Model) -> Iterator[Finding]:
    """Each import of the reported files that a catalog or a relative IRI leads to no file."""
    for iri, reason in model.unresolved.items():
        message = f"the import `{{object}}` is not followed: {reason}"
        for quad in model.store.quads_for_pattern(None, _IMPORTS, iri, None) if reason else ():
            yield Finding("IMP001", "warning", message, HINT, quad.subject, _IMPORTS, iri)
