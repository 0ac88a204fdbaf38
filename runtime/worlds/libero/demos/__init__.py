"""Demonstrations: collected from skills, stored in LIBERO's own HDF5 layout, replayed natively.

:func:`load` reads them. It is imported on first use, so that ``onto --help`` stays quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runtime.worlds.libero.demos.read import load
    from runtime.worlds.libero.demos.records import DemoFile, Demonstration, Origin

__all__ = ["DemoFile", "Demonstration", "Origin", "load"]


def __getattr__(name: str) -> Any:  # noqa: ANN401  whatever is asked for
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{'read' if name == 'load' else 'records'}"), name)
