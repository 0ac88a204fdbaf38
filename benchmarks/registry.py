"""LIBERO-Plus's registry: 10,030 task names, and the task file that each one stands for.

A name is a task's name, followed for most by what is perturbed. Only moved and added objects have files of their own;
the other names stand for the file of the task that they perturb.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.archives import CACHE, fetch
from benchmarks.bddl_corpora import LIBERO_PLUS, PLUS, corpus

__all__ = ["SUITES", "Registered", "registry"]

SUITES: Mapping[str, int] = {"libero_spatial": 2_402, "libero_object": 2_518, "libero_goal": 2_591, "libero_10": 2_519}
_MAP = "liberoplus/liberoplus/benchmark"
_PERTURBED = re.compile(
    r"(_(table|tb)_\d+|_light_\d+|_language_\d+|_add_\d+|_level\w+_sample\d+|_noise_\d+"
    r"|_view(_-?\d+)+_initstate_\d+(_noise_\d+)?|_initstate_\d+)*"
)


@dataclass(frozen=True, slots=True)
class Registered:
    """One name of the registry; ``file`` is None if no task file fits, ``known`` where its suffix is understood."""

    suite: str
    name: str
    file: Path | None
    known: bool


def registry(cache: Path = CACHE) -> tuple[Registered, ...]:
    """Every registered task of the four suites, in the registry's order.

    Raises:
        OntoError: BEN003 if the archive cannot be had.
        RuntimeError: where a suite has another number of names than :data:`SUITES` says.
    """
    root, files = corpus(LIBERO_PLUS, cache)
    stems: dict[str, dict[str, Path]] = {}
    for file in files:
        stems.setdefault(file.parent.relative_to(root).parts[0], {})[file.stem] = file
    names = _names(fetch(*PLUS[:3], _MAP, cache=cache) / "libero_suite_task_map.py")
    found = []
    for suite, size in SUITES.items():
        if len(names[suite]) != size:
            raise RuntimeError(f"{len(names[suite])} tasks of {suite} found, {size} expected")
        found += [_resolve(suite, name, stems[suite]) for name in names[suite]]
    return tuple(found)


def _names(path: Path) -> dict[str, list[str]]:
    """The suites' names; the registry keeps them as a literal, which is read and never run."""
    for statement in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.Assign) and getattr(statement.targets[0], "id", "") == "libero_task_map":
            value: dict[str, list[str]] = ast.literal_eval(statement.value)
            return value
    raise RuntimeError(f"{path.name} holds no `libero_task_map`")


def _resolve(suite: str, name: str, files: Mapping[str, Path]) -> Registered:
    """The file whose name is the longest start of ``name``; what is left over must be perturbations."""
    words = name.split("_")
    for length in range(len(words), 0, -1):
        stem = "_".join(words[:length])
        if stem in files:
            rest = name.removeprefix(stem)
            return Registered(suite, name, files[stem], _PERTURBED.fullmatch(rest) is not None)
    return Registered(suite, name, None, known=False)
