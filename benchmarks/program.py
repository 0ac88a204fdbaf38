"""The ``onto`` program in a fresh process, as a person starts it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping

__all__ = ["PROGRAM", "as_a_person_has_it", "onto"]

PROGRAM = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"


def as_a_person_has_it(environment: Mapping[str, str] | None = None) -> dict[str, str]:
    """Our environment with ``environment`` added to it.

    Compiled bytecode is kept, as it is unless a person forbids it: else each run would compile all modules again.
    """
    own = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**own, **(environment or {})}


def onto(*arguments: str, environment: Mapping[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """Run ``onto`` with ``arguments`` to its end, with ``environment`` added to ours; its output is text."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    env = as_a_person_has_it(environment)
    return subprocess.run(command, capture_output=True, text=True, check=False, env=env)  # noqa: S603 - our own program
