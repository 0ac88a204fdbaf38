"""The JSON that ``onto compile`` prints: a required ABox, a batch of files, and the problems of both."""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import Any

from onto_compiler.rdf import CORE, RDFS, TRACE
from onto_compiler.record.described import Described
from onto_compiler.record.rows import GRAPH, TYPE, Column, Row, printed
from onto_compiler.required import Fact
from onto_compiler.required_rdf import FACT, REQUIRED_ABOX
from onto_compiler.schema import Schema, local_name

__all__ = ["BATCH", "COMPILATION", "COMPILED", "REQUIRED_ABOX_ROW"]


def _plain(kind: str, *names: str) -> dict[str, Column]:
    """Columns of attributes as they are."""
    return {name: Column(kind, _get(name)) for name in names}


def _get(name: str) -> Callable[[Any, Any], Any]:
    get = attrgetter(name)
    return lambda subject, _: get(subject)


def _item(name: str) -> Callable[[Any, Any], Any]:
    return lambda subject, _: subject[name]


def _each(row: Row, name: str) -> Callable[[Any, Any], Any]:
    """A list of rows."""
    get = attrgetter(name)
    return lambda subject, names: [row.of(each, names) for each in get(subject)]


def _place(name: str) -> Callable[[Fact, Schema], int]:
    return lambda fact, _: getattr(fact.span, name) if fact.span else 0


ARGUMENT = Row(
    "An argument of a required fact: its name in the scene, and its class or, of a threshold, its own name.",
    {
        "name": Column("string", _get("name"), RDFS + "label"),
        "type": Column("word:entity", lambda entity, _: local_name(entity.type), TYPE),
    },
)
REQUIRED_FACT = Row(
    "An assertion that a task asks for.",
    {
        "predicate": Column("word:predicate_local", lambda fact, _: local_name(fact.predicate), CORE + "predicate"),
        "arguments": Column("list:Argument", _each(ARGUMENT, "arguments"), CORE + "arguments"),
        **printed(FACT, "polarity", "threshold"),
        "native": Column("string", lambda fact, _: str(fact.native), CORE + "nativeAtom"),
        **printed(FACT, "grounded_by"),
        "line": Column("integer", _place("line")),
        "column": Column("integer", _place("column")),
    },
    ("signature",),
)
REQUIRED_ABOX_ROW = Row(
    "What a task asks for at its end, and declares of its start.",
    {
        **printed(REQUIRED_ABOX, "task", "language", "problem", "source"),
        "facts": Column("list:RequiredFact", _each(REQUIRED_FACT, "facts"), TRACE + "memberFact"),
        "alternatives": Column("rows:integer", lambda abox, _: [list(way) for way in abox.alternatives], optional=True),
        "premise": Column("list:RequiredFact", _each(REQUIRED_FACT, "premise"), TRACE + "declares"),
    },
)
PROBLEM = Row(
    "A fault in an input, with its place; line and column are 0 where a whole file is meant.",
    {
        **_plain("string", "code", "severity", "file"),
        **_plain("integer", "line", "column"),
        **_plain("string", "message", "hint"),
    },
)
COMPILATION = Row(
    "What `onto compile --json` prints.",
    {
        "tasks": Column("list:RequiredABox", lambda found, _: [REQUIRED_ABOX_ROW.of(t) for t in found["tasks"]], GRAPH),
        "problems": Column("list:Problem", lambda found, _: [PROBLEM.of(each) for each in found["problems"]]),
    },
)
VERDICT = Row(
    "What a task file came to in a batch: how much it asks for, and whether the cache knew.",
    {
        "file": Column("string", lambda pair, _: str(pair[0])),
        "compiled": Column("boolean", lambda pair, _: pair[1].compiled),
        "facts": Column("integer", lambda pair, _: pair[1].facts),
        "premise": Column("integer", lambda pair, _: pair[1].premise),
        "alternatives": Column("integer", lambda pair, _: pair[1].alternatives),
        "cached": Column("boolean", lambda pair, _: pair[1].cached),
    },
)
SUMMARY = Row(
    "How many files a batch had, and what they came to.",
    {name: Column("integer", _item(name)) for name in ("files", "compiled", "failed", "cached")},
)
BATCH = Row(
    "What `onto compile FOLDER --json` prints.",
    {
        "files": Column("list:Verdict", lambda batch, _: [VERDICT.of(pair) for pair in batch.verdicts.items()]),
        "summary": Column("record:Summary", lambda batch, _: SUMMARY.of(batch.summary)),
        "problems": Column("list:Problem", _each(PROBLEM, "problems")),
    },
)
COMPILED = Described(
    rows={
        "Argument": ARGUMENT,
        "Batch": BATCH,
        "Compilation": COMPILATION,
        "Problem": PROBLEM,
        "RequiredABox": REQUIRED_ABOX_ROW,
        "RequiredFact": REQUIRED_FACT,
        "Summary": SUMMARY,
        "Verdict": VERDICT,
    },
    documents=("Compilation", "Batch"),
)
