"""From the results of a validation to problems: where the offending triple stands, and where the shape does."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, Triple

from onto_compiler.check.blanks import same_blanks
from onto_compiler.check.documents import Document
from onto_compiler.check.query_terms import undeclared_in_queries
from onto_compiler.problems import Problem, Span
from onto_compiler.rdf import RDF
from onto_compiler.shacl.compile import compile_graph
from onto_compiler.shacl.graph import Graph, Subject, Term
from onto_compiler.shacl.model import ShapeFault, ShapeResult
from onto_compiler.shacl.naming import path_text, shape_id, shape_label, shape_name
from onto_compiler.shacl.paths import read_path
from onto_compiler.shacl.report import record
from onto_compiler.shacl.rules import infer
from onto_compiler.shacl.severity import level
from onto_compiler.shacl.validate import validate_graph
from onto_compiler.shacl.wellformed import misspelt
from onto_compiler.terms import ShapeOf, sentence, show
from onto_compiler.turtle.source_map import Located, SourceMap
from onto_compiler.turtle.tokens import SourceText

__all__ = ["place"]

_TYPE = NamedNode(RDF + "type")
_UNKNOWN = re.compile(r'sh:prefix "([^"]*)" ; sh:namespace "\.\.\."')


def place(
    data: Sequence[Document],
    shapes: Sequence[Document],
    results: Sequence[ShapeResult],
    faults: Sequence[ShapeFault],
    remarks: Sequence[ShapeFault] = (),
) -> Iterator[Problem]:
    """The problems that ``results``, ``faults`` and ``remarks`` are. All are found again in what the walker reads.

    ``remarks`` are faults of shapes that run all the same.
    """
    in_data, in_shapes = _Places(data), _Places(shapes)
    if not in_data.whole or not in_shapes.whole:
        pass
    elif not faults and not remarks:
        results = _as_walked(results, in_data, in_shapes)
    else:
        again = misspelt(in_shapes.graph)
        compiled = compile_graph(in_shapes.graph, again)
        noted = tuple(undeclared_in_queries(in_shapes.graph, in_data.graph))
        infer(in_data.graph, compiled.graph, again)
        found = validate_graph(in_data.graph, compiled, again)
        if (len(found), len(again), len(noted)) == (len(results), len(faults), len(remarks)):
            results, faults, remarks = found, again, noted
    writer = _Writer(in_data, in_shapes)
    for result in results:
        yield writer.problem(result)
    for fault in (*faults, *remarks):
        yield writer.fault(fault)


def _as_walked(results: Sequence[ShapeResult], data: _Places, shapes: _Places) -> list[ShapeResult]:
    """``results`` with the blank nodes of the walker in the place of Oxigraph's."""
    names = shapes.walked()
    if any(isinstance(term, (BlankNode, Triple)) for result in results for term in (result.focus, result.value)):
        names = {**names, **data.walked()}

    def name(term: Term) -> Term:
        if isinstance(term, Triple):
            return Triple(cast("Subject", name(term.subject)), term.predicate, name(term.object))
        return names.get(term, term) if isinstance(term, BlankNode) else term

    def part(one: str | Term | ShapeOf) -> str | Term | ShapeOf:
        return one if isinstance(one, str) else ShapeOf(name(one.node)) if isinstance(one, ShapeOf) else name(one)

    return [
        replace(
            result,
            focus=name(result.focus),
            path=None if result.path is None else name(result.path),
            value=None if result.value is None else name(result.value),
            shape=name(result.shape),
            constraint=None if result.constraint is None else name(result.constraint),
            expected=result.expected if isinstance(result.expected, str) else tuple(map(part, result.expected)),
            annotations=tuple((predicate, name(value)) for predicate, value in result.annotations),
        )
        for result in results
    ]


class _Spot(NamedTuple):
    """A triple where it is written."""

    path: Path
    located: Located


def _map(document: Document) -> SourceMap | None:
    try:
        return document.source_map() if document.has_places else None
    except RecursionError:  # brackets nested deeper than the walker goes
        return None


@dataclass(slots=True)
class _Places:
    """Documents read again with their places; ``whole`` says whether the walker read what Oxigraph had read."""

    documents: Sequence[Document]
    maps: dict[Path, SourceMap] = field(default_factory=dict)
    graph: Graph = field(default_factory=Graph)
    whole: bool = False
    _triples: dict[tuple[Term, Term, Term], _Spot] = field(default_factory=dict)
    _subjects: dict[Term, list[_Spot]] = field(default_factory=dict)
    _objects: dict[Term, list[_Spot]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        statements: list[Quad | Triple] = []
        for document in self.documents:
            source_map = _map(document)
            if source_map is None:
                statements += document.statements
                continue
            self.maps[document.path] = source_map
            for one in source_map.triples:
                statements.append(Triple(one.subject, one.predicate, one.object))
                spot = _Spot(document.path, one)
                self._triples.setdefault((one.subject, one.predicate, one.object), spot)
                self._subjects.setdefault(one.subject, []).append(spot)
                self._objects.setdefault(one.object, []).append(spot)
        self.graph = Graph(statements)
        self.whole = len(self.graph) == len(Graph(s for d in self.documents for s in d.statements))

    def walked(self) -> dict[BlankNode, BlankNode]:
        """Each blank node as Oxigraph read it, with the walker's name for it."""
        found: dict[BlankNode, BlankNode] = {}
        for document in self.documents:
            if document.path in self.maps:
                found |= same_blanks(document.statements, self.maps[document.path].triples)
        return found

    def object(self, subject: Term, predicate: Term, value: Term, inside: tuple[int, int] | None = None) -> Span | None:
        """The object of a triple, or what is ``inside`` it: a character of a literal, and how many from it on."""
        spot = self._triples.get((subject, predicate, value))
        if spot is not None and inside is not None and spot.located.at_object.kind == "string":
            return self.maps[spot.path].inside(spot.located.at_object, *inside)
        return self._span(spot, "object")

    def predicate(self, subject: Term, predicate: Term) -> Span | None:
        """The last statement of a property of a node: the one that is too many."""
        found = [spot for spot in self._subjects.get(subject, ()) if spot.located.predicate == predicate]
        return self._span(found[-1] if found else None, "predicate")

    def reached(self, value: Term, predicates: frozenset[str]) -> Span | None:
        """Where a node stands as the object of one of ``predicates``."""
        found = (spot for spot in self._objects.get(value, ()) if spot.located.predicate.value in predicates)
        return self._span(next(found, None), "object")

    def subject(self, node: Term) -> Span | None:
        """Where a node is declared, or else described, or else mentioned."""
        spots = self._subjects.get(node, [])
        declared = [spot for spot in spots if spot.located.predicate == _TYPE]
        if spots:
            return self._span((declared or spots)[0], "subject")
        return self._span(next(iter(self._objects.get(node, ())), None), "object")

    def mention(self, node: Term) -> Term | None:
        """The first node that has ``node`` for a value."""
        spots = self._objects.get(node)
        return spots[0].located.subject if spots else None

    def _span(self, spot: _Spot | None, part: str) -> Span | None:
        if spot is None:
            return None
        token = {
            "object": spot.located.at_object,
            "predicate": spot.located.at_predicate,
            "subject": spot.located.at_subject,
        }[part]
        return self.maps[spot.path].span(token)

    def file_of(self, subject: Term) -> Path | None:
        """The first document that describes a node, whether it has places or not."""
        for document in self.documents:
            if any(statement.subject == subject for statement in document.statements):
                return document.path
        return None

    def shown(self, term: Term, file: str = "") -> str:
        """A term with the prefixes of ``file``, or of whichever document has one that fits."""
        own = [source_map for path, source_map in self.maps.items() if str(path) == file]
        return show(term, ((one.name, one.namespace) for each in (*own, *self.maps.values()) for one in each.declared))

    def place_of(self, node: Term) -> str:
        """Line and column of a node, with its file where there are several; empty where it has none."""
        span = self.subject(node)
        if span is None:
            return ""
        file = "" if len(self.documents) == 1 else f"{_relative(span.file)}:"
        return f"{file}{span.line}:{span.column}"

    def within(self, subject: Term, value: Term) -> Span | None:
        """Where ``value`` stands as a value of ``subject``, whatever the property."""
        found = (spot for spot in self._objects.get(value, ()) if spot.located.subject == subject)
        return self._span(next(found, None), "object")


@dataclass(frozen=True, slots=True)
class _Writer:
    data: _Places
    shapes: _Places

    def problem(self, result: ShapeResult) -> Problem:
        """One result as a problem."""
        span = self._where(result)
        name = self._owner(result.shape)
        subject = self.data.shown(result.focus, span.file)
        message = f"`{subject}` violates {name}: {self._message(result, span.file)}"
        shape = self.shapes.subject(result.shape)
        at = f" at {_relative(shape.file)}:{shape.line}:{shape.column}" if shape is not None else ""
        hint = result.hint or f"change the data, or the shape{at}; see `onto explain SHP001`"
        severity = level(result.severity, self.shapes.graph)
        found = Problem.at(span, result.code or "SHP001", message, hint, severity)
        return replace(found, result=self._record(result, shape))

    def _record(self, result: ShapeResult, shape: Span | None) -> dict[str, Any]:
        graph = self.shapes.graph
        place = {} if shape is None else {"file": _relative(shape.file), "line": shape.line, "column": shape.column}
        return {
            **record(result, graph),
            "shape": {
                "name": shape_id(graph, result.shape, self.shapes.shown),
                "label": shape_label(graph, result.shape),
                **place,
            },
        }

    def fault(self, fault: ShapeFault) -> Problem:
        """A shape that cannot run."""
        parameter = fault.predicate
        span = None
        if parameter is not None and fault.value is not None:
            span = self.shapes.object(fault.shape, parameter, fault.value, fault.inside)
        if span is None and parameter is not None:
            span = self.shapes.predicate(fault.shape, parameter)
        span = span or self.shapes.subject(fault.shape)
        (code, message, hint), severity = fault.fields, fault.problems[0].severity
        if span is None:  # of a format without places
            file = self.shapes.file_of(fault.shape) or self.shapes.documents[0].path
            return Problem.at(Span(str(file)), code, f"{message}{_within(fault)}", hint, severity)
        return Problem.at(span, code, message, _UNKNOWN.sub(self._namespace, hint), severity)

    def _namespace(self, match: re.Match[str]) -> str:
        """The namespace that a shapes file gives a prefix, where a hint leaves it open."""
        known = (one for each in self.shapes.maps.values() for one in each.declared if one.name == match[1])
        found = next(known, None)
        return match[0] if found is None else match[0].replace("...", found.namespace)

    def _where(self, result: ShapeResult) -> Span:
        """From the narrowest place to the widest."""
        for span in self._candidates(result):
            if span is not None:
                return span
        file = self.data.file_of(result.focus)
        if file is None and (span := self.shapes.subject(result.focus)) is not None:
            return span  # a target node that the data do not mention
        return Span(str(file or self.data.documents[0].path))

    def _candidates(self, result: ShapeResult) -> Iterator[Span | None]:
        path, value = result.path, result.value
        if path is None and value is not None and value != result.focus:
            yield self.data.within(result.focus, value)
        if isinstance(path, NamedNode):
            if value is not None:
                yield self.data.object(result.focus, path, value)
            yield self.data.predicate(result.focus, path)
        elif path is not None and value is not None:
            predicates = frozenset(self._predicates(path))
            yield from (self.data.object(value, NamedNode(one), result.focus) for one in predicates)  # an inverse path
            yield self.data.reached(value, predicates)
        yield self.data.subject(result.focus)

    def _predicates(self, node: Term) -> Iterable[str]:
        path = read_path(self.shapes.graph, node)
        todo = [path] if path is not None else []
        while todo:
            one = todo.pop()
            if one.iri is not None:
                yield one.iri.value
            todo += one.parts

    def _message(self, result: ShapeResult, file: str) -> str:
        if result.message:
            return result.message
        expected = sentence(result.expected, partial(self._shown, file=file), self._shape)
        path = f"`{self._path(result.path, file)}`" if result.path is not None else ""
        if result.value is not None and result.value != result.focus:
            value = f"`{self.data.shown(result.value, file)}`"
            return f"the value {value} of {path} {expected}" if path else f"{value} {expected}"
        return f"{path} {expected}".strip()

    def _shown(self, term: Term, file: str) -> str:
        """A term as the data write it, or else as the shapes do."""
        shown = self.data.shown(term, file)
        return self.shapes.shown(term) if shown.startswith("<") and not isinstance(term, Triple) else shown

    def _path(self, node: Term, file: str) -> str:
        return path_text(self.shapes.graph, node, partial(self._shown, file=file))

    def _shape(self, node: Term) -> str:
        return shape_name(self.shapes.graph, node, self.shapes.shown, self.shapes.place_of(node))

    def _owner(self, shape: Term) -> str:
        """A shape by name, or by the nearest named one that it belongs to, or else by what it is."""
        seen: set[Term] = set()
        node = shape
        while isinstance(node, BlankNode) and node not in seen:
            seen.add(node)
            above = self.shapes.mention(node)
            if above is None:
                return self._shape(shape)
            node = above
        return self._shape(node if isinstance(node, NamedNode) else shape)


def _within(fault: ShapeFault) -> str:
    """The place of a fault within a query, where the file has none."""
    if fault.inside is None or not isinstance(fault.value, Literal):
        return ""
    span = SourceText("", fault.value.value).span(fault.inside[0], fault.inside[0] + 1)
    return f" (line {span.line}, column {span.column} of the query)"


def _relative(file: str) -> str:
    """The path of a file, relative to the working directory if it is below it."""
    try:
        return str(Path(file).relative_to(Path.cwd()))
    except ValueError:
        return file
