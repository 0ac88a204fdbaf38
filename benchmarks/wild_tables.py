"""The tables of `onto check` on generated, damaged and large files, and on ontologies that others publish."""

from __future__ import annotations

from collections import Counter
from typing import Any

from benchmarks.markdown import table
from benchmarks.wild_corrections import CORRECTIONS

__all__ = ["corpora_table", "wild_table"]

Result = dict[str, Any]


def wild_table(result: Result) -> str:
    """Pairs by kind, the differences and why they are there, and what is timed."""
    m, rows = result["metrics"], [row for row in result["rows"] if "crashed" not in row]
    kinds: dict[str, Counter[str]] = {}
    for row in rows:
        if row["part"] == "pairs":
            tally = kinds.setdefault(row["kind"], Counter())
            tally.update({name: row[name] for name in ("pairs", "conform", "results", "differ")})
            tally["unexplained"] += len(row["unexplained"])
    names = ("pairs", "conform", "results", "differ", "unexplained")
    lines = [(kind, *(f"{tally[name]:,}" for name in names)) for kind, tally in kinds.items()]
    lines.append(
        ("all", *(f"{m[name]:,}" for name in ("pairs", "conform", "results", "differ", "unexplained_differences")))
    )
    heads = ("kind", "pairs", "conform", "results", "pySHACL differs", "unexplained")
    why = [
        (name, str(m[f"explained.{name}"]), one.says) for name, one in CORRECTIONS.items() if f"explained.{name}" in m
    ]
    reasons = table(("difference", "pairs", "who is right"), why)
    return "\n\n".join((table(heads, lines), reasons, _costs(m, rows)))


def _costs(m: dict[str, float], rows: list[dict[str, Any]]) -> str:
    sizes = {row["times"]: row for row in rows if row["part"] == "ontology"}
    (building,) = [row for row in rows if row["part"] == "building"]
    one, four = sizes[1], sizes[4]
    return (
        f"{m['runs']:,} runs, {sum(row['runs'] for row in rows if row['part'] == 'calls')} of them on calls for the "
        f"network and {sum(row['runs'] for row in rows if row['part'] == 'damaged')} on damaged files: "
        f"{m['connections']} connections, {m['tracebacks']} tracebacks. A made ontology of {one['terms']:,} terms "
        f"({one['triples']:,} triples) takes {one['cpu_s']:.1f} s of a processor and {one['peak_mib']:.0f} MiB, one of "
        f"{four['terms']:,} terms ({four['triples']:,} triples) {four['cpu_s']:.1f} s ({m['slope']:.2f} times as long) "
        f"and {four['peak_mib']:.0f} MiB ({m['mib_per_100k_triples']:.0f} MiB more per 100,000 triples), and "
        f"{m['cached_ratio']:.3f} of that time when nothing has changed. A made building of {building['triples']:,} "
        f"triples with Brick-like shapes takes {building['cpu_s']:.1f} s, and pySHACL {building['pyshacl_cpu_s']:.0f} "
        f"s, {m['vs_pyshacl']:.1f} times as long; of {building['results']} results {m['building_differ']} differ. "
        f"Times are of whole commands, their start included."
    )


def corpora_table(result: Result) -> str:
    """One line per corpus, then the codes."""
    rows = [row for row in result["rows"] if "crashed" not in row]
    heads = ("corpus", "commit", "files", "triples", "problems", "by code", "processor s", "MiB")
    lines = [
        (
            f"`{row['key']}`",
            f"`{row['commit'][:10]}`",
            *(f"{row[name]:,}" for name in ("files", "triples", "problems")),
            ", ".join(f"{number} {code}" for code, number in row["codes"].items()),
            f"{row['cpu_s']:.1f}",
            f"{row['peak_mib']:.0f}",
        )
        for row in rows
    ]
    return table(heads, lines)
