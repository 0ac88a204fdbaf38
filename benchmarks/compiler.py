"""Compiling and validating the 10,030 tasks that LIBERO-Plus registers: cold, with a warm cache, and the naive way.

Each distinct file is parsed, linted, lifted to its required ABox, written as RDF and held to the SHACL shapes by the
record validator. Each name is resolved to its file, and its verdict is that file's. The naive way, on a sample in the
same run: the scanner of the ``bddl`` package as LIBERO calls it, rdflib, and pySHACL for each task.
"""

from __future__ import annotations

import random
import resource
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import ontology
from benchmarks.protocol import Protocol, Row, Trial
from benchmarks.registry import Registered, registry
from onto_compiler.batch import FileResult, compile_files
from onto_compiler.bddl import lift, parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.rdf import BASE
from onto_compiler.required_rdf import required_quads

__all__ = ["COMPILER"]

SEED = 0
SAMPLE = {True: 200, False: 5}
JOBS = 2
_KIND = {"mode": "none", "sees": "none"}


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """One trial: the phases share the registry and follow each other."""
    return [{"key": "registry", "full": full}]


def run(trial: Trial) -> list[Row]:
    """One row per registered name, and one per phase with its seconds."""
    tasks = registry()  # downloads the archive where it is not there yet, before anything is timed
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        cold, verdicts = _timed(cache)
        warm, again = _timed(cache)
    if verdicts != again:
        raise RuntimeError("a warm cache gave other verdicts than compiling did")
    rng = random.Random(SEED)  # noqa: S311 - a sample, no secret
    sample = rng.sample(sorted({task.file for task in tasks if task.file}), SAMPLE[trial["full"]])
    phases = [
        {"phase": "cold", "wall_s": cold, "peak_mib": _peak_mib()},
        {"phase": "warm", "wall_s": warm},
        {"phase": "ours", "wall_s": _ours(sample), "files": len(sample)},
        {"phase": "naive", "wall_s": _naive(sample), "files": len(sample)},
    ]
    names = [_named(task, verdicts) for task in tasks]
    return [{**_KIND, **row} for row in (*phases, *names)]


def _timed(cache: Path) -> tuple[float, dict[Path, FileResult]]:
    """The whole job as one command does it, reading the registry included: seconds, and the verdict of each file."""
    started = time.perf_counter()
    files = sorted({task.file for task in registry() if task.file is not None})
    verdicts = compile_files(files, jobs=JOBS, cache=cache).verdicts
    return time.perf_counter() - started, {file: replace(verdict, cached=False) for file, verdict in verdicts.items()}


def _named(task: Registered, verdicts: Mapping[Path, FileResult]) -> Row:
    verdict = verdicts[task.file] if task.file is not None else FileResult()
    codes = {
        severity: [problem.code for problem in verdict.problems if problem.severity == severity]
        for severity in ("error", "warning")
    }
    return {
        "name": f"{task.suite}/{task.name}",
        "file": f"{task.suite}/{task.file.stem}" if task.file else None,
        "facts": verdict.facts,
        "errors": codes["error"] + ["no file"] * (task.file is None) + ["unknown perturbation"] * (not task.known),
        "warnings": codes["warning"],
    }


def _ours(sample: Sequence[Path]) -> float:
    """Seconds for ``sample`` in this one process, without a cache, everything loaded."""
    compile_files(sample[:1])
    started = time.perf_counter()
    compile_files(sample)
    return time.perf_counter() - started


def _naive(sample: Sequence[Path]) -> float:
    """Seconds for ``sample`` by the scanner of the ``bddl`` package, rdflib and pySHACL, in this one process."""
    import pyshacl  # noqa: PLC0415 - only this phase needs them
    from bddl.parsing import scan_tokens  # noqa: PLC0415
    from rdflib import Graph  # noqa: PLC0415

    background, shapes = Graph(), Graph()
    for path in ontology.turtle_files():
        (shapes if path.parent.name == "shapes" else background).parse(path)
    schema = load_schema()
    aboxes = [lift(parse_file(file), schema, file.stem)[0] for file in sample]
    texts = [
        "\n".join(f"{q.subject} {q.predicate} {q.object} ." for q in required_quads(abox, schema, f"{BASE}run/naive"))
        for abox in aboxes
    ]
    started = time.perf_counter()
    for file, text in zip(sample, texts, strict=True):
        scan_tokens(filename=str(file))
        graph = Graph().parse(data=text, format="nt")
        pyshacl.validate(graph, shacl_graph=shapes, ont_graph=background, inference="none")
    return time.perf_counter() - started


def _peak_mib() -> float:
    """The largest resident size of this process and of its workers, as if all peaked at once."""
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    worker = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    return round((own + JOBS * worker) / 1024, 1)


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """Counts over names and files, and the seconds of each phase."""
    phases = {row["phase"]: row for row in rows if "phase" in row}
    names = [row for row in rows if "name" in row]
    crashed = sum("crashed" in row for row in rows)
    if not {"cold", "warm", "ours", "naive"} <= set(phases):
        return {"registry_tasks": len(names), "crashed": crashed}
    return {
        "registry_tasks": len(names),
        "distinct_files": len({row["file"] for row in names}),
        "tasks_with_errors": sum(bool(row["errors"]) for row in names),
        "tasks_with_warnings": sum(bool(row["warnings"]) for row in names),
        "facts": sum(row["facts"] for row in names),
        "cold_s": phases["cold"]["wall_s"],
        "warm_s": phases["warm"]["wall_s"],
        "peak_mib": phases["cold"]["peak_mib"],
        "naive_ratio": phases["naive"]["wall_s"] / phases["ours"]["wall_s"],
        "ours_ms_per_file": 1000 * phases["ours"]["wall_s"] / phases["ours"]["files"],
        "naive_ms_per_file": 1000 * phases["naive"]["wall_s"] / phases["naive"]["files"],
        "crashed": crashed,
    }


COMPILER = Protocol(
    name="compiler",
    help="compile and validate the 10,030 tasks that LIBERO-Plus registers: cold, warm, and the naive way",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
    timed=frozenset({"wall_s", "peak_mib"}),
)
