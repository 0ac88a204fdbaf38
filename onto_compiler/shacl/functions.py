"""``sh:SPARQLFunction`` (SHACL-AF, section 5): functions that a shapes graph declares, callable in its queries."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

from pyoxigraph import Literal, NamedNode

from onto_compiler.rdf import SH, boolean
from onto_compiler.shacl.graph import Graph, Term
from onto_compiler.shacl.model import ShapeFault, noting
from onto_compiler.shacl.prebinding import Query, ask, read_query
from onto_compiler.shacl.reader import Reader
from onto_compiler.terms import show, text_of

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
        body = None
        with noting(faults):
            what = f"the function {show(one)}"
            body = reader.query(one, "select", what=what) or reader.query(one, "ask", what=what)
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
            name = text_of(path).rpartition("#")[2].rpartition("/")[2]
            found.append(((float(order.value) if isinstance(order, Literal) else 0.0, name), name))
    return found


def _function(name: NamedNode, known: Functions, query: Query, names: Sequence[str]) -> Function:
    def call(*arguments: Term) -> Term | None:
        try:
            answer = ask(known.data.store, query, dict(zip(names, arguments, strict=False)), known)
        except SyntaxError as error:
            reason = " ".join(str(error).partition(", [")[0].split())
            raise ShapeFault(f"the function {name} cannot run: {reason}", name) from error
        if answer.kind == "construct":
            raise ShapeFault(f"the function {name} is neither a SELECT nor an ASK query", name)
        first = next(iter(answer.rows), None)
        if answer.kind == "ask":
            return boolean(first is not None)
        return None if first is None else cast("Term | None", first[0])

    return call
