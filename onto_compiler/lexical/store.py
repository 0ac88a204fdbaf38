"""A store that answers SPARQL with literals as they were written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

from pyoxigraph import BlankNode, Literal, NamedNode, Quad, QueryBoolean, QuerySolutions, Store

from onto_compiler.lexical.query import DATATYPE, EXTREMES, STRDT, VALUE, keep
from onto_compiler.lexical.terms import mark, respelled, unmark, value
from onto_compiler.shacl.values import less

__all__ = ["LexicalStore", "Rows"]

Function = Callable[..., Any]


@dataclass(frozen=True, slots=True)
class Rows:
    """The answer to a query: ``kind`` is ``select``, ``ask`` or ``construct``; ASK has one row where it is true."""

    kind: str
    names: tuple[str, ...]
    rows: Iterable[tuple[Any, ...]]


class LexicalStore:
    """An Oxigraph store; literals that it would spell again are marked in it (see the package)."""

    def __init__(self, quads: Iterable[Quad] = (), store: Store | None = None) -> None:
        self.store = Store() if store is None else store
        self.marked = False
        self.extend(quads)

    def extend(self, quads: Iterable[Quad]) -> None:
        """Add statements."""
        found = list(quads)
        objects = {quad.object for quad in found}
        if respelled(objects):
            self.marked = True
            known = {term: mark(term) for term in objects}
            found = [Quad(one.subject, one.predicate, known[one.object], one.graph_name) for one in found]
        self.store.bulk_extend(found)

    def keeps(self, text: str, terms: Iterable[Any] = (), prefixes: Mapping[str, str] | None = None) -> bool:
        """Whether ``text``, with ``terms`` bound in it, must be asked as :func:`keep` writes it."""
        return self.marked or keep(text, _pairs(prefixes)).forms or respelled(terms)

    def ask(
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        functions: Mapping[NamedNode, Function] | None = None,
        union: bool = True,
        kept: bool | None = None,
    ) -> Rows:
        """The answer to ``text``; ``kept`` says that it is a text of :func:`keep` already, or need not be one.

        Raises:
            SyntaxError: it is not SPARQL. ValueError, RuntimeError, OSError: it cannot be evaluated.

        """
        if kept is None:
            kept = self.keeps(text, prefixes=prefixes)
            text = keep(text, _pairs(prefixes)).text if kept else text
        known = dict(functions or {})
        if kept:
            known = {name: partial(_with_forms, function) for name, function in known.items()} | _FUNCTIONS
        answer = self.store.query(
            text,
            prefixes=dict(prefixes or {}),
            use_default_graph_as_union=union,
            custom_functions=known or None,
            custom_aggregate_functions=_AGGREGATES if kept else None,
        )
        if isinstance(answer, QueryBoolean):
            return Rows("ask", (), [()] if answer else [])
        if isinstance(answer, QuerySolutions):
            names = tuple(variable.value for variable in answer.variables)
            return Rows("select", names, _unmarked(answer) if kept else map(tuple, answer))
        triples = ((triple.subject, triple.predicate, triple.object) for triple in answer)
        return Rows("construct", ("subject", "predicate", "object"), _unmarked(triples) if kept else triples)


def _pairs(prefixes: Mapping[str, str] | None) -> tuple[tuple[str, str], ...]:
    return tuple(prefixes.items()) if prefixes else ()


def _unmarked(rows: Iterable[Iterable[Any]]) -> Iterator[tuple[Any, ...]]:
    return (tuple(map(unmark, row)) for row in rows)


# What a kept text calls. Terms arrive as the store has them, and leave so that it can compute with them.


def _with_forms(function: Function, *arguments: Any) -> Any:  # noqa: ANN401 - RDF terms of every kind
    found = function(*map(unmark, arguments))
    return None if found is None else mark(found)


def _datatype(term: Any) -> NamedNode | None:  # noqa: ANN401 - as above
    return unmark(term).datatype if isinstance(term, Literal) else None


def _strdt(text: Any, datatype: Any) -> Literal | None:  # noqa: ANN401 - as above
    if not isinstance(text, Literal) or not isinstance(datatype, NamedNode) or text.language is not None:
        return None
    return mark(Literal(text.value, datatype=datatype))


_FUNCTIONS: dict[NamedNode, Function] = {VALUE: value, DATATYPE: _datatype, STRDT: _strdt}


class _Extreme:
    """MIN or MAX: the least or the greatest by value, as it was written; blank nodes come before IRIs and literals."""

    def __init__(self, sign: int) -> None:
        self.sign, self.best = sign, cast("Any", None)

    def accumulate(self, term: Any) -> None:  # noqa: ANN401 - as above
        if self.best is None or _order(term, self.best) * self.sign < 0:
            self.best = term

    def finish(self) -> Any:  # noqa: ANN401 - as above
        return self.best


def _order(one: Any, other: Any) -> int:  # noqa: ANN401 - as above
    kinds: Sequence[type] = (BlankNode, NamedNode, Literal)
    ranks = [next((rank for rank, kind in enumerate(kinds) if isinstance(term, kind)), 3) for term in (one, other)]
    if ranks[0] != ranks[1]:
        return ranks[0] - ranks[1]
    if ranks[0] == 2:
        first, second = unmark(one), unmark(other)
        if less(first, second) or less(second, first):
            return -1 if less(first, second) else 1
        if less(first, second, or_equal=True):
            return 0
        one, other = first, second
    return (str(one) > str(other)) - (str(one) < str(other))


_AGGREGATES: dict[NamedNode, Function] = {EXTREMES["MIN"]: partial(_Extreme, 1), EXTREMES["MAX"]: partial(_Extreme, -1)}
