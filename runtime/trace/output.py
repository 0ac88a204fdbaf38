"""What the subcommands of ``onto trace`` print."""

from __future__ import annotations

import argparse
import csv
import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from pyoxigraph import RdfFormat
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from onto_compiler.command import CLEAN, print_json
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import OntoError
from onto_compiler.wording import counted
from runtime.loop.records import state_name
from runtime.trace.find import find_episode
from runtime.trace.names import RUNS, run_of
from runtime.trace.narrate import narrate
from runtime.trace.reasons import load_reasons
from runtime.trace.sparql import Answer, Cell, csv_rows, named_queries, named_query, plain, words
from runtime.trace.store import Trace, dump
from runtime.trace.summary import episode_summary

__all__ = ["explain", "export", "listing", "print_answer", "query", "show"]

_FORMATS = {"trig": RdfFormat.TRIG, "nquads": RdfFormat.N_QUADS, "jsonld": RdfFormat.JSON_LD}
_WIDTH = 80
_GAP = 3  # between two columns
_EPISODES = """
SELECT ?episode ?suite ?task ?state ?given ?seed ?trial ?outcome (COUNT(DISTINCT ?attempt) AS ?attempts)
    (GROUP_CONCAT(DISTINCT ?how ; separator = ", ") AS ?mode)
    (GROUP_CONCAT(DISTINCT CONCAT(?key, "=", ?said) ; separator = ", ") AS ?tags) WHERE {
    ?episode a trace:Episode .
    OPTIONAL { ?episode trace:suite ?suite } OPTIONAL { ?episode trace:task ?task }
    OPTIONAL { ?episode trace:stateIndex ?state } OPTIONAL { ?episode trace:givenState ?given }
    OPTIONAL { ?episode trace:seed ?seed } OPTIONAL { ?episode trace:trial ?trial }
    OPTIONAL { ?episode trace:outcome/skos:notation ?outcome }
    OPTIONAL { ?episode trace:tag ?tag . ?tag trace:name ?key ; trace:value ?said }
    OPTIONAL {
        ?attempt trace:inEpisode ?episode .
        OPTIONAL { ?attempt (trace:applied/trace:mode|trace:mode)/skos:notation ?how }
    }
} GROUP BY ?episode ?suite ?task ?state ?given ?seed ?trial ?outcome"""


def query(options: argparse.Namespace, open_trace: Callable[[str | None], Trace]) -> int:
    """Answer a query from a file, from standard input (``-``) or by its name."""
    if options.list:
        return _list_queries(options.format)
    given = list(options.words)
    if options.named:
        known = named_query(options.named)
        name, text, file = known.name, known.text, str(known.file)
    elif given:
        name, file = Path(given[0]).stem, given.pop(0)
        text = _read(file)
    else:
        hint = f"name one of {', '.join(named_queries())} with --named, or give a FILE.rq"
        raise OntoError.of("CLI002", "`onto trace query` needs a query", hint)
    if len(given) > 1:
        raise OntoError.of("CLI002", f"`{given[1]}` is one argument too many", "see `onto trace query --help`")
    trace = open_trace(given[0] if given else None)
    print_answer(trace.query(text, name=name, file=file), options.format)
    return CLEAN


def _read(file: str) -> str:
    if file == "-":
        return sys.stdin.read()
    try:
        return Path(file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        hint = "give a file that holds a SPARQL query, or --named NAME; `onto trace query --list` lists the names"
        raise OntoError.of("TRC004", f"the query cannot be read: {error}", hint, file) from error


def _list_queries(shape: str) -> int:
    known = named_queries().values()
    if shape == "json":
        print_json([{"name": query.name, "question": query.question} for query in known])
    else:
        _emit(("name", "question"), [(query.name, query.question) for query in known], shape)
    return CLEAN


def listing(trace: Trace, shape: str) -> int:
    """One line per episode, numbered as for ``show``, with everything that identifies it."""
    found = {row["episode"]: row for row in trace.query(_EPISODES).records()}
    rows = [_listed(number, iri, found[iri]) for number, iri in enumerate(trace.episodes(), 1)]
    if shape == "json":
        print_json(rows)
    elif shape == "csv":
        columns = list(_listed(0, "", dict.fromkeys(_LISTED)))
        csv.writer(sys.stdout, lineterminator="\n").writerows([columns, *(row.values() for row in rows)])
    else:
        for row in rows:
            sys.stdout.write(f"{row['number']:>4}  {row['task']}\n      {_line(row)}\n")
        _note(f"{counted(len(rows), 'episode')} in {trace.source}")
    return CLEAN


_LISTED = ("suite", "task", "state", "given", "seed", "trial", "tags", "mode", "outcome", "attempts")


def _listed(number: int, iri: str, found: Mapping[str, Any]) -> dict[str, Any]:
    row = {"number": number, "run": unquote(run_of(iri).removeprefix(RUNS)), **{name: found[name] for name in _LISTED}}
    return {**row, "trial": found["trial"] or 0, "mode": found["mode"] or "none"}


def _line(row: Mapping[str, Any]) -> str:
    """An episode's names and outcome, in one line."""
    state = "unknown" if row["state"] is None else state_name(row["state"])
    names = [f"run {row['run']}", row["suite"], f"{state} {row['given'] or ''}".strip(), f"seed {row['seed']}"]
    names += [f"trial {row['trial']}"] * bool(row["trial"]) + [row["tags"]] * bool(row["tags"])
    ended = str(row["outcome"]).replace("_", " ")
    tries = counted(int(row["attempts"]), "attempt")
    return f"{', '.join(filter(None, map(str, names)))}: {ended}, {tries}, mode {row['mode']}"


def show(trace: Trace, wanted: str, shape: str, ontology: Sequence[str]) -> int:
    """One episode in sentences, or as the summary that ``onto demo --json`` prints."""
    episode = trace.episode(find_episode(wanted, trace.episodes()))
    schema = load_schema(*ontology)
    if shape == "json":
        print_json(episode_summary(episode, schema))
        return CLEAN
    _print_wrapped(narrate(episode, schema))
    return CLEAN


def explain(trace: Trace, wanted: str, shape: str, ontology: Sequence[str]) -> int:
    """One episode with the reason of each decision, in sentences or as JSON."""
    episode = trace.episode(find_episode(wanted, trace.episodes()))
    schema = load_schema(*ontology)
    reasons = load_reasons(schema, ontology)
    if shape == "json":
        summary = episode_summary(episode, schema)
        history = [
            {**one, **reasons.of_attempt(turn)} for one, turn in zip(summary["history"], episode.attempts, strict=True)
        ]
        print_json({**summary, "history": history})
    else:
        _print_wrapped(narrate(episode, schema, reasons))
    return CLEAN


def export(trace: Trace, shape: str, output: str | None) -> int:
    """The whole trace in another format, to a file or to standard output."""
    data = dump(trace.store, _FORMATS[shape])
    if output is None:
        sys.stdout.write(data.decode("utf-8"))
        return CLEAN
    try:
        Path(output).write_bytes(data)
    except OSError as error:
        hint = "name a file that you may write"
        raise OntoError.of("TRC001", f"cannot write `{output}`: {error.strerror}", hint, output) from error
    return CLEAN


def _print_wrapped(lines: Iterable[str]) -> None:
    """Print lines, each wrapped to the terminal at its own indentation."""
    width = min(shutil.get_terminal_size((_WIDTH, 24)).columns, 110)
    for line in lines:
        body = line.lstrip()
        indent = line[: len(line) - len(body)]
        hanging = f"{indent}    "
        wrapper = textwrap.TextWrapper(width, initial_indent=indent, subsequent_indent=hanging)
        wrapper.break_long_words = wrapper.break_on_hyphens = False
        sys.stdout.write(wrapper.fill(body) + "\n")


def print_answer(answer: Answer, shape: str) -> None:
    """Print an answer as a table, as ``json`` or as ``csv``."""
    if shape == "json":
        print_json({"name": answer.name, "question": answer.question, "rows": answer.records()})
    elif shape == "csv":
        csv.writer(sys.stdout, lineterminator="\n").writerows(csv_rows(answer))
    else:
        if answer.question:
            sys.stdout.write(answer.question + "\n")
        _emit(answer.columns, [tuple(map(words, row)) for row in answer.rows], shape, _numeric(answer.rows))
        _note(counted(len(answer.rows), "row"))


def _numeric(rows: Sequence[tuple[Cell, ...]]) -> frozenset[int]:
    """The columns that hold numbers only, which are aligned to the right."""
    columns = list(zip(*rows, strict=True))
    cells = [[plain(cell) for cell in column if cell is not None] for column in columns]
    return frozenset(i for i, found in enumerate(cells) if found and all(type(v) in {int, float} for v in found))


def _emit(
    columns: Sequence[str], rows: Sequence[tuple[str, ...]], shape: str, right: frozenset[int] = frozenset()
) -> None:
    if shape == "csv":
        csv.writer(sys.stdout, lineterminator="\n").writerows([columns, *rows])
        return
    width = _width(columns, rows)
    if sum(_longest_word(cells) + _GAP for cells in zip(columns, *rows, strict=True)) > width:
        _emit_records(columns, rows)
        return
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="right" if index in right else "left", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    Console(file=sys.stdout, highlight=False, width=width).print(table)


def _width(columns: Sequence[str], rows: Sequence[tuple[str, ...]]) -> int:
    """The terminal's width; what is piped into another program is not wrapped, unless COLUMNS asks for it."""
    console = Console(file=sys.stdout)
    if console.is_terminal or "COLUMNS" in os.environ:
        return console.width
    return max(_WIDTH, sum(max(map(len, cells)) + _GAP for cells in zip(columns, *rows, strict=True)))


def _longest_word(cells: Sequence[str]) -> int:
    return max(len(word) for cell in cells for word in (cell.split() or [""]))


def _emit_records(columns: Sequence[str], rows: Sequence[tuple[str, ...]]) -> None:
    """A row too wide for a table: one line per value."""
    left = max(map(len, columns))
    for row in rows:
        lines = (f"{column:<{left}}  {cell}".rstrip() for column, cell in zip(columns, row, strict=True))
        sys.stdout.write("\n".join(lines) + "\n\n")


def _note(text: str) -> None:
    sys.stderr.write(text + "\n")
