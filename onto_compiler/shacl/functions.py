"""``sh:SPARQLFunction`` (SHACL-AF, section 5): functions that a shapes graph declares, callable in its queries."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

from pyoxigraph import Literal, NamedNode, QueryBoolean, QueryTriples

from onto_compiler.rdf import SH, boolean
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeFault
from onto_compiler.shacl.prebinding import Query, read_query
from onto_compiler.shacl.reader import Reader

__all__ = ["Functions", "declared_functions"]

Function = Callable[..., Any]


class Functions(dict[NamedNode, Function]):
    """The functions by IRI. They ask ``data``, which the validation sets before it begins."""

    def __init__(self) -> None:
        super().__init__()
        self.data = Graph()


def declared_functions(reader: Reader, faults: list[ShapeFault] | None = None) -> Functions:
    """Every SPARQL function of a shapes graph. Parameters are ordered by ``sh:order``, then by local name.

    Functions that must not be run are left out and appended to ``faults``.

    Raises:
        ShapeFault: the first of them, where no list is given.

    """
    found = Functions()
    for one in reader.graph.instances(NamedNode(SH + "SPARQLFunction")):
        try:
            body = reader.query(one, "select") or reader.query(one, "ask")
        except ShapeFault as fault:
            if faults is None:
                raise
            if not any(fault.same(other) for other in faults):
                faults.append(fault)
            continue
        if not isinstance(one, NamedNode) or body is None:
            continue
        names = [name for _, name in sorted(_parameters(reader, one))]
        found[one] = _function(one, found, read_query(body, names), names)
    return found


def _parameters(reader: Reader, function: Term) -> list[tuple[tuple[float, str], str]]:
    found = []
    for parameter in reader.values(function, "parameter"):
        path, order = reader.one(parameter, "path"), reader.one(parameter, "order")
        if path is not None:
            name = path.value.rpartition("#")[2].rpartition("/")[2]
            found.append(((float(order.value) if isinstance(order, Literal) else 0.0, name), name))
    return found


def _function(name: NamedNode, known: Functions, query: Query, names: Sequence[str]) -> Function:
    def call(*arguments: Term) -> Term | None:
        text, extra = query.bind(dict(zip(names, arguments, strict=False)))
        everything: Mapping[NamedNode, Function] = {**known, **extra}
        try:
            answer = known.data.store.query(text, use_default_graph_as_union=True, custom_functions=dict(everything))
        except SyntaxError as error:
            reason = " ".join(str(error).partition(", [")[0].split())
            raise ShapeFault(f"the function {name} cannot run: {reason}", name) from error
        if isinstance(answer, QueryTriples):
            raise ShapeFault(f"the function {name} is neither a SELECT nor an ASK query", name)
        if isinstance(answer, QueryBoolean):
            return boolean(bool(answer))
        for row in answer:
            return cast("Term | None", row[0])
        return None

    return call
