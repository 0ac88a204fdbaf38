"""SHACL Core, the part that our shapes use, compiled to SPARQL and run by Oxigraph; the rest is left to pySHACL.

Source: SHACL (W3C, 2017), sections 2-5. Results carry what a ``sh:ValidationResult`` carries. A shape with a constraint
component that is not compiled here runs on pySHACL, which is imported only then.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, cast

from pyoxigraph import BlankNode, Literal, NamedNode, QuerySolutions, Store, Variable

from onto_compiler.rdf import BASE, RDF, SH, node, prologue
from onto_compiler.shapes_sparql import CONSTRAINTS, Constraint, ShapeFault, Term, path_text, term_text

__all__ = ["Shape", "ShapeResult", "compile_shapes", "validate"]

_VIOLATION = node(SH + "Violation")
_META = {
    "description", "declare", "deactivated", "defaultValue", "flags", "group", "message", "name", "order", "path",
    "prefixes", "property", "rule", "severity", "sparql", "targetClass", "targetNode", "targetObjectsOf",
    "targetSubjectsOf",
}  # fmt: skip
_CODE, _HINT = node(BASE + "shapes#code"), node(BASE + "shapes#hint")
_ROOTS = """
SELECT DISTINCT ?shape WHERE {
    { ?shape a sh:NodeShape } UNION { ?shape sh:targetClass ?any } UNION { ?shape sh:targetNode ?any }
    UNION { ?shape sh:targetSubjectsOf ?any } UNION { ?shape sh:targetObjectsOf ?any }
}"""


@dataclass(frozen=True, slots=True)
class ShapeResult:
    """One ``sh:ValidationResult``. ``path`` is None for a node shape; our own shapes give ``code`` and ``hint``."""

    focus: Term
    path: Term | None
    value: Term | None
    component: str  # local name, e.g. "MinCountConstraintComponent"
    shape: Term
    message: str = ""
    severity: str = "Violation"  # local name
    code: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True)
class _Check:
    """One constraint of one shape: ``query`` selects ``?this`` and perhaps ``?value``."""

    shape: Term
    path: Term | None
    component: str
    query: str
    message: str
    severity: str
    code: str
    hint: str
    per_focus: str = ""  # the targets' query, where ``query`` (of sh:sparql) is to be asked of each focus node


@dataclass(frozen=True, slots=True)
class Shape:
    """A node or property shape with targets, compiled; ``foreign`` says why it must run on pySHACL instead."""

    iri: Term
    checks: tuple[_Check, ...]
    foreign: str = ""


@dataclass(slots=True)
class _Reader:
    """Reads shapes out of a store, all graphs together."""

    store: Store
    root: Term = field(default_factory=lambda: node(SH + "NodeShape"))  # the shape that is being read
    unknown: set[str] = field(default_factory=set)

    def values(self, subject: Term, name: str) -> list[Term]:
        if isinstance(subject, Literal):
            return []
        predicate = node(name if ":" in name else SH + name)
        found = self.store.quads_for_pattern(cast("NamedNode", subject), predicate, None, None)
        return list(dict.fromkeys(cast("Term", quad.object) for quad in found))

    def one(self, subject: Term, name: str) -> Term | None:
        return next(iter(self.values(subject, name)), None)

    def parameters(self, shape: Term) -> list[str]:
        """The local names of a shape's constraint parameters, in alphabetical order."""
        quads = self.store.quads_for_pattern(cast("NamedNode", shape), None, None, None)
        names = {quad.predicate.value.removeprefix(SH) for quad in quads if quad.predicate.value.startswith(SH)}
        return sorted(names - _META)

    def items(self, head: Term) -> list[Term]:
        """The members of an RDF list."""
        members: list[Term] = []
        seen: set[Term] = set()
        while head.value != RDF + "nil" and head not in seen:
            seen.add(head)
            first, rest = self.one(head, RDF + "first"), self.one(head, RDF + "rest")
            if first is None or rest is None:
                raise ShapeFault("a list in this shape does not end", self.root)
            members.append(first)
            head = rest
        return members


def compile_shapes(store: Store, faults: list[ShapeFault] | None = None) -> tuple[Shape, ...]:
    """Every shape of ``store`` that has a target. Shapes that cannot run are left out and appended to ``faults``.

    Raises:
        ShapeFault: the first of them, where no list is given.

    """
    reader = _Reader(store)
    rows = cast("QuerySolutions", store.query(prologue() + _ROOTS, use_default_graph_as_union=True))
    roots = sorted({cast("Term", row["shape"]) for row in rows}, key=str)
    shapes = []
    for root in roots:
        reader.root, reader.unknown = root, set()
        try:
            targets = _targets(reader, root)
            if not targets or _off(reader, root):
                continue
            checks = tuple(_shape(reader, _Place(root, targets, reader.one(root, "path"))))
        except ShapeFault as fault:
            _keep(fault, faults)
        else:
            shapes.append(Shape(root, checks, ", ".join(sorted(reader.unknown))))
    return tuple(shape for shape in shapes if shape.checks or shape.foreign)


def validate(
    store: Store, shapes: tuple[Shape, ...], faults: list[ShapeFault] | None = None
) -> tuple[ShapeResult, ...]:
    """Validate all graphs of ``store`` together against ``shapes``; as for ``faults``, see :func:`compile_shapes`.

    Raises:
        ShapeFault: the query of a ``sh:sparql`` constraint is not valid, and no list is given.

    """
    results: list[ShapeResult] = []
    for shape in shapes:
        try:
            if shape.foreign:
                from onto_compiler.shapes_pyshacl import validate_foreign  # noqa: PLC0415 - a second to import

                results += [_known(row, shapes) for row in validate_foreign(store, shape.iri)]
            else:
                results += [result for check in shape.checks for result in _run(store, check)]
        except ShapeFault as fault:
            _keep(fault, faults)
    return tuple(dict.fromkeys(results))


def _keep(fault: ShapeFault, faults: list[ShapeFault] | None) -> None:
    if faults is None:
        raise fault
    faults.append(fault)


def _known(row: tuple[Term, Term | None, Term | None, str, Term, str, str], shapes: tuple[Shape, ...]) -> ShapeResult:
    same = (check for shape in shapes for check in shape.checks if check.shape == row[4])
    check = next(same, None)
    return ShapeResult(*row, code=check.code if check else "", hint=check.hint if check else "")


def _off(reader: _Reader, shape: Term) -> bool:
    value = reader.one(shape, "deactivated")
    return value is not None and value.value == "true"


def _targets(reader: _Reader, shape: Term) -> str:
    for name in ("targetClass", "targetSubjectsOf", "targetObjectsOf"):
        for target in reader.values(shape, name):
            if not isinstance(target, NamedNode):
                raise ShapeFault(f"the value of sh:{name} is no IRI", shape, name, target)
    parts = [f"?this a/rdfs:subClassOf* {term_text(cls)} ." for cls in reader.values(shape, "targetClass")]
    parts += [f"?this {term_text(path)} ?any ." for path in reader.values(shape, "targetSubjectsOf")]
    parts += [f"?any {term_text(path)} ?this ." for path in reader.values(shape, "targetObjectsOf")]
    parts += [f"VALUES ?this {{ {term_text(one)} }}" for one in reader.values(shape, "targetNode")]
    union = " UNION ".join(f"{{ {part} }}" for part in parts)
    return f"{{ SELECT DISTINCT ?this WHERE {{ {union} }} }}" if parts else ""


@dataclass(frozen=True, slots=True)
class _Place:
    """A shape being compiled: its node, its targets, and its path as a term and as SPARQL (empty in a node shape)."""

    shape: Term
    targets: str
    path: Term | None = None
    text: str = ""


def _shape(reader: _Reader, place: _Place) -> Iterator[_Check]:
    """The checks of one shape and, where it has no path, of its property shapes."""
    if place.path is not None:
        place = replace(place, text=path_text(place.path, reader.values, reader.items))
        if not place.text:
            raise ShapeFault("the sh:path is no property path", place.shape, "path", place.path)
    for name in reader.parameters(place.shape):
        if name in CONSTRAINTS:
            yield from _core(reader, place, name)
        else:
            reader.unknown.add(f"sh:{name}")
    for constraint in reader.values(place.shape, "sparql"):
        if not _off(reader, constraint):
            yield _sparql(reader, place, constraint)
    for nested in reader.values(place.shape, "property"):
        path = reader.one(nested, "path")
        if place.path is not None or path is None:
            reader.unknown.add("sh:property")
        elif not _off(reader, nested):
            yield from _shape(reader, _Place(nested, place.targets, path))


def _core(reader: _Reader, place: _Place, name: str) -> Iterator[_Check]:
    component = f"{name[:1].upper()}{name[1:]}ConstraintComponent"
    flags = reader.one(place.shape, "flags")
    for parameter in reader.values(place.shape, name):
        items = tuple(reader.items(parameter)) if name == "in" else ()
        if not isinstance(parameter, NamedNode) and name in {"class", "datatype", "nodeKind"}:
            raise ShapeFault(f"the value of sh:{name} is no IRI", place.shape, name, parameter)
        if any(isinstance(term, BlankNode) for term in (items if name == "in" else (parameter,))):
            raise ShapeFault(f"a blank node cannot be the value of sh:{name}", place.shape, name, parameter)
        own = Constraint(place.shape, name, place.targets, place.text, parameter, items, flags.value if flags else "")
        for query in CONSTRAINTS[name](own):
            yield _check(reader, place, component, query)


def _check(reader: _Reader, place: _Place, component: str, query: str, said: Term | None = None) -> _Check:
    """``said`` is the node of a ``sh:sparql`` constraint, whose own message and code go before the shape's."""
    spoken = [one for one in (said, place.shape) if one is not None]

    def first(name: str) -> str:
        return next((value.value for one in spoken if (value := reader.one(one, name)) is not None), "")

    severity = reader.one(place.shape, "severity") or _VIOLATION
    return _Check(
        place.shape,
        place.path,
        component,
        query,
        first("message"),
        severity.value.removeprefix(SH),
        first(_CODE.value),
        first(_HINT.value),
    )


def _sparql(reader: _Reader, place: _Place, constraint: Term) -> _Check:
    select = reader.one(constraint, "select")
    if select is None:
        raise ShapeFault("a sh:sparql constraint has no sh:select", place.shape, "sparql", constraint)
    if "$shapesGraph" in select.value or "$currentShape" in select.value:
        reader.unknown.add("$shapesGraph")
    prefixes = []
    for header in reader.values(constraint, "prefixes"):
        for declaration in reader.values(header, "declare"):
            prefix, namespace = reader.one(declaration, "prefix"), reader.one(declaration, "namespace")
            if prefix is not None and namespace is not None:
                prefixes.append(f"PREFIX {prefix.value}: <{namespace.value}>")
    query = " ".join(prefixes) + "\n" + select.value.replace("$PATH", place.text)
    check = _check(reader, place, "SPARQLConstraintComponent", query, constraint)
    return replace(check, per_focus=f"SELECT ?this WHERE {{ {place.targets} }}")


def _run(store: Store, check: _Check) -> Iterator[ShapeResult]:
    if not check.per_focus:
        for row in _solve(store, check, prologue() + check.query):
            yield _result(check, row["this"], row.get("value"), check.message)
        return
    for focus_row in _solve(store, check, prologue() + check.per_focus):
        focus = focus_row["this"]
        for row in _solve(store, check, check.query, focus):
            value = row.get("value") or (None if check.path is not None else focus)
            message = row["message"].value if "message" in row else check.message
            for name, term in {**row, "this": focus}.items():
                for sigil in "?$":
                    message = message.replace(f"{{{sigil}{name}}}", _plain(term))
            path = row["path"] if isinstance(row.get("path"), NamedNode) else check.path
            yield _result(check, row.get("this", focus), value, message, path)


def _plain(term: Term) -> str:
    return term.value.rpartition("#")[2] if isinstance(term, NamedNode) else term.value


def _result(check: _Check, focus: Term, value: Term | None, message: str, path: Term | None = None) -> ShapeResult:
    return ShapeResult(
        focus, path or check.path, value, check.component, check.shape, message, check.severity, check.code, check.hint
    )


def _solve(store: Store, check: _Check, query: str, this: Term | None = None) -> Iterator[dict[str, Term]]:
    given: Any = {Variable("this"): this} if this is not None else None
    try:
        solutions = store.query(query, use_default_graph_as_union=True, substitutions=given)
    except (SyntaxError, ValueError) as error:
        # Behind the first alternatives Oxigraph lists whole classes of characters.
        text = " ".join(str(error).partition(", [")[0].split())
        raise ShapeFault(f"the {check.component} cannot run: {text}", check.shape) from error
    if not isinstance(solutions, QuerySolutions):
        raise ShapeFault("a sh:select is no SELECT query", check.shape)
    names = [variable.value for variable in solutions.variables]
    for solution in solutions:
        yield {name: cast("Term", solution[name]) for name in names if solution[name] is not None}
