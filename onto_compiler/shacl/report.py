"""Results as data: the W3C's validation report (SHACL, section 3.6), and a record of each result for JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from onto_compiler.rdf import RDF, SH, boolean
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeResult
from onto_compiler.shacl.naming import path_text, shape_name
from onto_compiler.shacl.paths import describe, read_path
from onto_compiler.shacl.severity import severity_iri
from onto_compiler.terms import sentence, show

__all__ = ["component_iri", "record", "report", "term_record"]

_TYPE = NamedNode(RDF + "type")


def component_iri(component: str) -> str:
    """The IRI of a constraint component that a result names by its local name or by its IRI."""
    return component if ":" in component else SH + component


def report(results: Sequence[ShapeResult], shapes: Graph, *, complete: bool = True) -> Iterator[Triple]:
    """The ``sh:ValidationReport`` of ``results``; paths and the like are described as ``shapes`` has them.

    Where not every shape could run, the validation is not ``complete``, and nothing conforms.
    """
    top = BlankNode()
    yield Triple(top, _TYPE, _sh("ValidationReport"))
    yield Triple(top, _sh("conforms"), boolean(complete and not results))
    for result in results:
        node = BlankNode()
        yield Triple(top, _sh("result"), node)
        yield Triple(node, _TYPE, _sh("ValidationResult"))
        yield Triple(node, _sh("focusNode"), result.focus)
        if result.path is not None:
            path = read_path(shapes, result.path)
            written, triples = describe(path) if path is not None else (result.path, [])
            yield Triple(node, _sh("resultPath"), written)
            yield from triples
        if result.value is not None:
            yield Triple(node, _sh("value"), result.value)
        yield Triple(node, _sh("sourceConstraintComponent"), NamedNode(component_iri(result.component)))
        yield Triple(node, _sh("sourceShape"), result.shape)
        if result.constraint is not None:
            yield Triple(node, _sh("sourceConstraint"), result.constraint)
        yield Triple(node, _sh("resultSeverity"), NamedNode(severity_iri(result.severity)))
        yield from (Triple(node, _sh("resultMessage"), message) for message in _messages(result, shapes))
        yield from (Triple(node, predicate, value) for predicate, value in result.annotations)
    yield from _described(results, shapes)


def _sh(name: str) -> NamedNode:
    return NamedNode(SH + name)


def _messages(result: ShapeResult, shapes: Graph) -> tuple[Literal, ...]:
    if result.messages:
        return result.messages

    def shape(node: Term) -> str:
        return shape_name(shapes, node, show)

    return (Literal(sentence(result.expected, show, shape)),)


def _described(results: Sequence[ShapeResult], shapes: Graph) -> Iterator[Triple]:
    """What the shapes graph states of the blank nodes that results name, as they have no other description."""
    todo: list[Term] = [node for one in results for node in (one.shape, one.constraint) if isinstance(node, BlankNode)]
    seen: set[Term] = set()
    while todo:
        node = todo.pop()
        if node in seen or not isinstance(node, BlankNode):
            continue
        seen.add(node)
        for predicate in shapes.predicates(node):
            for value in shapes.objects(node, predicate):
                yield Triple(node, predicate, value)
                todo.append(value)


def record(result: ShapeResult, shapes: Graph) -> dict[str, Any]:
    """One result as JSON has it: SHACL's names, and terms as SPARQL 1.1 Query Results JSON writes them."""
    messages: dict[str, list[str]] = {}
    for message in _messages(result, shapes):
        messages.setdefault(message.language or "", []).append(message.value)
    annotations: dict[str, list[Any]] = {}
    for predicate, value in result.annotations:
        annotations.setdefault(predicate.value, []).append(term_record(value))
    return {
        "focusNode": term_record(result.focus),
        "resultPath": _path_record(result.path, shapes),
        "value": None if result.value is None else term_record(result.value),
        "sourceConstraintComponent": component_iri(result.component),
        "sourceShape": term_record(result.shape),
        "sourceConstraint": None if result.constraint is None else term_record(result.constraint),
        "resultSeverity": severity_iri(result.severity),
        "resultMessage": messages,
        "resultAnnotation": annotations,
    }


def _path_record(path: Term | None, shapes: Graph) -> dict[str, Any] | None:
    if path is None or isinstance(path, NamedNode):
        return None if path is None else term_record(path)
    return {"type": "path", "value": path_text(shapes, path, str)}


def term_record(term: Term) -> dict[str, Any]:
    """A term as SPARQL's results in JSON have it."""
    match term:
        case NamedNode():
            return {"type": "uri", "value": term.value}
        case BlankNode():
            return {"type": "bnode", "value": term.value}
        case Triple():
            parts = {"subject": term.subject, "predicate": term.predicate, "object": term.object}
            return {"type": "triple", "value": {name: term_record(part) for name, part in parts.items()}}
        case _ if term.language is not None:
            record = {"type": "literal", "value": term.value, "xml:lang": term.language}
            return record if term.direction is None else record | {"its:dir": term.direction.value}
        case _:
            return {"type": "literal", "value": term.value, "datatype": term.datatype.value}
