"""What processes hold in memory, in MiB."""

from __future__ import annotations

import os
import re
import resource
import sys
from pathlib import Path

__all__ = ["held_mib", "peak_mib"]

_PEAK = re.compile(r"^VmHWM:\s*(\d+) kB$", re.MULTILINE)


def held_mib() -> float:
    """What this process holds: at present on Linux, at most so far elsewhere."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20
    return peak_mib()


def peak_mib(process: int | None = None) -> float:
    """The most that a process, by default this one, has held so far; 0 for another that has ended.

    On Linux from ``/proc``: the ``ru_maxrss`` of a process counts what its parent held when it was started.
    """
    try:
        found = _PEAK.search(Path(f"/proc/{process or 'self'}/status").read_text(encoding="utf-8"))
    except OSError:
        found = None
    if found is not None:
        return int(found[1]) / 1024
    if process is not None:
        return 0.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1024 * 1024 if sys.platform == "darwin" else 1024)
