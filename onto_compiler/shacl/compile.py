"""From a shapes graph to compiled shapes: those that have targets, and all that they refer to."""

from __future__ import annotations

from collections.abc import Iterator

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import OWL, RDF, RDFS, SH
from onto_compiler.shacl.components import COMPONENTS
from onto_compiler.shacl.expressions import expression_check
from onto_compiler.shacl.functions import declared_functions
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.logic import SHAPE_COMPONENTS
from onto_compiler.shacl.model import Check, Shape, ShapeFault, Shapes, Target, noting
from onto_compiler.shacl.paths import Path, read_path
from onto_compiler.shacl.prebinding import read_query
from onto_compiler.shacl.reader import Parameter, Reader, local
from onto_compiler.shacl.sparql import Component, components, custom_checks, sparql_check
from onto_compiler.shacl.wellformed import sound_part
from onto_compiler.terms import text_of

__all__ = ["Compiler", "compile_graph"]

_BUILDERS = {**COMPONENTS, **SHAPE_COMPONENTS}
_TARGETS = {
    "targetNode": "node",
    "targetClass": "class",
    "targetSubjectsOf": "subjects",
    "targetObjectsOf": "objects",
}
_TYPE = NamedNode(RDF + "type")
_CLASSES = (NamedNode(RDFS + "Class"), NamedNode(OWL + "Class"))
_SHAPES = (NamedNode(SH + "NodeShape"), NamedNode(SH + "PropertyShape"))


class Compiler:
    """Compiles the shapes of one graph, each once."""

    def __init__(self, graph: Graph) -> None:
        self.reader = Reader(graph)
        self.components: tuple[Component, ...] = components(self.reader)
        self.known: dict[Term, Shape] = {}
        self.faulty: dict[Term, ShapeFault] = {}
        self._referred: dict[Term, list[Term]] = {}
        self._classes = {node for cls in _CLASSES for node in graph.instances(cls)}

    def shape(self, node: Term) -> Shape:
        """The shape ``node``, and with it all that it refers to.

        Raises:
            ShapeFault: where it or one of those cannot run.

        """
        todo, reached = [node], list[Term]()
        while todo:
            one = todo.pop()
            if one in reached:
                continue
            reached.append(one)
            if one in self.faulty:
                raise self.faulty[one]
            if one not in self.known:
                self.known[one] = self._sound(one, node)
            todo += self._referred[one]
        return self.known[node]

    def _sound(self, node: Term, root: Term) -> Shape:
        """The shape ``node``; where it cannot run, ``root``, which refers to it, cannot either."""
        try:
            return self._compile(node)
        except ShapeFault as fault:
            self.faulty[node] = self.faulty[root] = fault
            raise
        except RecursionError:
            endless = ShapeFault("the shape is nested without end", node)
            self.faulty[node] = self.faulty[root] = endless
            raise endless from None

    def _compile(self, node: Term) -> Shape:
        reader = Reader(self.reader.graph)
        path_node = reader.one(node, "path")
        path = read_path(reader.graph, path_node) if path_node is not None else None
        if path_node is not None and path is None:
            raise ShapeFault("the sh:path is no property path", node, "path", path_node)
        targets = tuple(self.targets(node))
        checks = () if reader.is_true(node, "deactivated") else tuple(self._checks(reader, node, path))
        self._referred[node] = list(reader.wanted)
        severity = reader.one(node, "severity")
        message, code, hint = reader.texts(node)
        return Shape(
            node,
            path_node,
            path,
            checks,
            targets,
            reader.is_true(node, "deactivated"),
            local(text_of(severity)) if severity is not None else "Violation",
            message,
            code,
            hint,
            reader.messages(node),
        )

    def _checks(self, reader: Reader, node: Term, path: Path | None) -> Iterator[Check]:
        named = {p.value.removeprefix(SH) for p in reader.graph.predicates(node) if p.value.startswith(SH)}
        for name in sorted(named & _BUILDERS.keys()):
            for value in reader.values(node, name):
                yield from _BUILDERS[name](Parameter(reader, node, name, value))
        found = [sparql_check(reader, node, path, one) for one in reader.values(node, "sparql")]
        found += [expression_check(reader, node, one) for one in reader.values(node, "expression")]
        yield from (check for check in found if check is not None)
        yield from custom_checks(reader, node, path, self.components)

    def targets(self, node: Term) -> Iterator[Target]:
        """The targets of a shape (SHACL, section 2.1.3; SHACL-AF, section 3).

        Raises:
            ShapeFault: a target is not what it must be.

        """
        reader = self.reader
        for name, kind in _TARGETS.items():
            for value in reader.values(node, name):
                if kind != "node" and not isinstance(value, NamedNode):
                    raise ShapeFault(f"the value of sh:{name} is no IRI", node, name, value)
                yield Target(kind, value)
        if node in self._classes and any((node, _TYPE, kind) in reader.graph for kind in _SHAPES):
            yield Target("class", node)
        for value in reader.values(node, "target"):
            yield self._query_target(node, value)

    def _query_target(self, node: Term, target: Term) -> Target:
        """A ``sh:SPARQLTarget``, or a target of a declared type, whose parameters the target has."""
        reader = self.reader
        for holder in (target, *reader.values(target, _TYPE)):
            text = reader.query(holder, "select", what="the query of a target")
            if text is None:
                continue
            given = {
                path.value.rpartition("#")[2].rpartition("/")[2]: value
                for parameter in reader.values(holder, "parameter")
                for path in reader.values(parameter, "path")
                if isinstance(path, NamedNode)
                for value in reader.values(target, path)[:1]
            }
            return Target("query", target, read_query(text, given), given)
        raise ShapeFault("the sh:target has no sh:select", node, "target", target)


def _candidates(graph: Graph) -> list[Term]:
    """Every node that is declared as a shape or has a target."""
    found: set[Term] = {node for kind in _SHAPES for node in graph.instances(kind)}
    for name in (*_TARGETS, "target"):
        found.update(graph.holders(NamedNode(SH + name)))
    return sorted(found, key=str)


def compile_graph(graph: Graph, faults: list[ShapeFault] | None = None) -> Shapes:
    """Every shape of ``graph`` that has a target. What is ill-formed is left out and appended to ``faults``.

    Queries that must not be run are appended too, whether a shape uses them or not.

    Raises:
        ShapeFault: the first of them, where no list is given.

    """
    if faults is not None:
        graph = sound_part(graph, faults)
    compiler = Compiler(graph)
    for refused in compiler.reader.refused():
        with noting(faults):
            raise refused
    roots = []
    for node in _candidates(graph):
        with noting(faults):
            if isinstance(node, Literal) or not any(True for _ in compiler.targets(node)):
                continue
            shape = compiler.shape(node)
            if not shape.deactivated:
                roots.append(shape)
    return Shapes(tuple(roots), compiler.known, graph, declared_functions(compiler.reader, faults))
