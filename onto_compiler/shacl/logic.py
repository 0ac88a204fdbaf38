"""The Core components that refer to other shapes (SHACL, sections 4.6 and 4.7)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from pyoxigraph import NamedNode

from onto_compiler.rdf import SH
from onto_compiler.shacl.components import Builder
from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Check, Nested, PerValue, Run, Whole
from onto_compiler.shacl.reader import Parameter
from onto_compiler.terms import ShapeOf
from onto_compiler.wording import plural

__all__ = ["SHAPE_COMPONENTS"]

_PROPERTY, _QUALIFIED = NamedNode(SH + "property"), NamedNode(SH + "qualifiedValueShape")


def _node(own: Parameter) -> Iterator[Check]:
    shape = own.referred()

    def test(run: Run, value: Term) -> bool:
        return run.conforms(value, shape)

    yield PerValue("NodeConstraintComponent", test, ("must conform to ", ShapeOf(shape)))


def _not(own: Parameter) -> Iterator[Check]:
    shape = own.referred()

    def test(run: Run, value: Term) -> bool:
        return not run.conforms(value, shape)

    yield PerValue("NotConstraintComponent", test, ("must not conform to ", ShapeOf(shape)))


def _property(own: Parameter) -> Iterator[Check]:
    shape = own.referred()
    if not own.reader.values(shape, "path"):
        raise own.fault("the value of sh:property has no sh:path")
    yield Nested(shape)


def _several(component: str, accepts: Callable[[Run, Term, Sequence[Term]], bool], words: str) -> Builder:
    """A component whose value is a list of shapes."""

    def build(own: Parameter) -> Iterator[Check]:
        shapes = [own.reader.shape(item) for item in own.items()]

        def test(run: Run, value: Term) -> bool:
            return accepts(run, value, shapes)

        yield PerValue(component, test, f"must conform to {words} of {len(shapes)} shapes")

    return build


def _all(run: Run, value: Term, shapes: Sequence[Term]) -> bool:
    return all(run.conforms(value, shape) for shape in shapes)


def _any(run: Run, value: Term, shapes: Sequence[Term]) -> bool:
    return any(run.conforms(value, shape) for shape in shapes)


def _exactly_one(run: Run, value: Term, shapes: Sequence[Term]) -> bool:
    return sum(run.conforms(value, shape) for shape in shapes) == 1


def _qualified(own: Parameter) -> Iterator[Check]:
    shape = own.referred()
    siblings = _siblings(own) if own.reader.is_true(own.shape, "qualifiedValueShapesDisjoint") else []

    def counted(run: Run, values: Sequence[Term]) -> int:
        return sum(
            run.conforms(value, shape) and not any(run.conforms(value, other) for other in siblings) for value in values
        )

    for name, least in (("qualifiedMinCount", True), ("qualifiedMaxCount", False)):
        for bound in own.others(name):
            limit = Parameter(own.reader, own.shape, name, bound).number()

            def find(
                run: Run,
                _: Term,
                values: Sequence[Term],
                limit: int = limit,
                least: bool = least,  # noqa: FBT001 - bound early
            ) -> Iterable[Term | None]:
                found = counted(run, values)
                return (None,) if (found < limit if least else found > limit) else ()

            words = f"must have at {'least' if least else 'most'} {limit} {plural(limit, 'value')} that conform to "
            yield Whole(f"Q{name[1:]}ConstraintComponent", find, (words, ShapeOf(shape)))


def _siblings(own: Parameter) -> list[Term]:
    """The qualified shapes of the property shapes beside this one (section 4.7.3)."""
    graph = own.reader.graph
    beside = {
        sibling for parent in graph.subjects(_PROPERTY, own.shape) for sibling in graph.objects(parent, _PROPERTY)
    }
    shapes = {shape for sibling in beside for shape in graph.objects(sibling, _QUALIFIED)} - {own.value}
    return [own.reader.shape(shape) for shape in sorted(shapes, key=str)]


SHAPE_COMPONENTS: Mapping[str, Builder] = {
    "and": _several("AndConstraintComponent", _all, "all"),
    "node": _node,
    "not": _not,
    "or": _several("OrConstraintComponent", _any, "one or more"),
    "property": _property,
    "qualifiedValueShape": _qualified,
    "xone": _several("XoneConstraintComponent", _exactly_one, "exactly one"),
}
