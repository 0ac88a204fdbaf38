"""Shapes by the syntax rules of SHACL (sections 2 to 5): every fault of every shape, and the rest to run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from pyoxigraph import BlankNode, NamedNode

from onto_compiler.rdf import RDF, SH
from onto_compiler.shacl.components import COMPONENTS
from onto_compiler.shacl.declarations import declaration_faults
from onto_compiler.shacl.expressions import expression_check
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.logic import SHAPE_COMPONENTS
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.paths import read_path
from onto_compiler.shacl.reader import Parameter, Reader
from onto_compiler.shacl.sparql import sparql_check
from onto_compiler.shacl.syntax import PARAMETERS, Triple3, broken, is_shape, query_faults
from onto_compiler.terms import show
from onto_compiler.vocabularies import meant

__all__ = ["misspelt", "sound_part"]

_TYPE, _PATH, _SPARQL = NamedNode(RDF + "type"), NamedNode(SH + "path"), NamedNode(SH + "sparql")
_EXPRESSION, _FILTER = NamedNode(SH + "expression"), NamedNode(SH + "filterShape")
_NODE_SHAPE, _PROPERTY_SHAPE = NamedNode(SH + "NodeShape"), NamedNode(SH + "PropertyShape")

_REFERENCES = ("node", "not", "property", "qualifiedValueShape", "and", "or", "xone", "condition", "rule")
_NO_SHAPE = {"message", "path", "severity", "deactivated", "sparql", "flags"}  # others have these too
_BUILDERS = {**COMPONENTS, **SHAPE_COMPONENTS}


def sound_part(graph: Graph, faults: list[ShapeFault]) -> Graph:
    """``graph`` without what is ill-formed, each fault of which is appended to ``faults``.

    What refers to a shape with a fault by another parameter than sh:property is left out too: such a shape is not
    the one that its author meant, so that nothing follows from whether a node conforms to it.
    """
    shapes = _shapes(graph)
    unknown = list(_unknown(graph))  # which are no faults here: see `misspelt`
    known = {triple for _, triple in unknown}
    declared = list(declaration_faults(graph))
    found = [one for shape in shapes for one in _faults(graph, shape) if one[1] not in known]
    found += [(fault, triple) for fault, triple in declared if triple is not None]
    misspelt_in = {subject for subject, _, _ in known}
    for fault, triple in _failing(_without(graph, [*found, *unknown]), shapes):
        if misspelt_in & set(_within(graph, triple)):
            unknown.append((fault, triple))  # told already: the misspelt term is what is wrong
        else:
            found.append((fault, triple))
    # One fault for all values of a property that are too many, at the last of them.
    wrong = {(fault.shape, fault.parameter, str(fault), _many(fault)): fault for fault, _ in (*declared, *found)}
    faults += wrong.values()
    return _without(graph, [*found, *unknown])


def misspelt(graph: Graph) -> list[ShapeFault]:
    """A fault (VOC011) for each use of a term of the SHACL namespace that SHACL does not have."""
    return [fault for fault, _ in _unknown(graph)]


def _without(graph: Graph, found: Iterable[tuple[ShapeFault, Triple3]]) -> Graph:
    """``graph`` without the triples that are at fault, and without what rests on their shapes."""
    left_out = {triple for _, triple in found}
    if not left_out:
        return graph
    pathless = {subject for subject, predicate, _ in left_out if predicate == _PATH}
    left_out |= _resting_on(graph, {subject for subject, _, _ in left_out}, pathless)
    return Graph(
        one for one in graph if one.subject not in pathless and (one.subject, one.predicate, one.object) not in left_out
    )


def _many(fault: ShapeFault) -> Term | None:
    return None if "and may have one" in str(fault) else fault.value


def _shapes(graph: Graph) -> list[Term]:
    """Every node that is declared or used as a shape, or has a target or a constraint."""
    found: set[Term] = {node for kind in (_NODE_SHAPE, _PROPERTY_SHAPE) for node in graph.instances(kind)}
    for name in PARAMETERS.keys() - _NO_SHAPE:
        found.update(graph.holders(NamedNode(SH + name)))
    for _, name, shape in _references(graph):
        if is_shape(graph, shape) and name != "rule":
            found.add(shape)
    return sorted((one for one in found if isinstance(one, (NamedNode, BlankNode))), key=str)


def _references(graph: Graph) -> Iterator[tuple[Triple3, str, Term]]:
    """Each triple that refers to shapes, with its parameter and one of the shapes."""
    for name in _REFERENCES:
        predicate = NamedNode(SH + name)
        for holder, values in graph.holders(predicate).items():
            for value in values:
                members = graph.items(value) or () if name in {"and", "or", "xone"} else (value,)
                for member in members:
                    yield (holder, predicate, value), name, member
    for holder, values in graph.holders(_EXPRESSION).items():
        for value in values:
            triple = (holder, _EXPRESSION, value)
            for node in _within(graph, triple):
                yield from ((triple, "expression", shape) for shape in graph.objects(node, _FILTER))


def _within(graph: Graph, triple: Triple3) -> Iterator[Term]:
    """The blank nodes of the node expression that a triple gives, without the shapes that it filters by."""
    todo, seen = [triple[2]] if triple[1] == _EXPRESSION else [], set[Term]()
    while todo:
        node = todo.pop()
        if node not in seen and isinstance(node, BlankNode):
            seen.add(node)
            yield node
            for predicate in graph.predicates(node):
                todo += graph.objects(node, predicate) if predicate != _FILTER else ()


def _resting_on(graph: Graph, unsound: set[Term], pathless: set[Term]) -> set[Triple3]:
    """The references to shapes that are not sound, and to those that have such references.

    The sound constraints of a property shape run, unless its path is unsound: it is then one of ``pathless``.
    """
    references: dict[Term, list[tuple[Triple3, str]]] = {}
    for triple, name, shape in _references(graph):
        references.setdefault(shape, []).append((triple, name))
    found, seen, todo = set[Triple3](), set(unsound), list(unsound)
    while todo:
        shape = todo.pop()
        for triple, name in references.get(shape, ()):
            if name != "property" or shape in pathless:
                found.add(triple)
            if triple[0] not in seen:
                seen.add(triple[0])
                todo.append(triple[0])
    return found


def _named(graph: Graph, shape: Term, names: Iterable[str]) -> list[str]:
    """Those of ``names`` that a shape has, in their order."""
    own = {predicate.value.removeprefix(SH) for predicate in graph.predicates(shape)}
    return [name for name in names if name in own]


def _faults(graph: Graph, shape: Term) -> Iterator[tuple[ShapeFault, Triple3]]:
    """What breaks a rule of the table, each with the triple that does."""
    reader = Reader(graph)
    has_path = bool(reader.values(shape, "path")) or bool(graph.subjects(NamedNode(SH + "property"), shape))
    types = graph.objects(shape, _TYPE)
    if _PROPERTY_SHAPE in types and not has_path:
        yield _fault("a property shape has no sh:path", shape, "path"), (shape, _TYPE, _PROPERTY_SHAPE)
    if _NODE_SHAPE in types and reader.values(shape, "path"):
        said = "a node shape has a sh:path, which only a property shape may have"
        for value in reader.values(shape, "path"):
            yield _fault(said, shape, "path", value), (shape, _TYPE, _NODE_SHAPE)
    for name in _named(graph, shape, PARAMETERS):
        rule, values = PARAMETERS[name], reader.values(shape, name)
        for said, value in broken(reader, shape, name, rule, values, has_path=has_path):
            yield _fault(said, shape, name, value), (shape, NamedNode(SH + name), value)
    for constraint in reader.values(shape, "sparql"):
        for said, holder, parameter, culprit in query_faults(reader, constraint):
            yield _fault(said, holder, parameter, culprit), (shape, _SPARQL, constraint)


def _failing(graph: Graph, shapes: Iterable[Term]) -> Iterator[tuple[ShapeFault, Triple3]]:
    """What follows the table and yet cannot run: a pattern that is no regular expression, a query that is no SPARQL."""
    reader = Reader(graph)
    for shape in shapes:
        path_node = reader.one(shape, "path")
        path = read_path(graph, path_node) if path_node is not None else None
        for name in _named(graph, shape, (*_BUILDERS, "sparql", "expression")):
            for value in reader.values(shape, name):
                triple = (shape, NamedNode(SH + name), value)
                try:
                    if name == "sparql":
                        sparql_check(reader, shape, path, value)
                    elif name == "expression":
                        expression_check(reader, shape, value)
                    else:
                        list(_BUILDERS[name](Parameter(reader, shape, name, value)))
                except ShapeFault as fault:
                    yield fault, triple


def _unknown(graph: Graph) -> Iterator[tuple[ShapeFault, Triple3]]:
    """Each term of the SHACL namespace that SHACL does not have."""
    for predicate in graph.properties:
        odd = _meant(predicate)
        for subject, values in graph.holders(predicate).items():
            for value in values:
                if odd is not None:
                    yield _misspelt(predicate, odd, subject, predicate), (subject, predicate, value)
                if (hint := _meant(value)) is not None:
                    yield _misspelt(value, hint, subject, predicate, value), (subject, predicate, value)


def _meant(term: Term) -> str | None:
    """What to write instead of a term of the SHACL namespace that SHACL does not have; None for any other."""
    return meant(term.value) if isinstance(term, NamedNode) and term.value.startswith(SH) else None


def _misspelt(term: Term, hint: str, subject: Term, predicate: NamedNode, value: Term | None = None) -> ShapeFault:
    said = f"`{show(term)}` is no term of its vocabulary"
    return ShapeFault(said, subject, predicate.value.removeprefix(SH), value, code="VOC011", hint=hint)


def _fault(message: str, shape: Term, name: str, value: Term | None = None) -> ShapeFault:
    return ShapeFault(message, shape, name, value)
