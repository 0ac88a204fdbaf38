"""Validating a data graph: each focus node of each shape against its constraints (SHACL, section 3.4)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.lexical.store import LexicalStore
from onto_compiler.shacl.functions import Functions
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import (
    Annotation,
    Check,
    Custom,
    Hit,
    Nested,
    PerValue,
    Shape,
    ShapeFault,
    ShapeResult,
    Shapes,
    Target,
)
from onto_compiler.shacl.paths import follow
from onto_compiler.shacl.prebinding import Query, ask
from onto_compiler.shacl.sparql import SHAPES_GRAPH, fill

__all__ = ["Validation", "focus_nodes", "validate_graph"]


@dataclass
class Validation:
    """A run of ``shapes`` over ``data``. A shape that refers back to itself holds where only that is in question."""

    data: Graph
    shapes: Shapes
    _beside: LexicalStore | None = None
    _open: list[tuple[Shape, Term]] = field(default_factory=list)  # few at a time, so that no set is faster
    _assumed: int = 0  # how often something still open was taken to hold
    _decided: dict[tuple[Term, Term], bool] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if isinstance(self.shapes.functions, Functions) and self.shapes.functions:
            self.shapes.functions.data = self.data

    def conforms(self, node: Term, shape: Term) -> bool:
        """Whether ``node`` has no result against ``shape``."""
        key = (node, shape)
        if key in self._decided:
            return self._decided[key]
        before = self._assumed
        verdict = next(self._within(self.shapes.known[shape], node), None) is None
        if self._assumed == before:  # otherwise it may rest on what is still open
            self._decided[key] = verdict
        return verdict

    def results(self, shape: Shape, focus: Term) -> Iterator[ShapeResult]:
        """The results of one focus node against one shape."""
        values = (focus,) if shape.path is None else tuple(follow(self.data, focus, shape.path))
        for check in shape.checks:
            if isinstance(check, PerValue):
                test = check.test
                for value in values:
                    if not test(self, value):
                        yield _result(shape, focus, check, Hit(value))
            elif isinstance(check, Nested):
                nested = self.shapes.known[check.shape]
                for value in values:
                    yield from self._within(nested, value)
            else:
                for found in check.find(self, focus, values):
                    hit = found if isinstance(found, Hit) else Hit(found)
                    yield _result(shape, hit.focus or focus, check, hit)

    def _within(self, shape: Shape, focus: Term) -> Iterator[ShapeResult]:
        """:meth:`results` of a shape that another one refers to."""
        key = (shape, focus)
        if key in self._open:
            self._assumed += 1
            return
        self._open.append(key)
        try:
            yield from self.results(shape, focus)
        finally:
            self._open.remove(key)

    def select(self, query: Query, given: Mapping[str, Term]) -> Iterator[dict[str, Term]]:
        """The solutions of a SELECT over the data; an ASK gives one empty solution, or none."""
        store, union = self.data.store, True
        if "shapesGraph" in query.text:
            self._beside = self._beside or self.data.beside(self.shapes.graph, SHAPES_GRAPH)
            store, union = self._beside, False
        answer = ask(store, query, given, self.shapes.functions, union=union)
        if answer.kind == "construct":
            raise ValueError("a sh:select is no SELECT query")
        for row in answer.rows:
            yield {name: term for name, term in zip(answer.names, row, strict=True) if term is not None}


def _result(shape: Shape, focus: Term, check: Check, hit: Hit) -> ShapeResult:
    assert not isinstance(check, Nested)  # noqa: S101 - a nested shape has results of its own
    own = check if isinstance(check, Custom) else None
    value = hit.value
    message = hit.message or (own.message if own else "") or shape.message
    given = {"this": focus} | ({"value": value} if value is not None else {})
    said = {**hit.bound, **given}
    annotations = own.annotations if own else ()
    return ShapeResult(
        focus,
        hit.path or shape.path_node,
        value,
        check.component,
        shape.iri,
        fill(message, given),
        shape.severity,
        (own.code if own else "") or shape.code,
        (own.hint if own else "") or shape.hint,
        check.expected,
        _messages(shape, own, said),
        own.node if own else None,
        tuple((one.property, value) for one in annotations for value in _annotated(one, said)),
    )


def _messages(shape: Shape, own: Custom | None, said: Mapping[str, Term]) -> tuple[Literal, ...]:
    """Every message of a result: the query's own, or the constraint's, or the shape's."""
    told = said.get("message")
    if isinstance(told, Literal):
        return (_filled(told, said),)
    return tuple(_filled(one, said) for one in (own.messages if own and own.messages else shape.messages))


def _filled(message: Literal, said: Mapping[str, Term]) -> Literal:
    text = fill(message.value, said)
    return Literal(text, language=message.language, direction=message.direction) if message.language else Literal(text)


def _annotated(annotation: Annotation, said: Mapping[str, Term]) -> tuple[Term, ...]:
    found = said.get(annotation.name)
    return annotation.values if found is None else (found,)


def focus_nodes(data: Graph, targets: Iterable[Target]) -> Iterable[Term]:
    """The nodes that ``targets`` select, each once."""
    found: dict[Term, None] = {}
    for target in targets:
        match target.kind:
            case "node":
                found.update({target.term: None} if data.describes(target.term) else {})
            case "class":
                found.update(data.instances(target.term))
            case "subjects":
                found.update(dict.fromkeys(data.holders(cast("NamedNode", target.term))))
            case "objects":
                found.update(dict.fromkeys(data.values(cast("NamedNode", target.term))))
            case _:
                found.update({node: None for node in _selected(data, target) if data.describes(node)})
    return found


def _selected(data: Graph, target: Target) -> Iterator[Term]:
    assert target.query is not None  # noqa: S101 - what the kind says
    try:
        answer = ask(data.store, target.query, target.given)
    except SyntaxError as error:
        text = " ".join(str(error).partition(", [")[0].split())
        raise ShapeFault(f"the query of a target cannot run: {text}", target.term) from error
    if answer.kind != "select":
        raise ShapeFault("the query of a target is no SELECT", target.term)
    return (row[0] for row in answer.rows if row[0] is not None)


def validate_graph(data: Graph, shapes: Shapes, faults: list[ShapeFault] | None = None) -> tuple[ShapeResult, ...]:
    """Every result of ``data`` against ``shapes``; where the same fault is found twice, it is there twice.

    Raises:
        ShapeFault: a query cannot run, and no list for ``faults`` is given.

    """
    run = Validation(data, shapes)
    results: list[ShapeResult] = []
    for shape in shapes.roots:
        try:
            for focus in focus_nodes(data, shape.targets):
                results.extend(run.results(shape, focus))
        except ShapeFault as fault:
            if faults is None:
                raise
            faults.append(fault)
        except RecursionError:
            endless = ShapeFault("the shape follows a chain of nodes that is too long", shape.iri)
            if faults is None:
                raise endless from None
            faults.append(endless)
    return tuple(results)
