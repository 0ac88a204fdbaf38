"""Shapes in, a :class:`~onto_compiler.validator.validator.Validator` out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from pyoxigraph import Literal, NamedNode, Quad, Triple

from onto_compiler.rdf import BASE, OWL, RDF, RDFS, SH, node
from onto_compiler.validator.components import COMPONENTS, LACKING, Parameter, shape_fault
from onto_compiler.validator.facts import Facts, Term, Vocabulary, index
from onto_compiler.validator.implications import IMPLICATIONS, query_key
from onto_compiler.validator.paths import walk
from onto_compiler.validator.shape import Check, CompiledShape, Rule, Said
from onto_compiler.validator.validator import Target, Validator

__all__ = ["compile_validator"]

_META = {
    "alternativePath", "declare", "deactivated", "defaultValue", "description", "flags", "group", "ignoredProperties",
    "message", "name", "order", "path", "prefixes", "property", "qualifiedValueShape",
    "qualifiedValueShapesDisjoint", "rule", "severity", "sparql", "targetClass", "targetNode", "targetObjectsOf",
    "targetSubjectsOf",
}  # fmt: skip
_TYPE, _SHAPE = node(RDF + "type"), node(SH + "NodeShape")
_CLASSES = (node(RDFS + "Class"), node(OWL + "Class"))
_TARGETS = tuple(node(SH + f"target{name}") for name in ("Class", "Node", "ObjectsOf", "SubjectsOf"))
_TRUE = {"true", "1"}


def compile_validator(vocabulary: Iterable[Quad | Triple], shapes: Iterable[Quad | Triple] | None = None) -> Validator:
    """Compile the shapes that ``vocabulary`` holds, or those of ``shapes``.

    ``vocabulary`` is what records rest on: classes, individuals, predicates, routes. A shape with a constraint that has
    no Python form (a ``sh:sparql`` or a component of somebody's own) is left to :mod:`onto_compiler.shapes`, and only
    records that it speaks of pay for that.

    Raises:
        OntoError: SHP002, where a shape cannot run.

    """
    statements = tuple(vocabulary)
    known = Vocabulary(index(statements))
    own = statements if shapes is None else tuple(shapes)
    source = Facts(Vocabulary({}), own)
    reader = _Reader(source)
    targets, foreign = [], []
    for root in sorted(_roots(source), key=str):
        target = _target(source, root)
        if target is None or _off(source, root):
            continue
        reader.foreign = False
        compiled = reader.shape(root)
        if reader.foreign:
            foreign.append((target, root))
        elif compiled.speaks:
            targets.append((target, compiled))
    return Validator(known, tuple(targets), tuple(foreign), (*statements, *(() if shapes is None else own)))


def _roots(shapes: Facts) -> set[Term]:
    return {
        subject
        for subject, properties in shapes.nodes.items()
        if any(name in properties for name in _TARGETS) or _SHAPE in properties.get(_TYPE, {})
    }


def _target(shapes: Facts, root: Term) -> Target | None:
    classes, nodes, objects, subjects = (tuple(shapes.values(root, name)) for name in _TARGETS)
    # A shape that is itself a class targets its instances (SHACL, section 2.1.3.3).
    if any(cls in shapes.values(root, _TYPE) for cls in _CLASSES):
        classes += (root,)
    for name, found in (("Class", classes), ("ObjectsOf", objects), ("SubjectsOf", subjects)):
        for value in found:
            if not isinstance(value, NamedNode):
                raise shape_fault(root, f"the value of sh:target{name} is no IRI")
    target = Target(classes, frozenset(nodes), _iris(subjects), _iris(objects))
    return target if classes or nodes or objects or subjects else None


def _iris(terms: Iterable[Term]) -> frozenset[NamedNode]:
    return frozenset(term for term in terms if isinstance(term, NamedNode))


def _off(shapes: Facts, shape: Term) -> bool:
    return any(value.value in _TRUE for value in shapes.values(shape, node(SH + "deactivated")))


@dataclass(slots=True)
class _Reader:
    """Compiles shapes, each once; ``foreign`` says whether one since it was last cleared has no Python form."""

    shapes: Facts
    foreign: bool = False
    done: dict[Term, tuple[CompiledShape, bool]] = field(default_factory=dict)
    open: set[Term] = field(default_factory=set)

    def shape(self, shape: Term) -> CompiledShape:
        if shape in self.done:
            compiled, foreign = self.done[shape]
            self.foreign |= foreign
            return compiled
        if shape in self.open:
            raise shape_fault(shape, "it refers to itself")
        self.open.add(shape)
        outer, self.foreign = self.foreign, False
        compiled = self._compile(shape)
        self.done[shape] = compiled, self.foreign
        self.foreign |= outer
        self.open.discard(shape)
        return compiled

    def _compile(self, shape: Term) -> CompiledShape:
        path = self._one(shape, SH + "path")
        steps = None if path is None else walk(self.shapes, path)
        if path is not None and steps is None:
            raise shape_fault(shape, "the value of sh:path is no property path")
        said = self._said(shape)
        if _off(self.shapes, shape):
            return CompiledShape(shape, path, steps, said)
        properties = self.shapes.values(shape, node(SH + "property"))
        return CompiledShape(
            shape,
            path,
            steps,
            said,
            checks=tuple(self._checks(shape)),
            rules=tuple(self._rules(shape)),
            properties=tuple(self.shape(each) for each in properties),
            direct=path if isinstance(path, NamedNode) else None,
        )

    def _checks(self, shape: Term) -> Iterator[Check]:
        for predicate, values in sorted(self.shapes.about(shape).items(), key=str):
            name = predicate.value.removeprefix(SH)
            if name == predicate.value or name in _META:
                continue
            build = COMPONENTS.get(name)
            if build is None:
                self.foreign = True
                continue
            component = f"{name[:1].upper()}{name[1:]}ConstraintComponent"
            for value in values:
                test = build(Parameter(self.shapes, shape, name, value, self.shape))
                yield Check(component, test, name in LACKING)

    def _rules(self, shape: Term) -> Iterator[Rule]:
        for constraint in self.shapes.values(shape, node(SH + "sparql")):
            if _off(self.shapes, constraint):
                continue
            select = self._one(constraint, SH + "select")
            implication = IMPLICATIONS.get(query_key(select.value)) if isinstance(select, Literal) else None
            if implication is None:
                self.foreign = True
            else:
                yield Rule(self._said(constraint, shape), implication)

    def _said(self, *spoken: Term) -> Said:
        """Messages, code and hint; those of a ``sh:sparql`` constraint go before its shape's."""

        def first(name: str) -> str:
            return next((found.value for each in spoken if (found := self._one(each, name)) is not None), "")

        severity = self._one(spoken[-1], SH + "severity")
        return Said(
            first(SH + "message"),
            severity.value.removeprefix(SH) if severity is not None else "Violation",
            first(BASE + "shapes#code"),
            first(BASE + "shapes#hint"),
        )

    def _one(self, subject: Term, predicate: str) -> Term | None:
        return next(iter(self.shapes.values(subject, node(predicate))), None)
