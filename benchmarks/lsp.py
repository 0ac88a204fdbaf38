"""What a keystroke costs in an editor: from the change sent to the problems received, with a real server process.

In every shipped Turtle file with terms a new block is typed after a block in the middle and rubbed out again, and a
definition gets a word more: one change per character, each waited for, none faster than the server answers. After each
change the semantic tokens and the symbols of the document are asked for, as an editor does; ``all_ms`` is when they are
there too. Beside it stands the whole check, which the server runs once the typing stops.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from math import ceil
from pathlib import Path

import ontology
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.lsp.client import Client
from onto_compiler.lsp.diagnose import whole_turtle

__all__ = ["LSP"]

FILES = ("bindings/libero.ttl", "core.ttl", "manipulation.ttl", "rules/diagnosis.ttl", "rules/routing.ttl", "trace.ttl")
SMALL = ("manipulation.ttl", "rules/diagnosis.ttl")
WHOLE = 5  # whole checks per file
_BLOCK = '\nrule:typed a owl:NamedIndividual ; rdfs:label "typed"@en ; skos:definition "Typed, not meant."@en .\n'
_WORD = " slowly"


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """One trial, so that no two servers are timed at once."""
    return [{"key": "all" if full else "small"}]


def run(trial: Trial) -> list[Row]:
    """Every keystroke in every file of the trial is a row, and so is every whole check."""
    files = FILES if trial["key"] == "all" else SMALL
    return [{"file": file, **row} for file in files for row in _session(ontology.ROOT / file)]


def _session(path: Path) -> list[Row]:
    text = path.read_text(encoding="utf-8")
    rows: list[Row] = []
    with Client() as client:
        client.open(path, text, "turtle")
        for where, line, character, typed in _edits(text):
            places = _places(line, character, typed)
            rows += [_keystroke(client, path, where, *place) for place in places]
            rows += [_keystroke(client, path, where, *place, erase=True) for place in reversed(places)]
    for _ in range(WHOLE):
        started = time.perf_counter()
        found = whole_turtle(path, text)
        rows.append(_row("whole", time.perf_counter() - started, len(found)))
    return rows


def _edits(text: str) -> list[tuple[str, int, int, str]]:
    """Where to type (line and character from 0) and what: a block of its own, and a word within a definition."""
    lines = text.splitlines()
    middle = len(lines) // 2
    blank = next(i for i, line in enumerate(lines) if i >= middle and not line and lines[i - 1].endswith("."))
    inside = next(i for i, line in enumerate(lines) if i >= middle and "skos:definition" in line)
    return [
        ("block", blank, 0, _BLOCK.replace("rule:", f"{_prefix(lines)}:")),
        ("definition", inside, lines[inside].index('"') + 5, _WORD),
    ]


def _prefix(lines: Sequence[str]) -> str:
    """The prefix of the file's first block, whose terms are its own."""
    start = next(i for i, line in enumerate(lines) if line and not line.startswith(("@", "<", " ", "[")))
    return lines[start].partition(":")[0]


def _places(line: int, character: int, typed: str) -> list[tuple[int, int, str]]:
    places = []
    for one in typed:
        places.append((line, character, one))
        line, character = (line + 1, 0) if one == "\n" else (line, character + 1)
    return places


def _keystroke(
    client: Client, path: Path, where: str, line: int, character: int, one: str, *, erase: bool = False
) -> Row:
    started = time.perf_counter()
    after = (line + 1, 0) if one == "\n" else (line, character + 1)
    found = client.replace(path, (line, character), after if erase else (line, character), "" if erase else one)
    seconds = time.perf_counter() - started
    document = {"textDocument": {"uri": path.as_uri()}}
    tokens = client.request("textDocument/semanticTokens/full", document)
    symbols = client.request("textDocument/documentSymbol", document)
    everything = time.perf_counter() - started
    broken = any(problem["code"].startswith("TTL") and problem["severity"] == 1 for problem in found)
    counted = {"tokens": len(tokens["data"]) // 5, "symbols": len(symbols), "parsed": not broken}
    return {**_row(where, seconds, len(found)), "all_ms": round(1000 * everything, 3), **counted}


def _row(where: str, seconds: float, problems: int) -> Row:
    return {"mode": "none", "sees": "none", "in": where, "ms": round(1000 * seconds, 3), "problems": problems}


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Percentiles of the keystrokes, of those among them after which the file is Turtle, and of the whole checks.

    ``all`` stands for the problems with the semantic tokens and the symbols; older rows are without these.
    """
    typed = sorted(row["ms"] for row in rows if row.get("in") in {"block", "definition"})
    whole = sorted(row["ms"] for row in rows if row.get("in") == "whole")
    parsed = sorted(row["ms"] for row in rows if row.get("parsed"))
    answered = sorted(row["all_ms"] for row in rows if "all_ms" in row)
    return {
        "crashed": sum("crashed" in row for row in rows),
        "files": len({row["file"] for row in rows if "file" in row}),
        "keystrokes": len(typed),
        "p50_ms": _percentile(typed, 0.5),
        "p95_ms": _percentile(typed, 0.95),
        "max_ms": typed[-1],
        "parsed": len(parsed),
        "parsed_p50_ms": _percentile(parsed, 0.5),
        "parsed_p95_ms": _percentile(parsed, 0.95),
        "whole_checks": len(whole),
        "whole_p50_ms": _percentile(whole, 0.5),
        "whole_max_ms": whole[-1],
        **(_all(answered) if answered else {}),
    }


def _all(answered: Sequence[float]) -> Mapping[str, float]:
    return {
        "all_p50_ms": _percentile(answered, 0.5),
        "all_p95_ms": _percentile(answered, 0.95),
        "all_max_ms": answered[-1],
    }


def _percentile(values: Sequence[float], share: float) -> float:
    """The smallest value that at least ``share`` of the sorted ``values`` do not exceed."""
    return values[max(0, ceil(len(values) * share) - 1)]


LSP = Protocol(
    name="lsp",
    help="milliseconds from a keystroke in a shipped Turtle file to the language server's problems, tokens and symbols",
    seeds=(),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"ms", "all_ms"}),
)
