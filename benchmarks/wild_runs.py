"""What a whole command costs on a large file, in a process of its own: processor time, and memory at its peak."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

from pyoxigraph import RdfFormat, parse

from benchmarks.program import PROGRAM, spent
from benchmarks.wild_made import brick_shapes, building, ontology_text
from benchmarks.wild_pairs import read_report

__all__ = ["beside_pyshacl", "checked"]

_PYSHACL = (sys.executable, "-m", "pyshacl", "--advanced", "--inference", "none")


def checked(terms: int) -> dict[str, Any]:
    """``onto check`` on a made ontology, twice with the same cache, which is empty at first."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.ttl"
        path.write_text(ontology_text(terms), encoding="utf-8")
        command = [sys.executable, "-c", PROGRAM, "check", "--select", "VOC", str(path)]
        cache = {"XDG_CACHE_HOME": folder}
        first, second = (spent(command, cache) for _ in range(2))
        triples = sum(1 for _ in parse(path=path, format=RdfFormat.TURTLE))
    return {"triples": triples, **first, "again_cpu_s": second["cpu_s"]}


def beside_pyshacl(triples: int) -> dict[str, Any]:
    """A made building and its shapes, by ``onto check --shapes`` and by ``pyshacl``: results, and what each cost."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        data, shapes = folder / "data.ttl", folder / "shapes.ttl"
        data.write_text(building(triples), encoding="utf-8")
        shapes.write_text(brick_shapes(), encoding="utf-8")
        mine, theirs = folder / "ours.ttl", folder / "theirs.ttl"
        ours = [sys.executable, "-c", PROGRAM, "check", str(data), "--shapes", str(shapes), "--report", str(mine)]
        pyshacl = [*_PYSHACL, "--shacl", str(shapes), "--format", "turtle", "--output", str(theirs), str(data)]
        cost, their_cost = spent(ours, {}), spent(pyshacl, {})
        reports = [read_report(parse(path=path, format=RdfFormat.TURTLE)) for path in (mine, theirs)]
        number = sum(1 for _ in parse(path=data, format=RdfFormat.TURTLE))
    return {
        "triples": number,
        "results": len(reports[0].results),
        "differ": len(reports[0].results ^ reports[1].results),
        **cost,
        **{f"pyshacl_{key}": value for key, value in their_cost.items()},
    }
