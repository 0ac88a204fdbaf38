"""The ``onto`` program in a fresh process, as a person starts it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

from benchmarks.memory import peak_mib

__all__ = ["PROGRAM", "onto", "spent"]

PROGRAM = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"
_LOOK_S = 0.02  # between two looks at the memory of a command


def _as_a_person_has_it(environment: Mapping[str, str] | None = None) -> dict[str, str]:
    """Our environment with ``environment`` added to it.

    Compiled bytecode is kept, as it is unless a person forbids it: else each run would compile all modules again.
    """
    own = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**own, **(environment or {})}


def onto(*arguments: str, environment: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """Run ``onto`` with ``arguments`` to its end, with ``environment`` added to ours; its output is text."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    env = _as_a_person_has_it(environment)
    return subprocess.run(command, capture_output=True, text=True, check=False, env=env)  # noqa: S603 - our own program


def spent(command: list[str], environment: Mapping[str, str], output: Path | None = None) -> dict[str, float]:
    """Processor seconds and peak memory in MiB of one command, whatever it finds; its ``output`` goes to a file.

    Raises:
        RuntimeError: it could not run.
    """
    env = _as_a_person_has_it(environment)
    with (
        (output or Path(os.devnull)).open("wb") as out,
        subprocess.Popen(  # noqa: S603 - our own program
            command, env=env, stdout=out, stderr=subprocess.DEVNULL
        ) as child,
    ):
        peak = 0.0
        while not os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            peak = max(peak, peak_mib(child.pid))
            time.sleep(_LOOK_S)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in {0, 1}:  # findings are the rule
        raise RuntimeError(f"{command[-1]} ended with {child.returncode}")
    return {"cpu_s": round(usage.ru_utime + usage.ru_stime, 4), "peak_mib": round(peak, 1)}
