"""SHACL-AF rules (section 8): triple rules and SPARQL rules with conditions, in ascending ``sh:order``.

What one order concludes, the next can read; rules of the same order do not read what the others conclude.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product

from pyoxigraph import Literal, NamedNode, Triple

from onto_compiler.rdf import RDF, SH
from onto_compiler.shacl.compile import Compiler
from onto_compiler.shacl.declarations import NO_RULE, rule_faults, rule_kind
from onto_compiler.shacl.expressions import Expression, read_expression
from onto_compiler.shacl.functions import declared_functions
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import Run, ShapeFault, Shapes, Target, note, noting
from onto_compiler.shacl.prebinding import ask, read_query
from onto_compiler.shacl.reader import Reader
from onto_compiler.shacl.validate import Validation, focus_nodes

__all__ = ["GraphRule", "RuleBase", "infer", "read_rule_base"]

_TYPE, _RULE = NamedNode(RDF + "type"), NamedNode(SH + "rule")
Conclude = Callable[[Run, Term], Iterable[Triple]]


@dataclass(frozen=True, slots=True)
class GraphRule:
    """One rule of one shape: for each of the targets that conforms to all ``conditions``, what it concludes."""

    iri: Term
    order: tuple[float, float]  # the shape's, then the rule's
    targets: tuple[Target, ...]
    conditions: tuple[Term, ...]
    conclude: Conclude
    text: str = ""  # of a SPARQL rule, its CONSTRUCT with the declared prefixes in front


@dataclass(frozen=True, slots=True)
class RuleBase:
    """The rules of a shapes graph in the order in which they run."""

    rules: tuple[GraphRule, ...]
    shapes: Shapes

    def apply(self, data: Graph, faults: list[ShapeFault] | None = None) -> list[Triple]:
        """Run every rule once over ``data``, add what they conclude to it and return what was new.

        A rule that cannot run is left out and its fault appended to ``faults``.

        Raises:
            ShapeFault: a rule, a condition or a function cannot run, and no list is given.

        """
        concluded: list[Triple] = []
        for order in sorted({rule.order for rule in self.rules}):
            same = replace(self, rules=tuple(rule for rule in self.rules if rule.order == order))
            concluded += [triple for triple in same.conclude(data, faults=faults) if data.add(triple)]
        return concluded

    def conclude(
        self, data: Graph, allowed: Container[Term] | None = None, faults: list[ShapeFault] | None = None
    ) -> list[Triple]:
        """What the rules conclude of ``data`` as it is; ``allowed`` restricts the nodes that they fire for.

        Raises:
            ShapeFault: as above.

        """
        run = Validation(data, self.shapes)
        found: list[Triple] = []
        for rule in self.rules:
            with noting(faults):
                found += _conclusions(run, rule, allowed)
        return found


def _conclusions(run: Validation, rule: GraphRule, allowed: Container[Term] | None) -> list[Triple]:
    return [
        triple
        for focus in list(focus_nodes(run.data, rule.targets))
        if allowed is None or focus in allowed
        if all(run.conforms(focus, condition) for condition in rule.conditions)
        for triple in rule.conclude(run, focus)
    ]


def read_rule_base(graph: Graph, faults: list[ShapeFault] | None = None) -> RuleBase:
    """The rules of a shapes graph; deactivated ones, and those of deactivated shapes, are left out.

    So are rules that are of a kind that is not known, or lack a part; their faults are appended to ``faults``.

    Raises:
        ShapeFault: the first of them, or of the queries that must not be run, where no list is given.

    """
    compiler = Compiler(graph)
    for refused in () if faults is not None else compiler.reader.refused():
        raise refused
    rules: list[GraphRule] = []
    for shape in sorted(graph.holders(_RULE), key=str):
        if compiler.reader.is_true(shape, "deactivated"):
            continue
        for node in compiler.reader.values(shape, "rule"):
            with noting(faults):
                rules += _active(compiler, shape, node)
    rules.sort(key=lambda rule: (rule.order, str(rule.iri)))
    return RuleBase(tuple(rules), Shapes((), compiler.known, graph, declared_functions(compiler.reader, faults)))


def infer(data: Graph, shapes: Graph, faults: list[ShapeFault]) -> None:
    """Add to ``data`` what the rules of ``shapes`` conclude, and to ``faults`` why others cannot run."""
    if not shapes.holders(_RULE):
        return
    wrong = list(rule_faults(shapes))
    for fault, _ in wrong:
        note(fault, faults)
    if wrong:
        left_out = {triple for _, triple in wrong}
        shapes = Graph(one for one in shapes if (one.subject, one.predicate, one.object) not in left_out)
    read_rule_base(shapes, faults).apply(data, faults)


def _active(compiler: Compiler, shape: Term, node: Term) -> list[GraphRule]:
    """The rule that ``node`` is, unless it is deactivated."""
    if compiler.reader.is_true(node, "deactivated"):
        return []
    try:
        return [_rule(compiler, shape, node, tuple(compiler.targets(shape)))]
    except RecursionError:
        raise ShapeFault("a rule of the shape is nested without end", shape) from None


def _rule(compiler: Compiler, shape: Term, node: Term, targets: tuple[Target, ...]) -> GraphRule:
    reader = Reader(compiler.reader.graph)
    conditions = tuple(reader.shape(condition) for condition in reader.values(node, "condition"))
    kind, text = rule_kind(reader, node), ""
    if kind == "SPARQLRule":
        text = _construct(reader, shape, node)
        conclude = _constructing(text, shape, node)
    elif kind == "TripleRule":
        conclude = _stating(reader, shape, node)
    else:
        raise ShapeFault(NO_RULE, shape, "rule", node)
    for needed in reader.wanted:
        compiler.shape(needed)
    return GraphRule(node, (_order(reader, shape), _order(reader, node)), targets, conditions, conclude, text)


def _order(reader: Reader, node: Term) -> float:
    value = reader.one(node, "order")
    try:
        return float(value.value) if isinstance(value, Literal) else 0.0
    except ValueError:
        raise ShapeFault("the value of sh:order is no number", node, "order", value) from None


def _stating(reader: Reader, shape: Term, node: Term) -> Conclude:
    parts: list[Expression] = []
    for name in ("subject", "predicate", "object"):
        part = reader.one(node, name)
        if part is None:
            raise ShapeFault(f"a sh:TripleRule has no sh:{name}", shape, "rule", node)
        parts.append(read_expression(reader, part, shape))

    def conclude(run: Run, focus: Term) -> Iterator[Triple]:
        for subject, predicate, value in product(*(list(part(run, focus)) for part in parts)):
            if isinstance(predicate, NamedNode) and not isinstance(subject, Literal):
                yield Triple(subject, predicate, value)

    return conclude


def _construct(reader: Reader, shape: Term, node: Term) -> str:
    text = reader.query(node, "construct", what="the rule")
    if text is None:
        raise ShapeFault("a sh:SPARQLRule has no sh:construct", shape, "rule", node)
    return text


def _constructing(text: str, shape: Term, node: Term) -> Conclude:
    query = read_query(text, ("this",))

    def conclude(run: Run, focus: Term) -> Iterator[Triple]:
        try:
            answer = ask(run.data.store, query, {"this": focus}, run.shapes.functions)
        except SyntaxError as error:
            raise ShapeFault(f"the rule cannot run: {' '.join(str(error).split())}", shape, "rule", node) from error
        if answer.kind != "construct":
            raise ShapeFault("the sh:construct of a rule is no CONSTRUCT query", shape, "rule", node)
        yield from (Triple(*row) for row in answer.rows)

    return conclude
