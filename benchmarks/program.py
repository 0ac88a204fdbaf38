"""The ``onto`` program in a fresh process, as a person starts it."""

from __future__ import annotations

import subprocess
import sys

__all__ = ["onto"]

_PROGRAM = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"


def onto(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run ``onto`` with ``arguments`` to its end; its output is text."""
    command = [sys.executable, "-c", _PROGRAM, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603 - our own program
