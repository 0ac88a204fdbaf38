"""The tables of what needs no simulator: the checker, the validator, the task compiler and the editor's server."""

from __future__ import annotations

from typing import Any

from benchmarks.bddl import CORPORA
from benchmarks.markdown import table

__all__ = [
    "bddl_table",
    "check_table",
    "compiler_table",
    "conformance_table",
    "fuzz_table",
    "lsp_table",
    "validator_table",
]

Result = dict[str, Any]


def check_table(result: Result) -> str:
    """One line per timed command, then the broken files."""
    m = result["metrics"]
    rows = [
        (shown, str(m[f"{name}_runs"]), f"{m[f'{name}_median_s']:.3f}", f"{m[f'{name}_max_s']:.3f}")
        for name, shown in (("check", "`onto check`"), ("help", "`onto --help`"))
    ]
    note = (
        f"The shipped ontology has {m['shipped_problems']} problems. Of {m['broken_files']} files that are broken in "
        f"one way each, {m['broken_exact']} are reported with exactly the expected code, line and column."
    )
    return f"{table(('command', 'runs', 'median s', 'largest s'), rows)}\n\n{note}"


def bddl_table(result: Result) -> str:
    """One line per corpus, one for each warning, and the predicates that nothing binds."""
    m = result["metrics"]
    heads = ("corpus", "files", "do not parse", "read back changed", "with alternatives", "written out", "lifted")
    shown = ("files", "failed", "round_trip_failed", "with_alternatives", "written_out", "lifted")
    rows = [(f"`{name}`", *(str(m[f"{name}_{key}"]) for key in shown)) for name in CORPORA]
    unbound = sorted(((-count, key[8:]) for key, count in m.items() if key.startswith("unbound.")))
    warned = [f"{count} of `{key.replace('.', '` `')}`" for key, count in m.items() if ".BDDL" in key]
    notes = [
        f"Of the {m['behavior_files']} files of BEHAVIOR {m['behavior_files'] - m['behavior_tasks']} describe domains.",
        f"Files with a warning: {', '.join(warned)}.",
        f"Goals of BEHAVIOR by predicate without a binding: {', '.join(f'`{name}` {-n}' for n, name in unbound)}.",
    ]
    return f"{table(heads, rows)}\n\n{' '.join(notes)}"


def lsp_table(result: Result) -> str:
    """Keystrokes, those after which the file is Turtle, and the whole check that follows a pause."""
    m = result["metrics"]
    largest = max(row["ms"] for row in result["rows"] if row.get("parsed"))
    rows = [
        (shown, str(number), *(f"{ms:.1f}" for ms in times))
        for shown, number, *times in (
            ("keystroke to problems", m["keystrokes"], m["p50_ms"], m["p95_ms"], m["max_ms"]),
            ("of these, the file is Turtle", m["parsed"], m["parsed_p50_ms"], m["parsed_p95_ms"], largest),
        )
    ]
    if "all_p95_ms" in m:
        times = (f"{m[name]:.1f}" for name in ("all_p50_ms", "all_p95_ms", "all_max_ms"))
        rows.append(("keystroke to problems, semantic tokens and symbols", str(m["keystrokes"]), *times))
    whole = (str(m["whole_checks"]), f"{m['whole_p50_ms']:.1f}", "—", f"{m['whole_max_ms']:.1f}")
    rows.append(("whole check after a pause", *whole))
    return table(("what is timed", "n", "median ms", "95 % ms", "largest ms"), rows)


def fuzz_table(result: Result) -> str:
    """What went in, and what became of it."""
    m = result["metrics"]
    rows = [
        ("all", f"{m['inputs']:,}"),
        ("BDDL", f"{m['bddl']:,}"),
        ("past the lexer", f"{m['past_lexer_share']:.1%}"),
        ("Turtle through the whole of `onto check`", f"{m['checked']:,}"),
        ("without a problem", f"{m['clean']:,}"),
        ("ended in a traceback", str(m["tracebacks"])),
        ("took more than 2 s", str(m["hangs"])),
        ("with a problem that says no place", str(m["unplaced"])),
        ("laid out as another task", str(m["round_trip_failures"])),
    ]
    note = (
        f"{m['problems']:,} problems of {m['codes']} codes were reported. The longest input took "
        f"{m['worst_ms'] / 1000:.2f} s; the process never held more than {m['peak_mib']:.0f} MiB; "
        f"{m['crashed']} blocks crashed."
    )
    return f"{table(('damaged files', 'number'), rows)}\n\n{note}"


def conformance_table(result: Result) -> str:
    """One line per suite."""
    rows = []
    for begin, shown in {"core/": "W3C, SHACL Core", "sparql/": "W3C, SHACL-SPARQL", "http": "DASH, rules"}.items():
        cases = [row for row in result["rows"] if row["case"].startswith(begin)]
        rows.append((shown, str(len(cases)), str(sum(row.get("passed", False) for row in cases))))
    note = f"{result['metrics']['shacl_excepted']} cases are listed as exceptions."
    return f"{table(('suite', 'cases', 'passed'), rows)}\n\n{note}"


def compiler_table(result: Result) -> str:
    """One line per figure of the registry's run."""
    m = result["metrics"]
    rows = [
        ("registered tasks", f"{m['registry_tasks']:,}"),
        ("distinct files", f"{m['distinct_files']:,}"),
        ("tasks with an error / with a warning", f"{m['tasks_with_errors']} / {m['tasks_with_warnings']:,}"),
        ("required facts", f"{m['facts']:,}"),
        ("cold, two processes", f"{m['cold_s']:.1f} s"),
        ("warm", f"{m['warm_s']:.2f} s"),
        ("peak memory, all processes", f"{m['peak_mib']:.0f} MiB"),
        ("one file, one process", f"{m['ours_ms_per_file']:.2f} ms"),
        ("one file, the naive way", f"{m['naive_ms_per_file']:.0f} ms ({m['naive_ratio']:.0f} times as long)"),
    ]
    return table(("figure", "value"), rows)


def validator_table(result: Result) -> str:
    """One line per kind of damage; then the graph."""
    m = result["metrics"]
    heads = ("damage", "ABoxes", "records", "do not conform", "verdict differs", "results differ", "µs a record")
    names = ("aboxes", "records", "invalid", "mismatches", "results_differ")
    rows = [
        (row["kind"], *(str(row[name]) for name in names), f"{1e6 * row['validate_s'] / row['records']:.1f}")
        for row in result["rows"]
        if row["kind"] != "graph"
    ]
    rows.append(("all", *(str(m[name]) for name in names), f"{m['us_per_record']:.1f}"))
    graph = (
        f"A graph of {m['graph_triples']:,} triples: {m['graph_engine_s']:.2f} s by the engine of `onto check`, "
        f"{m['graph_pyshacl_s']:.1f} s by pySHACL, {m['graph_ratio']:.0f} times as long ({m['graph_plain_ratio']:.0f} "
        f"times as long as the record validator takes for the same graph). Of {m['graph_results']} results "
        f"{m['graph_mismatches']} differ."
    )
    return f"{table(heads, rows)}\n\n{graph}"
