"""Node expressions (SHACL-AF, section 6): a node of the shapes graph that stands for nodes of the data graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import product

from pyoxigraph import BlankNode, Literal, NamedNode

from onto_compiler.rdf import SH, boolean, integer
from onto_compiler.shacl.graph import Term
from onto_compiler.shacl.model import Check, Custom, Hit, Run, ShapeFault
from onto_compiler.shacl.paths import follow, read_path
from onto_compiler.shacl.reader import Reader
from onto_compiler.shacl.syntax import is_shape
from onto_compiler.shacl.values import less

__all__ = ["Expression", "expression_check", "read_expression"]

Expression = Callable[[Run, Term], Iterable[Term]]
_THIS = NamedNode(SH + "this")
_LISTS = ("union", "intersection")
_FOLDS = ("count", "min", "max", "distinct", "exists")


def expression_check(reader: Reader, shape: Term, node: Term) -> Check | None:
    """The check of one ``sh:expression``: each value node that it does not map to true is a violation.

    None if it is deactivated.

    Raises:
        ShapeFault: where it is no node expression.

    """
    if reader.is_true(node, "deactivated"):
        return None
    try:
        expression = read_expression(reader, node, shape)
    except RecursionError:
        raise ShapeFault("a node expression is nested without end", shape, "expression", node) from None
    except ShapeFault as fault:
        if fault.parameter:
            raise
        raise ShapeFault(fault.problems[0].message, shape, "expression", node) from None
    message, code, hint = reader.texts(node) if isinstance(node, BlankNode) else ("", "", "")
    words = "must make an expression true"
    return Custom("ExpressionConstraintComponent", _untrue(expression), words, message, code, hint)


def _untrue(expression: Expression) -> Callable[[Run, Term, Sequence[Term]], Iterable[Hit]]:
    true = boolean(True)

    def find(run: Run, _: Term, values: Sequence[Term]) -> Iterator[Hit]:
        yield from (Hit(value) for value in values if list(expression(run, value)) != [true])

    return find


def read_expression(reader: Reader, node: Term, shape: Term) -> Expression:
    """The expression that ``node`` stands for; ``shape`` is named where it is none.

    Raises:
        ShapeFault: where it is none that is known.

    """
    if node == _THIS:
        return lambda _, focus: (focus,)
    if not isinstance(node, BlankNode):
        return lambda _, __: (node,)
    for name in ("path", "filterShape", *_LISTS, "if", *_FOLDS):
        for value in reader.values(node, name):
            return _read(reader, node, name, value, shape)
    return _call(reader, node, shape)


def _read(reader: Reader, node: Term, name: str, value: Term, shape: Term) -> Expression:
    if name == "path":
        return _path(reader, value, _input(reader, node, shape), shape)
    if name == "filterShape":
        if not is_shape(reader.graph, value):
            raise ShapeFault("sh:filterShape must be a shape that the shapes graph describes", shape)
        wanted, nodes = reader.shape(value), _input(reader, node, shape)
        return lambda run, focus: [one for one in nodes(run, focus) if run.conforms(one, wanted)]
    if name in _LISTS:
        members = reader.graph.items(value)
        if members is None:
            raise ShapeFault(f"the list of sh:{name} does not end", shape)
        return _combine(name, [read_expression(reader, member, shape) for member in members])
    if name == "if":
        parts = {
            one: read_expression(reader, found[0], shape)
            for one in ("if", "then", "else")
            if (found := reader.values(node, one))
        }
        return _choice(parts)
    return _fold(name, read_expression(reader, value, shape))


def _input(reader: Reader, node: Term, shape: Term) -> Expression:
    """``sh:nodes``, or the focus node where none are given."""
    given = reader.one(node, "nodes")
    return read_expression(reader, _THIS if given is None else given, shape)


def _path(reader: Reader, value: Term, nodes: Expression, shape: Term) -> Expression:
    path = read_path(reader.graph, value)
    if path is None:
        raise ShapeFault("the sh:path of a node expression is no property path", shape)

    def evaluate(run: Run, focus: Term) -> Iterable[Term]:
        return dict.fromkeys(found for node in nodes(run, focus) for found in follow(run.data, node, path))

    return evaluate


def _combine(name: str, parts: Sequence[Expression]) -> Expression:
    def evaluate(run: Run, focus: Term) -> Iterable[Term]:
        found = [dict.fromkeys(part(run, focus)) for part in parts]
        if name == "union":
            return dict.fromkeys(node for one in found for node in one)
        return [node for node in found[0] if all(node in other for other in found[1:])] if found else []

    return evaluate


def _choice(parts: dict[str, Expression]) -> Expression:
    true = boolean(True)

    def evaluate(run: Run, focus: Term) -> Iterable[Term]:
        chosen = parts.get("then" if list(parts["if"](run, focus)) == [true] else "else")
        return () if chosen is None else chosen(run, focus)

    return evaluate


def _fold(name: str, inner: Expression) -> Expression:
    def evaluate(run: Run, focus: Term) -> Iterable[Term]:
        found = list(inner(run, focus))
        if name == "count":
            return (integer(len(found)),)
        if name == "exists":
            return (boolean(bool(found)),)
        if name == "distinct":
            return dict.fromkeys(found)
        literals = [one for one in found if isinstance(one, Literal)]
        best = literals[:1]
        for one in literals[1:]:
            if less(one, best[0]) if name == "min" else less(best[0], one):
                best = [one]
        return best

    return evaluate


def _call(reader: Reader, node: Term, shape: Term) -> Expression:
    """A function that the shapes graph declares, over every combination of its arguments' nodes."""
    for predicate in reader.graph.predicates(node):
        members = None
        for value in reader.values(node, predicate):
            members = reader.graph.items(value)
        if members is None or predicate.value.startswith(SH):
            continue
        if not reader.graph.predicates(predicate):
            raise ShapeFault(f"the function <{predicate.value}> is not declared", shape)
        arguments = [read_expression(reader, member, shape) for member in members]
        return _calling(predicate, arguments, shape)
    raise ShapeFault("a node expression is none that is known", shape)


def _calling(name: NamedNode, arguments: Sequence[Expression], shape: Term) -> Expression:
    def evaluate(run: Run, focus: Term) -> Iterable[Term]:
        function = run.shapes.functions.get(name)
        if function is None:
            raise ShapeFault(f"the function {name} is not declared", shape)
        found = (function(*row) for row in product(*(list(argument(run, focus)) for argument in arguments)))
        return dict.fromkeys(result for result in found if result is not None)  # an expression stands for a set

    return evaluate
