"""SHACL-SPARQL: ``sh:sparql`` constraints, constraint components and functions of the user's own (SHACL, 5 and 6)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from pyoxigraph import NamedNode

from onto_compiler.rdf import RDFS, SH
from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Check, Custom, Hit, Run, ShapeFault
from onto_compiler.shacl.paths import Path
from onto_compiler.shacl.prebinding import Query, read_query, unsupported
from onto_compiler.shacl.reader import Reader, local

__all__ = ["SHAPES_GRAPH", "Component", "components", "custom_checks", "fill", "sparql_check"]

SHAPES_GRAPH = NamedNode("urn:onto-evwm:shapesGraph")
_ALWAYS = ("this", "shapesGraph", "currentShape")
_SLOT = re.compile(r"\{[?$](\w+)\}")
_SUBCLASS = NamedNode(RDFS + "subClassOf")


def fill(template: str, given: Mapping[str, Term]) -> str:
    """A message with ``{$name}`` and ``{?name}`` replaced by values, as far as there are any."""
    return _SLOT.sub(lambda match: _plain(given[match[1]]) if match[1] in given else match[0], template)


def _plain(term: Term) -> str:
    return term.value.rpartition("#")[2] if isinstance(term, NamedNode) else term.value


def _read(shape: Term, text: str, names: Sequence[str], constraint: Term) -> Query:
    fault = unsupported(text, names)
    if fault:
        raise ShapeFault(fault, shape, "sparql", constraint)
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
    query = _read(shape, select, _ALWAYS, constraint)
    message, code, hint = reader.texts(constraint)
    find = _selecting(query, shape, {}, "SPARQLConstraintComponent", on_path=path is not None, message=message)
    return Custom("SPARQLConstraintComponent", find, "must not be selected by a query", message, code, hint)


def _selecting(
    query: Query, shape: Term, given: Mapping[str, Term], component: str, *, on_path: bool, message: str
) -> Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]:
    """Each solution of a SELECT is a violation."""
    fixed = {**given, "currentShape": shape, "shapesGraph": SHAPES_GRAPH}

    def find(run: Run, focus: Term, _: Sequence[Term]) -> Iterator[Hit]:
        bound = {**fixed, "this": focus}
        for row in _solve(run, query, bound, shape, component):
            found = row.get("value")
            value = run.data.written(found) if found is not None else None if on_path else focus
            path = row.get("path")
            own = row.get("message")
            text = fill(own.value if own is not None else message, {**bound, **row})
            yield Hit(value, path if isinstance(path, NamedNode) else None, text, row.get("this"))

    return find


def _solve(run: Run, query: Query, given: Mapping[str, Term], shape: Term, component: str) -> Iterator[dict[str, Term]]:
    try:
        try:
            yield from run.select(*query.bind(given))
        except SyntaxError:
            # A literal cannot be written as a subject: bound by a function, it merely matches nothing.
            yield from run.select(*query.bind_by_function(given))
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
            found.append(Component(one, parameters, reader.text(one, "message") or reader.text(one, "labelTemplate")))
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
    find: Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]
    if select is not None:
        query = _read(shape, select, (*_ALWAYS, *declared), validator)
        find = _selecting(query, shape, given, name, on_path=path is not None, message=message)
    else:
        ask = reader.query(validator, "ask", path)
        assert ask is not None  # noqa: S101 - what makes a validator one
        query = _read(shape, ask, (*_ALWAYS, "value", *declared), validator)
        find = _ask_query(query, shape, given, name, message)
    return Custom(name, find, f"must satisfy {_local_name(component.iri)}", fill(message, given))


def _ask_query(
    query: Query, shape: Term, given: Mapping[str, Term], component: str, message: str
) -> Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]:
    """An ASK that is false for a value node is a violation."""
    fixed = {**given, "currentShape": shape, "shapesGraph": SHAPES_GRAPH}

    def find(run: Run, focus: Term, values: Sequence[Term]) -> Iterator[Hit]:
        for value in values:
            bound = {**fixed, "this": focus, "value": value}
            if next(_solve(run, query, bound, shape, component), None) is None:
                yield Hit(value, message=fill(message, bound))

    return find
