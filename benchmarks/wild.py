"""``onto check`` on files that nobody chose: made shapes and data beside pySHACL, calls for the network, damage, size.

Pairs: generated shapes and data (:mod:`benchmarks.wild_shapes`), each validated by ``onto check --shapes`` and by
pySHACL, whose verdicts and results are equal but for differences that :mod:`benchmarks.wild_corrections` lists. Calls:
every command that takes a query, a shape or an import, while a server on this machine counts connections. Damage: the
same files cut off, with bytes changed and tokens moved. Size: made files in processes of their own.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.protocol import Protocol, Row, Trial

__all__ = ["WILD"]

PAIRS, BLOCK = {True: 200, False: 2}, 25  # of each kind; at most so many in a trial
DAMAGED, AT_ONCE = {True: 600, False: 20}, 50
TERMS = {True: 10_000, False: 500}  # of the smaller of two ontologies; the other has four times as many
TRIPLES = {True: 100_000, False: 1_000}
FOUR = 4
INTERNAL = 70  # the exit code of a fault of ours


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Blocks of pairs by kind, the calls, blocks of damaged files, and what is timed."""
    from benchmarks.wild_shapes import KINDS  # noqa: PLC0415 - only where it is run

    found: list[Trial] = []
    for place, kind in enumerate(KINDS):
        for first in range(0, PAIRS[full], BLOCK):
            numbers = [place + len(KINDS) * n for n in range(first, min(first + BLOCK, PAIRS[full]))]
            found.append({"key": f"pairs/{kind}/{first}", "part": "pairs", "kind": kind, "numbers": numbers})
    found.append({"key": "calls", "part": "calls", "most": 1_000 if full else 4})
    for first in range(0, DAMAGED[full], AT_ONCE):
        last = min(first + AT_ONCE, DAMAGED[full])
        found.append({"key": f"damaged/{first}", "part": "damaged", "first": first, "last": last})
    found += [
        {"key": f"ontology/{times}", "part": "ontology", "times": times, "terms": times * TERMS[full]}
        for times in (1, FOUR)
    ]
    return [*found, {"key": "building", "part": "building", "at_least": TRIPLES[full]}]


def run(trial: Trial) -> list[Row]:
    """One row."""
    from benchmarks.wild_runs import beside_pyshacl, checked  # noqa: PLC0415 - pySHACL waits for its run

    match trial["part"]:
        case "pairs":
            row = _pairs(trial["numbers"])
        case "calls":
            row = _calls(trial["most"])
        case "damaged":
            row = _damaged(trial["first"], trial["last"])
        case "ontology":
            row = checked(trial["terms"])
        case _:
            row = beside_pyshacl(trial["at_least"])
    return [{"mode": "none", "sees": "none", **row}]


def _pairs(numbers: Sequence[int]) -> Row:
    from benchmarks.wild_pairs import compare  # noqa: PLC0415 - as above
    from benchmarks.wild_shapes import pair  # noqa: PLC0415

    tally, explained = Counter[str](), Counter[str]()
    unexplained, fell = list[dict[str, object]](), list[dict[str, object]]()
    for number in numbers:
        with tempfile.TemporaryDirectory() as folder:
            try:
                found = compare(pair(number), Path(folder))
            except Exception as error:  # noqa: BLE001 - an exception of ours is what is counted
                fell.append({"number": number, "error": f"{type(error).__name__}: {error}"})
                continue
        tally["results"] += len(found.ours.results)
        tally["conform"] += found.ours.conforms
        tally["refused"] += bool(found.ours.refused)
        tally["differ"] += bool(found.explained or found.unexplained)
        explained.update(found.explained)
        if found.unexplained:
            unexplained.append({"number": number, "difference": list(found.unexplained)})
    counted = {name: tally[name] for name in ("results", "conform", "refused", "differ")}
    return {
        "pairs": len(numbers),
        **counted,
        "explained": dict(sorted(explained.items())),
        "unexplained": unexplained,
        "runs": len(numbers),
        "tracebacks": len(fell),
        "fell": fell,
    }


def _calls(most: int) -> Row:
    from benchmarks.listening import listening  # noqa: PLC0415 - as above
    from benchmarks.network_calls import calls  # noqa: PLC0415
    from benchmarks.wild_damage import run_quietly  # noqa: PLC0415

    codes = []
    with listening() as (url, made):
        for call in list(calls(url))[:most]:
            files = {name: text.encode() for name, text in call.files.items()}
            with tempfile.TemporaryDirectory() as folder:
                codes.append(run_quietly(files, tuple(call.words), Path(folder))[0])
        connections = len(made)
    return {"runs": len(codes), "connections": connections, "tracebacks": codes.count(INTERNAL)}


def _damaged(first: int, last: int) -> Row:
    from benchmarks.wild_damage import damaged, run_quietly  # noqa: PLC0415 - as above

    codes, fell = Counter[int](), list[dict[str, object]]()
    for number in range(first, last):
        with tempfile.TemporaryDirectory() as folder:
            code, said = run_quietly(*damaged(number), Path(folder))
        codes[code] += 1
        if code == INTERNAL:
            fell.append({"number": number, "error": said.strip().splitlines()[0]})
    exits = {str(code): number for code, number in sorted(codes.items())}
    return {"runs": last - first, "exits": exits, "tracebacks": len(fell), "fell": fell}


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Sums over pairs, calls and damage; of what is timed, ratios."""
    whole = [row for row in rows if "crashed" not in row]
    pairs = [row for row in whole if row["part"] == "pairs"]
    found: dict[str, float] = {
        name: sum(row[name] for row in pairs) for name in ("pairs", "results", "conform", "refused", "differ")
    }
    explained = Counter[str]()
    for row in pairs:
        explained.update(row["explained"])
    found["unexplained_differences"] = sum(len(row["unexplained"]) for row in pairs)
    found |= {f"explained.{name}": number for name, number in sorted(explained.items())}
    found["connections"] = sum(row["connections"] for row in whole if row["part"] == "calls")
    found["runs"] = sum(row.get("runs", 0) for row in whole)
    found["tracebacks"] = sum(row.get("tracebacks", 0) for row in whole)
    sizes = {row["times"]: row for row in whole if row["part"] == "ontology"}
    if sizes.keys() == {1, FOUR}:
        small, large = sizes[1], sizes[FOUR]
        grown = (large["peak_mib"] - small["peak_mib"]) / (large["triples"] - small["triples"])
        found["slope"] = large["cpu_s"] / small["cpu_s"]
        found["mib_per_100k_triples"] = 1e5 * grown
        found["cached_ratio"] = large["again_cpu_s"] / large["cpu_s"]
    for row in whole:
        if row["part"] == "building":
            found["building_differ"] = row["differ"]
            found["vs_pyshacl"] = row["pyshacl_cpu_s"] / row["cpu_s"]
    return {**found, "crashed": len(rows) - len(whole)}


def _timed(trial: Trial) -> bool:
    return trial["part"] in {"ontology", "building"}


WILD = Protocol(
    name="wild",
    help="`onto check` on generated shapes beside pySHACL, on calls for the network, on damaged and on large files",
    seeds=(0,),
    trials=trials,
    run=run,
    metrics=metrics,
    alone=_timed,
    timed=frozenset({"cpu_s", "peak_mib", "again_cpu_s", "pyshacl_cpu_s", "pyshacl_peak_mib"}),
)
