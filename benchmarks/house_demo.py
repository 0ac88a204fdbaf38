"""How long ``onto demo`` takes a person: the first time, with nothing cached, and again."""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from benchmarks.program import onto

__all__ = ["demo_seconds"]

_CACHES = ("XDG_CACHE_HOME", "NUMBA_CACHE_DIR")


def demo_seconds() -> Mapping[str, float]:
    """Seconds of ``onto demo``, pictures included, from start to end of its process: ``demo_first_s``, ``demo_warm_s``.

    The first run has empty caches (scenes, compiled code, the renderer's shaders); the second has those of the first.
    ``demo_first_cpu_s`` and ``demo_warm_cpu_s`` are processor time, which a neighbour's load is not charged to.

    Raises:
        RuntimeError: where the demo broke off, with what it said, or drew no picture.
    """
    found: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        environment = {name: str(Path(folder) / name) for name in _CACHES}
        for name in ("first", "warm"):
            wall, cpu = _timed(Path(folder) / "demo", environment)
            found |= {f"demo_{name}_s": wall, f"demo_{name}_cpu_s": cpu}
    return found


def _timed(out: Path, environment: Mapping[str, str]) -> tuple[float, float]:
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = onto("demo", "--out", str(out), environment=environment)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in {0, 1}:
        raise RuntimeError(done.stderr.strip())
    if "no pictures" in done.stdout:
        raise RuntimeError(done.stdout.strip().splitlines()[-2])
    cpu = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return round(wall, 2), round(cpu, 2)
