"""The table of how the tree is built."""

from __future__ import annotations

from typing import Any

from benchmarks.markdown import table

__all__ = ["house_table"]

_SAID = {
    "files_for_a_field": "files that one more field of a record touches, Turtle included",
    "files_for_a_world": "files outside its folder, its bindings and tests that name a world's tasks",
    "import_circles": "circles of imports, at run time or for types",
    "upward_imports": "imports against the order of the packages",
    "world_leaks": "imports of a world from outside it",
    "duplicate_definitions_of_satisfied": "parts that answer differently whether a fact holds",
    "suite_min": "minutes of the whole test suite on two processes",
    "core_env_mib": "MiB of an environment with the core installation alone",
    "demo_first_s": "seconds of the demo in a fresh environment",
    "demo_warm_s": "seconds of the demo when its scenes are cached",
}


def house_table(result: dict[str, Any]) -> str:
    """One line per figure."""
    metrics = result["metrics"]
    return table(("what", "figure"), ((text, f"{metrics[name]:g}") for name, text in _SAID.items() if name in metrics))
