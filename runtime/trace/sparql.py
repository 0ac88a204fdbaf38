"""A query and a store in, a table out; also the named competency queries that ship with the ontology."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, Store, Triple

import ontology
from onto_compiler.lexical.store import LexicalStore, Rows
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.rdf import PREFIXES, XSD, shorten
from onto_compiler.shacl.values import is_well_formed
from onto_compiler.sparql_faults.explain import query_fault, without_mark
from onto_compiler.sparql_faults.fault import Fault
from onto_compiler.sparql_faults.undeclared import StoreVocabulary, undeclared
from onto_compiler.terms import show
from onto_compiler.turtle.tokens import SourceText
from runtime.trace.names import RUNS

__all__ = ["Answer", "NamedQuery", "ask", "csv_rows", "named_queries", "named_query", "plain", "words"]

Cell = NamedNode | BlankNode | Literal | Triple | None

_INTEGERS = frozenset(XSD + name for name in ("integer", "int", "long", "nonNegativeInteger"))
_NUMBERS = frozenset(XSD + name for name in ("double", "float", "decimal"))


@dataclass(frozen=True, slots=True)
class NamedQuery:
    """A competency query: its question is the first comment line of its file."""

    name: str
    question: str
    text: str
    file: Path


@dataclass(frozen=True, slots=True)
class Answer:
    """The rows that a query found, as RDF terms; None if a variable is unbound."""

    name: str
    question: str
    query: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def records(self) -> list[dict[str, Any]]:
        """One mapping per row, with numbers and truth values as such."""
        return [dict(zip(self.columns, map(plain, row), strict=True)) for row in self.rows]


def ask(store: Store | LexicalStore, query: str, *, name: str = "", file: str = "") -> Answer:
    """Run ``query`` over all graphs of ``store`` together; our prefixes need no declaration.

    Raises:
        OntoError: TRC004 if the query is no SPARQL or cannot be evaluated; QRY001 to QRY003 if it would reach
            the network, change the trace, or ask for graphs that are not in it; VOC001 or VOC011 for each name
            that its vocabulary does not declare, which would match nothing.
    """
    asked = store if isinstance(store, LexicalStore) else LexicalStore(store=store)
    graphs = {graph.value for graph in asked.store.named_graphs()}
    fault = query_fault(query, PREFIXES, graphs=graphs)
    if fault is not None:
        message = fault.message if fault.code else f"not SPARQL: {fault.message}"
        hint = fault.hint or "see `onto trace query --help`"
        raise OntoError(_problem(query, file, replace(fault, message=message, hint=hint, code=fault.code or "TRC004")))
    unknown = [_problem(query, file, one) for _, one in undeclared(query, PREFIXES, StoreVocabulary(asked.store))]
    if unknown:
        raise OntoError(*unknown)
    try:
        columns, rows = _table(asked.ask(without_mark(query), prefixes=PREFIXES))
    except (RuntimeError, ValueError, OSError) as error:
        raise OntoError.of("TRC004", f"the query cannot be evaluated: {error}", "", file) from error
    return Answer(name, _question(query), query, columns, rows)


def _problem(query: str, file: str, fault: Fault) -> Problem:
    span = SourceText(file, query).span(fault.start, fault.start + fault.length)
    return Problem.at(span, fault.code, fault.message, fault.hint)


def _table(answer: Rows) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:
    if answer.kind == "ask":
        truth = Literal("true" if list(answer.rows) else "false", datatype=NamedNode(XSD + "boolean"))
        return ("answer",), ((truth,),)
    return answer.names, tuple(answer.rows)


def named_queries() -> dict[str, NamedQuery]:
    """The shipped competency queries by name."""
    return {query.name: query for query in map(_read, ontology.query_files("competency"))}


def named_query(name: str) -> NamedQuery:
    """The competency query called ``name``.

    Raises:
        OntoError: TRC005 if there is none.
    """
    known = named_queries()
    if name not in known:
        hint = near(name, known) or f"the named queries are {', '.join(known)}"
        raise OntoError.of("TRC005", f"`{name}` is not a named query", hint)
    return known[name]


def _read(file: Path) -> NamedQuery:
    text = file.read_text(encoding="utf-8")
    return NamedQuery(file.stem, _question(text), text, file)


def _question(query: str) -> str:
    first = without_mark(query).lstrip().partition("\n")[0]
    return first.removeprefix("#").strip() if first.startswith("#") else ""


def plain(term: Cell) -> str | int | float | bool | None:
    """A term as JSON and CSV have it: whole IRIs, and numbers and truth values as such."""
    if term is None:
        return None
    if not isinstance(term, Literal):
        if isinstance(term, Triple):
            return f"<<( {term} )>>"
        return term.value if isinstance(term, NamedNode) else str(term)
    kind, sound = term.datatype.value, is_well_formed(term)
    if sound and kind in _INTEGERS | _NUMBERS:
        return int(term.value) if kind in _INTEGERS else float(term.value)
    return term.value in {"true", "1"} if sound and kind == XSD + "boolean" else term.value


def words(term: Cell) -> str:
    """A term as people read it: IRIs shortened, numbers to five significant digits."""
    if isinstance(term, NamedNode):
        iri = term.value
        return f"run:{iri.removeprefix(RUNS)}" if iri.startswith(RUNS) else shorten(iri)
    if isinstance(term, Triple):
        return show(term)
    value = plain(term)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.5g}"
    return "" if value is None else str(value)


def csv_rows(answer: Answer) -> Iterator[list[str]]:
    """The header and the rows of ``answer`` as text."""
    yield list(answer.columns)
    for row in answer.rows:
        values = (plain(cell) for cell in row)
        yield [str(v).lower() if isinstance(v, bool) else "" if v is None else str(v) for v in values]
