"""A compiled shape, and what it finds of one focus node."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from pyoxigraph import NamedNode

from onto_compiler.shapes import ShapeResult
from onto_compiler.validator.components import Located, Test
from onto_compiler.validator.facts import NOTHING, Facts, Term, Values
from onto_compiler.validator.implications import Implication
from onto_compiler.validator.paths import Walk

__all__ = ["Check", "CompiledShape", "Rule", "Said"]


class Said(NamedTuple):
    """What a shape says of a violation."""

    message: str
    severity: str
    code: str
    hint: str


class Check(NamedTuple):
    """One constraint of SHACL Core; ``lacking`` where a focus node without values can violate it."""

    component: str
    test: Test
    lacking: bool


class Rule(NamedTuple):
    """One ``sh:sparql`` constraint in its Python form."""

    said: Said
    implication: Implication


@dataclass(frozen=True, slots=True)
class CompiledShape:
    """A node shape, or with ``walk`` a property shape; ``properties`` are asked of each value node."""

    iri: Term
    path: Term | None
    walk: Walk | None
    said: Said
    checks: tuple[Check, ...] = ()
    rules: tuple[Rule, ...] = ()
    properties: tuple[CompiledShape, ...] = ()
    direct: NamedNode | None = None  # the path, where it is one property

    @property
    def speaks(self) -> bool:
        """Whether it constrains anything."""
        return bool(self.checks or self.rules or self.properties)

    def holds(self, shape: Term) -> bool:
        """Whether ``shape`` is this one or one of its property shapes, however deep."""
        return shape == self.iri or any(nested.holds(shape) for nested in self.properties)

    def conforms(self, facts: Facts, focus: Term) -> bool:
        """Whether ``focus`` violates nothing of this shape."""
        found: list[ShapeResult] = []
        self.find(facts, focus, found)
        return not found

    def find(self, facts: Facts, focus: Term, found: list[ShapeResult]) -> None:
        """Append what ``focus`` violates to ``found``."""
        self.find_among(facts, focus, (focus,) if self.walk is None else self.walk(facts, focus), found)

    def find_among(self, facts: Facts, focus: Term, values: Values, found: list[ShapeResult]) -> None:
        """:meth:`find` with the value nodes at hand."""
        for component, test, lacking in self.checks:
            if (values or lacking) and (bad := test(facts, focus, values)):
                found += [self._result(component, focus, value) for value in bad]
        for rule in self.rules:
            found += self._solutions(rule, facts, focus)
        for nested in self.properties:
            if nested.direct is None:
                for value in values:
                    nested.find(facts, value, found)
            else:
                # Most paths are one property, whose values are found without a call.
                for value in values:
                    nested.find_among(facts, value, facts.about(value).get(nested.direct) or NOTHING, found)

    def _result(self, component: str, focus: Term, value: Term | Located | None) -> ShapeResult:
        message, severity, code, hint = self.said
        path = self.path
        if isinstance(value, Located):
            path, value = value.path, value.value
        return ShapeResult(focus, path, value, component, self.iri, message, severity, code, hint)

    def _solutions(self, rule: Rule, facts: Facts, focus: Term) -> Iterator[ShapeResult]:
        said, component = rule.said, "SPARQLConstraintComponent"
        for row in rule.implication(facts, focus):
            message = said.message
            for name, term in {**row, "this": focus}.items():
                text = term.value.rpartition("#")[2] if isinstance(term, NamedNode) else term.value
                for sigil in "?$":
                    message = message.replace(f"{{{sigil}{name}}}", text)
            path = row.get("path", self.path)
            yield ShapeResult(
                focus, path, row["value"], component, self.iri, message, said.severity, said.code, said.hint
            )
