"""SHACL-SPARQL: ``sh:sparql`` constraints, constraint components and functions of the user's own (SHACL, 5 and 6)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import RDFS, SH
from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Annotation, Check, Custom, Hit, Run, ShapeFault
from onto_compiler.shacl.paths import Path
from onto_compiler.shacl.prebinding import Query, read_query, unsupported
from onto_compiler.shacl.reader import Reader, local
from onto_compiler.terms import text_of

__all__ = ["SHAPES_GRAPH", "Component", "components", "custom_checks", "fill", "sparql_check", "sparql_custom"]

SHAPES_GRAPH = NamedNode("urn:onto-evwm:shapesGraph")
_ALWAYS = ("this", "shapesGraph", "currentShape")
_SPARQL = "SPARQLConstraintComponent"
_SLOT = re.compile(r"\{[?$](\w+)\}")
Find = Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]
_SUBCLASS = NamedNode(RDFS + "subClassOf")


def fill(template: str, given: Mapping[str, Term]) -> str:
    """A message with ``{$name}`` and ``{?name}`` replaced by values, as far as there are any."""
    return _SLOT.sub(lambda match: _plain(given[match[1]]) if match[1] in given else match[0], template)


def _plain(term: Term) -> str:
    return term.value.rpartition("#")[2] if isinstance(term, NamedNode) else text_of(term)


def _read(reader: Reader, holder: Term, name: str, text: str, names: Sequence[str]) -> Query:
    """The query ``sh:name`` of ``holder``, which is asked as ``text``.

    Raises:
        ShapeFault: something in it may not stand beside pre-bound variables.

    """
    written = reader.one(holder, name)
    found = unsupported(written.value, names) if isinstance(written, Literal) else None
    if found is not None:
        said, token = found
        raise ShapeFault(said, holder, name, written, inside=(token.start, token.end - token.start))
    return read_query(text, names)


def sparql_check(reader: Reader, shape: Term, path: Path | None, constraint: Term) -> Check | None:
    """The check of one ``sh:sparql`` constraint; None if it is deactivated.

    Raises:
        ShapeFault: the constraint has no SELECT query, or one that cannot run.

    """
    if reader.is_true(constraint, "deactivated"):
        return None
    select = reader.query(constraint, "select", path)
    if select is None:
        raise ShapeFault("a sh:sparql constraint has no sh:select", shape, "sparql", constraint)
    query = _read(reader, constraint, "select", select, _ALWAYS)
    message = reader.text(constraint, "message")
    find = _selecting(query, shape, {}, _SPARQL, on_path=path is not None, message=message)
    return sparql_custom(reader, constraint, find)


def sparql_custom(reader: Reader, constraint: Term, find: Find) -> Custom:
    """The check of a ``sh:sparql`` constraint whose violations ``find`` yields."""
    message, code, hint = reader.texts(constraint)
    messages, annotations = reader.messages(constraint), _annotations(reader, constraint)
    said = "must not be selected by a query"
    return Custom(_SPARQL, find, said, message, code, hint, messages, constraint, annotations)


def _annotations(reader: Reader, constraint: Term) -> tuple[Annotation, ...]:
    """What ``sh:resultAnnotation`` of a query asks for."""
    found = []
    for node in reader.values(constraint, "resultAnnotation"):
        predicate, name = reader.one(node, "annotationProperty"), reader.one(node, "annotationVarName")
        if not isinstance(predicate, NamedNode):
            raise ShapeFault("a sh:resultAnnotation has no sh:annotationProperty", constraint, "resultAnnotation", node)
        values = tuple(reader.values(node, "annotationValue"))
        found.append(Annotation(predicate, text_of(name) if name is not None else _local_name(predicate), values))
    return tuple(found)


def _selecting(
    query: Query, shape: Term, given: Mapping[str, Term], component: str, *, on_path: bool, message: str
) -> Find:
    """Each solution of a SELECT is a violation."""
    fixed = {**given, "currentShape": shape, "shapesGraph": SHAPES_GRAPH}

    def find(run: Run, focus: Term, _: Sequence[Term]) -> Iterator[Hit]:
        bound = {**fixed, "this": focus}
        for row in _solve(run, query, bound, shape, component):
            value = row.get("value") or (None if on_path else focus)
            path = row.get("path")
            own = row.get("message")
            text = fill(text_of(own) if own is not None else message, {**bound, **row})
            said = {**bound, **row}
            yield Hit(value, path if isinstance(path, NamedNode) else None, text, row.get("this"), said)

    return find


def _solve(run: Run, query: Query, given: Mapping[str, Term], shape: Term, component: str) -> Iterator[dict[str, Term]]:
    try:
        yield from run.select(query, given)
    except (SyntaxError, ValueError, RuntimeError) as error:
        # Behind the first alternatives Oxigraph lists whole classes of characters.
        text = " ".join(str(error).partition(", [")[0].split())
        raise ShapeFault(f"the {local(component)} cannot run: {text}", shape) from error


@dataclass(frozen=True, slots=True)
class Component:
    """A constraint component that a shapes graph declares; ``parameters`` says of each path whether it is optional."""

    iri: NamedNode
    parameters: Mapping[NamedNode, bool]
    message: str
    messages: tuple[Literal, ...] = ()

    def applies(self, reader: Reader, shape: Term) -> bool:
        """Whether a shape has every parameter that is not optional."""
        return all(optional or reader.values(shape, path) for path, optional in self.parameters.items())

    def bindings(self, reader: Reader, shape: Term) -> Iterator[dict[str, Term]]:
        """The parameters by local name, in every combination of their values."""
        values = {_local_name(path): reader.values(shape, path) for path in self.parameters}
        values = {name: found for name, found in values.items() if found}
        for row in product(*values.values()):
            yield dict(zip(values, row, strict=True))


def _local_name(iri: NamedNode) -> str:
    match = re.search(r"\w+$", iri.value)
    return match[0] if match else iri.value


def components(reader: Reader) -> tuple[Component, ...]:
    """The constraint components that the shapes graph declares, SHACL's own left out."""
    found = []
    for one in reader.graph.instances(NamedNode(SH + "ConstraintComponent")):
        if not isinstance(one, NamedNode) or one.value.startswith(SH):
            continue
        parameters = {
            path: reader.is_true(parameter, "optional")
            for parameter in reader.values(one, "parameter")
            for path in reader.values(parameter, "path")
            if isinstance(path, NamedNode)
        }
        if not all(parameters.values()):
            message = reader.text(one, "message") or reader.text(one, "labelTemplate")
            found.append(Component(one, parameters, message, reader.messages(one)))
    return tuple(sorted(found, key=lambda component: component.iri.value))


def custom_checks(reader: Reader, shape: Term, path: Path | None, declared: Sequence[Component]) -> Iterator[Check]:
    """The checks of a shape that use declared components.

    Raises:
        ShapeFault: a component has no validator that suits the shape, or one whose query cannot run.

    """
    for component in declared:
        if component.applies(reader, shape):
            validator = _validator(reader, component, path, shape)
            for given in component.bindings(reader, shape):
                yield _custom(reader, shape, path, component, validator, given)


def _validator(reader: Reader, component: Component, path: Path | None, shape: Term) -> Term:
    own = "nodeValidator" if path is None else "propertyValidator"
    for name in (own, "validator"):
        for validator in reader.values(component.iri, name):
            if reader.values(validator, "select") or reader.values(validator, "ask"):
                return validator
    raise ShapeFault(f"the component {component.iri} has no SPARQL validator for this kind of shape", shape)


def _custom(
    reader: Reader, shape: Term, path: Path | None, component: Component, validator: Term, given: Mapping[str, Term]
) -> Check:
    message = reader.text(validator, "message") or component.message
    declared = [_local_name(parameter) for parameter in component.parameters]
    select = reader.query(validator, "select", path)
    name = component.iri.value
    find: Find
    if select is not None:
        query = _read(reader, validator, "select", select, (*_ALWAYS, *declared))
        find = _selecting(query, shape, given, name, on_path=path is not None, message=message)
    else:
        ask = reader.query(validator, "ask", path)
        assert ask is not None  # noqa: S101 - what makes a validator one
        query = _read(reader, validator, "ask", ask, (*_ALWAYS, "value", *declared))
        find = _asking(query, shape, given, name, message)
    messages = reader.messages(validator) or component.messages
    annotations = _annotations(reader, validator)
    expected = ("must satisfy ", component.iri)
    return Custom(name, find, expected, fill(message, given), messages=messages, annotations=annotations)


def _asking(query: Query, shape: Term, given: Mapping[str, Term], component: str, message: str) -> Find:
    """An ASK that is false for a value node is a violation."""
    fixed = {**given, "currentShape": shape, "shapesGraph": SHAPES_GRAPH}

    def find(run: Run, focus: Term, values: Sequence[Term]) -> Iterator[Hit]:
        for value in values:
            bound = {**fixed, "this": focus, "value": value}
            if next(_solve(run, query, bound, shape, component), None) is None:
                yield Hit(value, message=fill(message, bound), bound=bound)

    return find
