"""Tables in README.md and pages of docs/, made from ``results/*.json``; with ``--check`` they are only compared.

A table stands between ``<!-- table: NAME -->`` and ``<!-- end -->``; NAME is a function of :data:`TABLES`.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.audit_tables import audit_table, suites_table, versions_table
from benchmarks.bddl import CORPORA
from benchmarks.grounding import KINDS
from benchmarks.results import RESULTS, read_result
from benchmarks.skills_tables import skills_table
from benchmarks.state_repair import METHODS, SUITES

__all__ = ["TABLES", "fill", "main"]

ROOT = Path(__file__).resolve().parent.parent
PAGES = ("README.md", "docs/audit.md", "docs/demos.md", "docs/results.md", "docs/skills.md")
_BLOCK = re.compile(r"(<!-- table: (?P<name>[\w.-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def demo(result: dict[str, Any]) -> str:
    """One line per task of the demo."""
    lines = [_row("task", "unmet fact", "margin", "failure", "route", "attempts", "settled"), _row(*["---"] * 7)]
    for row in result["rows"]:
        for number, found in enumerate(row["diagnoses"]):
            fact = f"`{found['predicate']}({', '.join(found['arguments'])})`"
            margin = "—" if found["margin"] is None else f"{found['margin']:+.3f} {found['unit']}"
            first = number == 0
            lines.append(
                _row(
                    row["task"].replace("_", " ") if first else "",
                    fact,
                    margin,
                    f"`{found['failure']}`",
                    f"`{found['route']}`",
                    str(row["attempts"]) if first else "",
                    ("yes" if row["settled"] else "no") if first else "",
                )
            )
    m = result["metrics"]
    total = (
        f"{m['accepted']} of {m['tasks']} accepted by the native predicate ({m['initially_true']} before any "
        f"correction), {m['settled']} still true after 20 control steps, {m['wall_s']:.0f} s in all. Mode `state`; "
        "the proposers see privileged simulator state."
    )
    return "\n".join([*lines, "", total, "", _origin(result)])


def state_repair(result: dict[str, Any]) -> str:
    """One line per suite and method."""
    lines = [
        _row("suite", "routes", "episodes", "accepted [95 %]", "settled [95 %]", "one attempt per fact", "attempts"),
        _row(*["---"] * 7),
    ]
    m = result["metrics"]
    for suite in (*SUITES, "all"):
        for method in METHODS:
            name = f"{method}.{suite}"
            lines.append(
                _row(
                    f"`{suite}`" if suite != "all" else "all",
                    {"typed": "by rule", "random_route": "at random"}[method],
                    str(m[f"{name}.n"]),
                    _rate(m, f"{name}.accepted"),
                    _rate(m, f"{name}.settled"),
                    f"{m[f'{name}.one_attempt_per_fact']:.3f}",
                    f"{m[f'{name}.attempts']:.2f}",
                )
            )
    share = m["typed.all.initially_true"]
    odd = Counter(
        f"`{r['suite']}` {r['task']}" for r in result["rows"] if r["method"] == "typed" and not r["premise_holds"]
    )
    premises = ", ".join(f"{count} of {task}" for task, count in sorted(odd.items()))
    note = (
        f"Without a correction the native predicate holds in {share:.1%} of the episodes; {m['crashed']} crashed. The "
        f"premise (the declared `:init`, after settling) was false in {odd.total()} episodes by rule: "
        f"{premises or 'none'}."
    )
    return "\n".join([*lines, "", note, "", _origin(result)])


def audit(result: dict[str, Any]) -> str:
    """See :func:`benchmarks.audit_tables.audit_table`."""
    return f"{audit_table(result)}\n\n{_origin(result)}"


def audit_suites(result: dict[str, Any]) -> str:
    """See :func:`benchmarks.audit_tables.suites_table`."""
    return f"{suites_table(result)}\n\n{_origin(result)}"


def audit_versions(result: dict[str, Any]) -> str:
    """See :func:`benchmarks.audit_tables.versions_table`."""
    return f"{versions_table(result)}\n\n{_origin(result)}"


def demos(result: dict[str, Any]) -> str:
    """One line per suite."""
    head = ("suite", "demonstrations", "trials", "median steps", "replayed natively to success at the same step")
    lines = [_row(*head), _row(*["---"] * len(head))]
    m = result["metrics"]
    for suite in dict.fromkeys(row["suite"] for row in result["rows"]):
        numbers = (f"{m[f'{suite}.{name}']:g}" for name in ("demos", "trials", "median_steps"))
        lines.append(_row(f"`{suite}`", *numbers, f"{m[f'{suite}.replayed_share']:.1%}"))
    total = (
        f"{m['demos']} of {m['wanted']} demonstrations of {m['tasks']} tasks; {m['recovered']} hold a recovery from a "
        f"failed try. The largest difference of a replay to a recorded state is {m['drift']:g}."
    )
    return "\n".join([*lines, "", total, "", _origin(result)])


def skills(result: dict[str, Any]) -> str:
    """See :func:`benchmarks.skills_tables.skills_table`; each suite may have been run apart."""
    parts = (
        f"`{name}`: `{part['command']}` at commit `{part['commit'][:12]}` on {part['date'][:10]}"
        for name, part in result["parts"].items()
    )
    return f"{skills_table(result)}\n\n{'; '.join(parts)}.\n\n{_origin(result)}"


def check(result: dict[str, Any]) -> str:
    """One line per timed command, then the broken files."""
    m = result["metrics"]
    lines = [_row("command", "runs", "median s", "largest s"), _row(*["---"] * 4)]
    for name, shown in (("check", "`onto check`"), ("help", "`onto --help`")):
        times = (f"{m[f'{name}_median_s']:.3f}", f"{m[f'{name}_max_s']:.3f}")
        lines.append(_row(shown, str(m[f"{name}_runs"]), *times))
    note = (
        f"The shipped ontology has {m['shipped_problems']} problems. Of {m['broken_files']} files that are broken in "
        f"one way each, {m['broken_exact']} are reported with exactly the expected code, line and column."
    )
    return "\n".join([*lines, "", note, "", _origin(result)])


def grounding(result: dict[str, Any]) -> str:
    """One line per grounding function."""
    m = result["metrics"]
    lines = [
        _row("grounded by", "states made for it", "true", "in LIBERO-Goal", "true", "µs a fact"),
        _row(*["---"] * 6),
    ]
    for kind in KINDS:
        time = m.get(f"all.{kind}.us_per_fact")
        lines.append(
            _row(
                f"`{kind}`",
                str(m[f"all.{kind}.states"]),
                f"{m[f'all.{kind}.true_share']:.0%}",
                str(m[f"goal.{kind}.states"]),
                f"{m[f'goal.{kind}.true_share']:.0%}",
                "—" if time is None else f"{time:.0f}",
            )
        )
    note = (
        f"{m['comparisons']} comparisons in {m['states']} states: {m['mismatches']} differences of truth, "
        f"{m['sign_violations']} margins of the wrong sign. In {m['near_true'] + m['near_false']} cases a term lay "
        f"within 1 mm or 1 mrad of its threshold, {m['near_true']} on the satisfied side and "
        f"{m['near_false']} on the other."
    )
    return "\n".join([*lines, "", note, "", _origin(result)])


def bddl(result: dict[str, Any]) -> str:
    """One line per corpus, one for each warning, and the predicates that nothing binds."""
    m = result["metrics"]
    lines = [
        _row("corpus", "files", "do not parse", "read back changed", "with alternatives", "written out", "lifted"),
        _row(*["---"] * 7),
    ]
    shown = ("files", "failed", "round_trip_failed", "with_alternatives", "written_out", "lifted")
    lines += [_row(f"`{name}`", *(str(m[f"{name}_{key}"]) for key in shown)) for name in CORPORA]
    unbound = sorted(((-count, key[8:]) for key, count in m.items() if key.startswith("unbound.")))
    warned = [f"{count} of `{key.replace('.', '` `')}`" for key, count in m.items() if ".BDDL" in key]
    notes = [
        f"Of the {m['behavior_files']} files of BEHAVIOR {m['behavior_files'] - m['behavior_tasks']} describe domains.",
        f"Files with a warning: {', '.join(warned)}.",
        f"Goals of BEHAVIOR by predicate without a binding: {', '.join(f'`{name}` {-n}' for n, name in unbound)}.",
    ]
    return "\n".join([*lines, "", " ".join(notes), "", _origin(result)])


def lsp(result: dict[str, Any]) -> str:
    """Keystrokes, those after which the file is Turtle, and the whole check that follows a pause."""
    m = result["metrics"]
    lines = [_row("what is timed", "n", "median ms", "95 % ms", "largest ms"), _row(*["---"] * 5)]
    parsed = [row["ms"] for row in result["rows"] if row.get("parsed")]
    for shown, number, *times in (
        ("keystroke to problems", m["keystrokes"], m["p50_ms"], m["p95_ms"], m["max_ms"]),
        ("of these, the file is Turtle", m["parsed"], m["parsed_p50_ms"], m["parsed_p95_ms"], max(parsed)),
    ):
        lines.append(_row(shown, str(number), *(f"{ms:.1f}" for ms in times)))
    lines.append(
        _row(
            "whole check after a pause",
            str(m["whole_checks"]),
            f"{m['whole_p50_ms']:.1f}",
            "—",
            f"{m['whole_max_ms']:.1f}",
        )
    )
    return "\n".join([*lines, "", _origin(result)])


def fuzz(result: dict[str, Any]) -> str:
    """What went in, and what became of it."""
    m = result["metrics"]
    lines = [_row("damaged files", "number"), _row("---", "---")]
    for shown, number in (
        ("all", f"{m['inputs']:,}"),
        ("BDDL", f"{m['bddl']:,}"),
        ("past the lexer", f"{m['past_lexer_share']:.1%}"),
        ("Turtle through the whole of `onto check`", f"{m['checked']:,}"),
        ("without a problem", f"{m['clean']:,}"),
        ("ended in a traceback", str(m["tracebacks"])),
        ("took more than 2 s", str(m["hangs"])),
        ("with a problem that says no place", str(m["unplaced"])),
        ("laid out as another task", str(m["round_trip_failures"])),
    ):
        lines.append(_row(shown, number))
    note = (
        f"{m['problems']:,} problems of {m['codes']} codes were told. The longest input took "
        f"{m['worst_ms'] / 1000:.2f} s; the process never held more than {m['peak_mib']:.0f} MiB; "
        f"{m['crashed']} blocks crashed."
    )
    return "\n".join([*lines, "", note, "", _origin(result)])


def conformance(result: dict[str, Any]) -> str:
    """One line per suite."""
    suites = {"core/": "W3C, SHACL Core", "sparql/": "W3C, SHACL-SPARQL", "http": "DASH, rules"}
    lines = [_row("suite", "cases", "passed"), _row(*["---"] * 3)]
    for begin, shown in suites.items():
        rows = [row for row in result["rows"] if row["case"].startswith(begin)]
        lines.append(_row(shown, str(len(rows)), str(sum(row.get("passed", False) for row in rows))))
    note = f"{result['metrics']['shacl_excepted']} cases are listed as exceptions."
    return "\n".join([*lines, "", note, "", _origin(result)])


def compiler(result: dict[str, Any]) -> str:
    """One line per figure of the registry's run."""
    m = result["metrics"]
    lines = [_row("figure", "value"), _row("---", "---")]
    for shown, value in (
        ("registered tasks", f"{m['registry_tasks']:,}"),
        ("distinct files", f"{m['distinct_files']:,}"),
        ("tasks with an error / with a warning", f"{m['tasks_with_errors']} / {m['tasks_with_warnings']:,}"),
        ("required facts", f"{m['facts']:,}"),
        ("cold, two processes", f"{m['cold_s']:.1f} s"),
        ("warm", f"{m['warm_s']:.2f} s"),
        ("peak memory, all processes", f"{m['peak_mib']:.0f} MiB"),
        ("one file, one process", f"{m['ours_ms_per_file']:.2f} ms"),
        ("one file, the naive way", f"{m['naive_ms_per_file']:.0f} ms ({m['naive_ratio']:.0f} times as long)"),
    ):
        lines.append(_row(shown, value))
    return "\n".join([*lines, "", _origin(result)])


def validator(result: dict[str, Any]) -> str:
    """One line per kind of damage; then the graph."""
    lines = [_row("damage", "ABoxes", "records", "do not conform", "verdict differs", "results differ", "µs a record")]
    lines.append(_row(*["---"] * 7))
    m = result["metrics"]
    names = ("aboxes", "records", "invalid", "mismatches", "results_differ")
    for row in result["rows"]:
        if row["kind"] != "graph":
            each = 1e6 * row["validate_s"] / row["records"]
            lines.append(_row(row["kind"], *(str(row[name]) for name in names), f"{each:.1f}"))
    lines.append(_row("all", *(str(m[name]) for name in names), f"{m['us_per_record']:.1f}"))
    graph = (
        f"A graph of {m['graph_triples']:,} triples: {m['graph_engine_s']:.2f} s by the engine of `onto check`, "
        f"{m['graph_pyshacl_s']:.1f} s by pySHACL, {m['graph_ratio']:.0f} times as long ({m['graph_plain_ratio']:.0f} "
        f"times as long as the record validator takes for the same graph). Of {m['graph_results']} results "
        f"{m['graph_mismatches']} differ."
    )
    return "\n".join([*lines, "", graph, "", _origin(result)])


def simulator(result: dict[str, Any]) -> str:
    """One line per task; then what has processes of its own."""
    m = result["metrics"]
    lines = [
        _row(
            *("task", "native steps/s", "exact", "compiled", "bare `mj_step`", "native set-up ms", "set-up ms"),
            *("`check_success` µs", "goal µs", "with margins µs", "largest qpos error"),
        ),
        _row(*["---"] * 11),
    ]
    for row in result["rows"]:
        if row["kind"] == "task":
            t = row["timing"]
            rates = (f"{t[f'{name}_steps_s']:.0f}" for name in ("native", "exact", "compiled", "physics"))
            setup = (f"{t['native_setup_ms']:.0f}", f"{t['setup_ms']:.2f}")
            goal = (f"{t['check_success_us']:.1f}", f"{t['grounding_us']:.2f}", f"{t['margins_us']:.0f}")
            lines.append(_row(f"`{row['key']}`", *rates, *setup, *goal, f"{row['parity_max_qpos_error']:.0e}"))
    note = (
        f"Medians over the tasks: the compiled loop takes {m['steps_ratio']:.1f} times as many control steps as the "
        f"native environment, and {m['physics_share']:.0%} of those of bare `mj_step`; a trial is set up "
        f"{m['setup_ratio']:,.0f} times as fast, in {m['setup_ms']:.2f} ms; grounding and diagnosis take "
        f"{m['grounding_share']:.2%} of a control step ({m['margins_share']:.1%} with margins), and "
        f"{m['grounding_vs_native']:.2f} of the time of `check_success`. A new process takes {m['first_step_s']:.2f} s "
        f"to its first step. Two processes scale {m['scaling_2']:.2f} times as well as two of bare `mj_step`. The "
        f"exact loop differs from the native environment by {m['exact_max_qpos_error']:g} in "
        f"{m['exact_steps_compared']:,} control steps, in {m['exact_held_steps']} of which a finger touches the "
        f"object; of {m['success_compared']} verdicts {m['success_mismatches']} differ. Over {m['memory_resets']} "
        f"resets and {m['memory_steps']:,} control steps a process grows by {m['memory_growth_mib']:.1f} MiB, with "
        f"{m['faults']:.0f} faults; {m['repeated_unequal']} repeated runs differ."
    )
    return "\n".join([*lines, "", note, "", _origin(result)])


TABLES: dict[str, Callable[[dict[str, Any]], str]] = {
    "audit": audit,
    "audit_versions": audit_versions,
    "audit_suites": audit_suites,
    "bddl": bddl,
    "check": check,
    "compiler": compiler,
    "conformance": conformance,
    "demo": demo,
    "demos": demos,
    "fuzz": fuzz,
    "grounding": grounding,
    "lsp": lsp,
    "simulator": simulator,
    "skills": skills,
    "state_repair": state_repair,
    "validator": validator,
}


def _rate(metrics: dict[str, float], name: str) -> str:
    return f"{metrics[name]:.3f} [{metrics[f'{name}.low']:.3f}, {metrics[f'{name}.high']:.3f}]"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _origin(result: dict[str, Any]) -> str:
    machine = result["machine"]
    versions = ", ".join(f"{name} {number}" for name, number in machine["versions"].items())
    return (
        f"Made by `{result['command']}` at commit `{result['commit'][:12]}` on {result['date'][:10]}, seed "
        f"{', '.join(map(str, result['seeds']))}; {machine['cpu']}, {machine['cores']} cores; {versions}."
    )


def fill(text: str) -> str:
    """``text`` with every table that has a result made anew."""

    def table(match: re.Match[str]) -> str:
        path = RESULTS / f"{match['name']}.json"
        body = TABLES[match["name"]](read_result(path)) if path.exists() else "Not measured yet."
        return f"{match[1]}{body}\n{match[3]}"

    return _BLOCK.sub(table, text)


def main(arguments: Sequence[str]) -> int:
    """Rewrite the pages, or with ``--check`` say which are stale."""
    stale = []
    for name in PAGES:
        path = ROOT / name
        before = path.read_text(encoding="utf-8")
        after = fill(before)
        if after != before:
            stale.append(name)
            if "--check" not in arguments:
                path.write_text(after, encoding="utf-8")
    if "--check" in arguments and stale:
        sys.stderr.write(f"stale: {', '.join(stale)}; run `make docs`\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
