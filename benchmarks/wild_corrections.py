"""Known reasons why pySHACL and this validator differ, each with the one point in which to correct pySHACL.

A difference is explained where pySHACL, corrected in that point alone, gives the report that we give. Nothing is thus
explained by what a case looks like, and what a fault does to the shapes that refer to the faulty one is explained too.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from typing import Any, cast
from unittest.mock import patch

from pyoxigraph import Literal, NamedNode, QuerySolutions, Store

__all__ = ["CORRECTIONS", "Correction", "corrected"]

Patches = Callable[[], Iterator[Any]]
_IN = re.compile(r"(\?\w+) IN \(([^()]*)\)")
_CORE = "pyshacl.constraints.core"


@dataclass(frozen=True, slots=True)
class Correction:
    """``says`` who is right, and where that is written; ``patches`` correct pySHACL, or make it err as we do."""

    says: str
    patches: Patches
    ours_errs: bool = False


@contextmanager
def corrected(*names: str) -> Iterator[None]:
    """Run pySHACL with these of the :data:`CORRECTIONS`."""
    with ExitStack() as stack:
        for name in names:
            for one in CORRECTIONS[name].patches():
                stack.enter_context(one)
        yield


@cache
def _holds(sign: str, left: Literal, right: Literal) -> bool | None:
    """What SPARQL's operator says of two literals, as Oxigraph has it; None where it cannot compare them."""
    (row,) = cast("QuerySolutions", Store().query(f"SELECT ({left} {sign} {right} AS ?holds) WHERE {{ }}"))
    return None if row["holds"] is None else row["holds"].value == "true"


def _literal(term: Any) -> Literal:  # noqa: ANN401 - rdflib's terms have no types here
    if term.language:
        return Literal(str(term), language=term.language)
    return Literal(str(term), datatype=NamedNode(str(term.datatype)) if term.datatype else None)


def _compared(sign: str, left: Any, right: Any) -> bool:  # noqa: ANN401
    malformed = left.ill_typed or right.ill_typed
    verdict = None if malformed else _holds(sign, _literal(left), _literal(right))
    if verdict is None:
        raise TypeError(f"{left!r} and {right!r} cannot be compared")
    return verdict


def _compare_literal(left: Any, right: Any) -> int:  # noqa: ANN401
    if _compared("<", left, right):
        return -1
    return 1 if _compared(">", left, right) else 0 if _compared("=", left, right) else 2


def _order() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415 - what pySHACL needs is imported where it runs

    def value_of(sign: str) -> Callable[[Any, Any], bool]:
        return lambda left, right: _compared(sign, left, right)

    yield patch(f"{_CORE}.value_range_constraints.compare_literal", _compare_within)
    signs = {"__lt__": "<", "__gt__": ">", "__le__": "<=", "__ge__": ">="}
    for name, sign in signs.items():
        yield patch.object(rdflib.Literal, name, value_of(sign))


def _compare_within(left: Any, right: Any) -> int:  # noqa: ANN401
    """As pySHACL's, where NaN is neither less, nor greater, nor equal: then a bound is not kept."""
    found = _compare_literal(left, right)
    if found == 2:
        raise TypeError("not a number")
    return found


def _pairs() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415

    def comparing(sign: str) -> Callable[..., tuple[bool, list[Any]]]:
        def compare(self: Any, values: Any, bounds: Any, graph: Any, focus: Any) -> tuple[bool, list[Any]]:  # noqa: ANN401
            def kept(value: Any, bound: Any) -> bool:  # noqa: ANN401
                literals = isinstance(value, rdflib.Literal) and isinstance(bound, rdflib.Literal)
                with suppress(TypeError):
                    return literals and _compared(sign, value, bound)
                return False

            wrong = [value for value in values for bound in bounds if not kept(value, bound)]
            return bool(wrong), [self.make_v_result(graph, focus, value_node=value) for value in wrong]

        return compare

    module = f"{_CORE}.property_pair_constraints"
    yield patch(f"{module}.LessThanConstraintComponent._compare_lt", comparing("<"))
    yield patch(f"{module}.LessThanOrEqualsConstraintComponent._compare_ltoe", comparing("<="))


def _no_length() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415
    from pyshacl.constraints.core.string_based_constraints import MinLengthConstraintComponent as Length  # noqa: PLC0415

    before = Length._evaluate_string_rule  # noqa: SLF001 - a point to correct

    def evaluate(self: Any, rule: Any, graph: Any, values: Any) -> Any:  # noqa: ANN401
        wrong, reports = before(self, rule, graph, values)
        if rule.value == 0:
            pairs = [(f, v) for f, found in values.items() for v in found if isinstance(v, rdflib.BNode)]
            reports = [*reports, *(self.make_v_result(graph, focus, value_node=value) for focus, value in pairs)]
        return wrong or bool(reports), reports

    yield patch.object(Length, "_evaluate_string_rule", evaluate)


def _asked_values() -> Iterator[Any]:
    from pyshacl.constraints.sparql.sparql_based_constraint_components import (  # noqa: PLC0415
        AskConstraintValidator,
        BoundShapeValidatorComponent,
    )

    before = BoundShapeValidatorComponent.make_v_result

    def make(self: Any, graph: Any, focus: Any, **given: Any) -> Any:  # noqa: ANN401
        return before(self, graph, focus, **given)

    def evaluate(self: Any, executor: Any, graph: Any, values: Any, path: Any) -> Any:  # noqa: ANN401
        if not isinstance(self.validator, AskConstraintValidator):
            return run(self, executor, graph, values, path)
        found = [
            (focus, value)
            for focus, of_focus in values.items()
            for value, _ in self.validator.validate(executor, focus, of_focus, graph, self.query_helper)
        ]
        named = {"constraint_component": self.constraint.node}
        return not found, [make(self, graph, focus, value_node=value, **named) for focus, value in found]

    run = BoundShapeValidatorComponent.evaluate
    yield patch.object(BoundShapeValidatorComponent, "evaluate", evaluate)


def _brackets() -> Iterator[Any]:
    from pyshacl.helper import path_helper  # noqa: PLC0415

    before = path_helper.shacl_path_to_sparql_path

    def write(graph: Any, node: Any, prefixes: Any = None, recursion: int = 0) -> str:  # noqa: ANN401
        text = before(graph, node, prefixes=prefixes, recursion=recursion)
        return f"({text})"

    for module in ("pyshacl.helper.path_helper", "pyshacl.helper.sparql_query_helper"):
        yield patch(f"{module}.shacl_path_to_sparql_path", write)


def _inverse_sequences() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415
    from pyshacl.helper import expression_helper  # noqa: PLC0415

    before = expression_helper.value_nodes_from_path

    def follow(shapes: Any, focus: Any, path: Any, graph: Any, inverse: bool = False, recursion: int = 0) -> Any:  # noqa: ANN401, FBT001, FBT002
        parts = list(shapes.graph.items(path)) if isinstance(path, rdflib.BNode) else []
        if not inverse or not parts:
            return before(shapes, focus, path, graph, inverse=inverse, recursion=recursion)
        found = {focus}
        for part in reversed(parts):
            steps = [follow(shapes, node, part, graph, inverse=True, recursion=recursion + 1) for node in found]
            found = {node for step in steps for node in step}
        return found

    for module in ("pyshacl.helper.expression_helper", "pyshacl.shape"):
        yield patch(f"{module}.value_nodes_from_path", follow)


def _recursion() -> Iterator[Any]:
    from pyshacl.constraints.constraint_component import ConstraintComponent  # noqa: PLC0415
    from pyshacl.shape import Shape  # noqa: PLC0415

    before, opened = Shape.validate, list[tuple[int, Any]]()

    def validate(self: Any, executor: Any, graph: Any, focus: Any = None, _evaluation_path: Any = None) -> Any:  # noqa: ANN401
        if focus is None or isinstance(focus, (list, tuple, set)):
            return before(self, executor, graph, focus, _evaluation_path)
        key = (id(self), focus)
        if key in opened:
            return True, []
        opened.append(key)
        try:
            return before(self, executor, graph, focus, _evaluation_path)
        finally:
            opened.pop()

    yield patch.object(ConstraintComponent, "recursion_triggers", lambda *_: None)
    yield patch.object(Shape, "validate", validate)


def _literal_subjects() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415

    before = rdflib.Graph.add

    def add(self: Any, triple: Any) -> Any:  # noqa: ANN401
        return self if isinstance(triple[0], rdflib.Literal) else before(self, triple)

    yield patch.object(rdflib.Graph, "add", add)


def _deactivated_rules() -> Iterator[Any]:
    from pyshacl.rules.sparql import SPARQLRule  # noqa: PLC0415
    from pyshacl.rules.triple import TripleRule  # noqa: PLC0415

    def unless_deactivated(before: Callable[..., int]) -> Callable[..., int]:
        def apply(self: Any, *given: Any, **named: Any) -> int:  # noqa: ANN401
            return 0 if self.shape.deactivated else before(self, *given, **named)

        return apply

    for kind in (SPARQLRule, TripleRule):
        yield patch.object(kind, "apply", unless_deactivated(kind.apply))


def _no_answer() -> Iterator[Any]:
    from pyshacl.functions.shacl_function import SPARQLFunction  # noqa: PLC0415
    from pyshacl.helper import expression_helper  # noqa: PLC0415

    select, nodes = SPARQLFunction.execute_select, expression_helper.nodes_from_node_expression

    def execute(self: Any, *given: Any) -> Any:  # noqa: ANN401
        try:
            return select(self, *given)
        except KeyError:
            return None

    def evaluate(*given: Any, **named: Any) -> Any:  # noqa: ANN401
        return [one for one in nodes(*given, **named) if one is not None]

    yield patch.object(SPARQLFunction, "execute_select", execute)
    for module in (expression_helper, sys.modules["pyshacl.constraints.advanced"]):
        yield patch.object(module, "nodes_from_node_expression", evaluate)


def _absent_literals() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415
    from rdflib.paths import MulPath  # noqa: PLC0415

    before = MulPath.eval

    def evaluate(self: Any, graph: Any, subject: Any = None, value: Any = None, first: bool = True) -> Any:  # noqa: ANN401, FBT001, FBT002
        absent = isinstance(subject, rdflib.Literal) and (None, None, subject) not in graph
        return iter(()) if absent else before(self, graph, subject, value, first)

    yield patch.object(MulPath, "eval", evaluate)


def _membership() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415

    before = rdflib.Graph.query

    def query(self: Any, text: Any, *given: Any, **named: Any) -> Any:  # noqa: ANN401
        return before(self, _IN.sub(_one_by_one, text) if isinstance(text, str) else text, *given, **named)

    yield patch.object(rdflib.Graph, "query", query)


def _one_by_one(match: re.Match[str]) -> str:
    """``?a IN (1, 2)`` as ``(?a = 1 || ?a = 2)``, which means the same."""
    return "(" + " || ".join(f"{match[1]} = {one.strip()}" for one in match[2].split(",")) + ")"


def _false_values() -> Iterator[Any]:
    import rdflib  # noqa: PLC0415

    yield patch.object(rdflib.Literal, "__bool__", lambda _: True)


CORRECTIONS: Mapping[str, Correction] = {
    "order of literals": Correction(
        "We are right: literals that SPARQL's `<` cannot compare violate a bound (SHACL, 4.3; SPARQL 1.1, 17.3); "
        "rdflib orders those of different datatypes and languages, and malformed ones.",
        _order,
    ),
    "order of nodes": Correction(
        "We are right: nodes that cannot be compared violate sh:lessThan (SHACL, 4.5.3 and 4.5.4); pySHACL compares "
        "IRIs and texts in languages as strings, and refuses blank nodes.",
        _pairs,
    ),
    "length of a blank node": Correction(
        "We are right: a blank node violates every sh:minLength, 0 included (SHACL, 4.4.1).", _no_length
    ),
    "value of an ASK": Correction(
        "We are right: the result of an ASK validator has the value node for its sh:value (SHACL, 6.3); pySHACL leaves "
        "it out on property shapes.",
        _asked_values,
    ),
    "brackets in paths": Correction(
        "We are right: `$PATH` stands for the path (SHACL, 5.2.1); pySHACL writes a path within another without "
        "brackets, which is no SPARQL, or another path.",
        _brackets,
    ),
    "inverse of a sequence": Correction(
        "We are right: the inverse of a sequence is the sequence of the inverses from its end (SHACL, 2.3.1.2 and "
        "2.3.1.4; SPARQL 1.1, 18.4); pySHACL follows them from its beginning.",
        _inverse_sequences,
    ),
    "IN": Correction(
        "We are right: `IN` compares as `=` does, by value (SPARQL 1.1, 17.4.1.9); rdflib compares terms.", _membership
    ),
    "false values": Correction(
        "We are right: `$value` and `$this` stand for the node (SHACL, 5.2.1 and 5.3.2); pySHACL and rdflib take 0, "
        "false and the empty text for no value at all.",
        _false_values,
    ),
    "recursion": Correction(
        "Neither: what recursive shapes mean is left to the engine (SHACL, 3.4.3); we take a shape to hold where it is "
        "asked for the same node again, pySHACL where it comes back after some steps, whatever the node is.",
        _recursion,
    ),
    "literals as subjects": Correction(
        "We are right: no triple has a literal for its subject (RDF 1.1, 3.1), and a rule whose focus node is one "
        "infers none.",
        _literal_subjects,
    ),
    "rules of deactivated shapes": Correction(
        "Neither: nothing violates a deactivated shape (SHACL, 2.1.6), and a rule may be deactivated by itself "
        "(SHACL-AF, 8); we take the rules of a deactivated shape to be off with it, and pySHACL runs them.",
        _deactivated_rules,
    ),
    "function without an answer": Correction(
        "We are right: a function whose query has no answer gives no node (SHACL-AF, 5.2 and 6.5); pySHACL ends in a "
        "KeyError.",
        _no_answer,
    ),
    "literals outside the data": Correction(
        "pySHACL is right: a path of no length leads from a literal to itself (SPARQL 1.1, 18.4); Oxigraph, which runs "
        "our queries, does not have it where no statement holds the literal.",
        _absent_literals,
        ours_errs=True,
    ),
}
"""The differences by name."""
