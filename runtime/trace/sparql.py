"""A query and a store in, a table out; also the named competency queries that ship with the ontology."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pyoxigraph import BlankNode, Literal, NamedNode, QueryBoolean, QuerySolutions, Store, Triple

import ontology
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.rdf import PREFIXES, XSD, shorten
from onto_compiler.sparql import refusal
from onto_compiler.turtle.tokens import SourceText
from runtime.trace.names import RUNS

__all__ = ["Answer", "NamedQuery", "ask", "csv_rows", "named_queries", "named_query", "plain", "words"]

Cell = NamedNode | BlankNode | Literal | Triple | None

_PLACE = re.compile(r"error at (\d+):(\d+): ")
_LONGEST = 160
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


def ask(store: Store, query: str, *, name: str = "", file: str = "") -> Answer:
    """Run ``query`` over all graphs of ``store`` together; our prefixes need no declaration.

    Raises:
        OntoError: TRC004 if the query is no SPARQL or cannot be evaluated; QRY001 to QRY003 if it would reach
            the network, change the trace, or ask for graphs that are not in it.
    """
    graphs = {graph.value for graph in store.named_graphs()}
    try:
        refused = refusal(query, prefixes=PREFIXES, graphs=graphs)
        if refused is not None:
            start, length = refused.place(query)
            span = SourceText(file, query).span(start, start + length)
            raise OntoError(Problem.at(span, refused.code, refused.message, refused.hint))
        result = store.query(query, prefixes=PREFIXES, use_default_graph_as_union=True)
        columns, rows = _table(result)
    except SyntaxError as error:
        raise OntoError(_syntax_problem(str(error), query, file)) from error
    except (RuntimeError, ValueError, OSError) as error:
        raise OntoError.of("TRC004", f"the query cannot be evaluated: {error}", "", file) from error
    return Answer(name, _question(query), query, columns, rows)


def _table(result: Any) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:  # noqa: ANN401 - a union of classes
    if isinstance(result, QueryBoolean):
        truth = Literal("true" if result else "false", datatype=NamedNode(XSD + "boolean"))
        return ("answer",), ((truth,),)
    if isinstance(result, QuerySolutions):
        variables = result.variables
        return tuple(v.value for v in variables), tuple(tuple(row[v] for v in variables) for row in result)
    triples = tuple((triple.subject, triple.predicate, triple.object) for triple in result)
    return ("subject", "predicate", "object"), triples


def _syntax_problem(text: str, query: str, file: str) -> Problem:
    place = _PLACE.match(text)
    line, column = (int(place[1]), int(place[2])) if place else (0, 0)
    message = " ".join(_PLACE.sub("", text).split())
    if "Prefix not found" in message:
        prefix = _word(query, line, column).partition(":")[0]
        hint = f"add a line `PREFIX {prefix}: <...>`"
        return Problem(file, line, column, "TRC004", "error", f"the prefix `{prefix}:` is not declared", hint)
    if len(message) > _LONGEST:
        message = message[:_LONGEST].rsplit(",", 1)[0] + " ..."
    message = message.replace(", [_]", "").replace("[_]", "more text")
    # Oxigraph often blames the end of the text for what went wrong before it.
    if (line, column) > _end(query):
        line, column, message = _second_opinion(query) or (*_end(query), message)
    return Problem(file, line, column, "TRC004", "error", f"not SPARQL: {message}", "see `onto trace query --help`")


def _end(query: str) -> tuple[int, int]:
    """Line and column of the last character that is no white space."""
    lines = query.rstrip().splitlines() or [""]
    return len(lines), max(len(lines[-1]), 1)


def _word(query: str, line: int, column: int) -> str:
    """The word of ``query`` that surrounds a place."""
    text = query.splitlines()[line - 1]
    start = max((text.rfind(mark, 0, column - 1) for mark in " \t{}()"), default=-1) + 1
    return text[start:].split()[0] if text[start:].split() else ""


def _second_opinion(query: str) -> tuple[int, int, str] | None:
    """Where and why rdflib's parser rejects ``query``; None if it does not."""
    from pyparsing import ParseException  # noqa: PLC0415 - only a faulty query needs it
    from rdflib.plugins.sparql.parser import parseQuery  # noqa: PLC0415

    try:
        parseQuery(query)
    except ParseException as error:
        if (error.lineno, error.column) <= _end(query):
            return (
                error.lineno,
                error.column,
                f"what begins with `{_word(query, error.lineno, error.column)}` is not understood",
            )
        return *_end(query), "the query ends before it is complete"
    return None


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
    first = query.lstrip().partition("\n")[0]
    return first.removeprefix("#").strip() if first.startswith("#") else ""


def plain(term: Cell) -> str | int | float | bool | None:
    """A term as JSON and CSV have it: whole IRIs, and numbers and truth values as such."""
    if term is None:
        return None
    if not isinstance(term, Literal):
        return term.value if isinstance(term, NamedNode) else str(term)
    kind = term.datatype.value
    if kind in _INTEGERS:
        return int(term.value)
    if kind in _NUMBERS:
        return float(term.value)
    return term.value == "true" if kind == XSD + "boolean" else term.value


def words(term: Cell) -> str:
    """A term as people read it: IRIs shortened, numbers to five significant digits."""
    if isinstance(term, NamedNode):
        iri = term.value
        return f"run:{iri.removeprefix(RUNS)}" if iri.startswith(RUNS) else shorten(iri)
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
