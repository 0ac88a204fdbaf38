"""The user's own LIBERO objects, fixtures and predicates: modules that register them on import.

They are named on the command line (``--import``) or in the nearest ``pyproject.toml`` at or above the working folder::

    [tool.onto]
    imports = ["my_objects"]
"""

from __future__ import annotations

import importlib
import sys
import sysconfig
import tomllib
import traceback
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from types import ModuleType

from onto_compiler.problems import OntoError, Problem, near
from runtime.worlds.libero.simulator.native_import import control_env
from runtime.worlds.native_import import quiet

__all__ = ["import_own", "own_files", "place_of"]

_SHARED = tuple({str(Path(sysconfig.get_path(name)).resolve()) for name in ("stdlib", "purelib", "platlib")})
_INSTALLED = frozenset(("site-packages", "dist-packages"))  # of another environment that this one looks into, too
_PROJECT = "pyproject.toml"


def import_own(names: Sequence[str], beside: Path) -> None:
    """Import the modules ``names``, and those that the project lists, after LIBERO.

    They are looked for among what is installed, in the folder ``beside``, in the working folder, and in the project's.
    Raises ``SIM024`` if one is not there, or at the file and line of the error that its import raises.
    """
    project, listed = _listed(Path.cwd())
    wanted = tuple(dict.fromkeys((*listed, *names)))
    if not wanted:
        return
    control_env()  # configures LIBERO before it is imported
    for folder in (beside.resolve(), Path.cwd(), project):
        if str(folder) not in sys.path:
            sys.path.append(str(folder))  # last, so that no file there hides an installed module
    importlib.invalidate_caches()
    for name in wanted:
        _import(name, beside)


def _import(name: str, beside: Path) -> None:
    try:
        with quiet():
            importlib.import_module(name)
    except Exception as error:  # the user's own module may raise anything
        if isinstance(error, ModuleNotFoundError) and error.name == name:
            found = [path.stem for folder in (beside, Path.cwd()) for path in folder.glob("*.py")]
            hint = near(name, found) or "put it beside the task file or into the working folder, or install it"
            raise OntoError.of("SIM024", f"there is no module `{name}` to import", hint) from error
        file, line, column = place_of(error) or (name, 0, 0)
        message = f"`{name}` cannot be imported: {type(error).__name__}: {error}"
        raise OntoError(Problem(file, line, column, "SIM024", "error", message, "correct it there")) from error


def _listed(start: Path) -> tuple[Path, list[str]]:
    """The folder of the project around ``start``, and the modules that it lists; ``start`` and none without one."""
    file = next((f for f in (folder / _PROJECT for folder in (start, *start.parents)) if f.is_file()), None)
    if file is None:
        return start, []
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")).get("tool", {}).get("onto", {})
        names = table.get("imports", [])
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, AttributeError) as error:
        raise OntoError.of("SIM024", f"`{_PROJECT}` cannot be read: {error}", "correct it", str(file)) from error
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        hint = 'write a list of module names, such as imports = ["my_objects"]'
        raise OntoError.of("SIM024", "`imports` in `[tool.onto]` is not a list of module names", hint, str(file))
    return file.parent, names


def place_of(error: BaseException) -> tuple[str, int, int] | None:
    """File, line and column (from 1; 0 where unknown) in the user's own code where ``error`` arose, if it did."""
    if isinstance(error, SyntaxError) and error.filename is not None:
        return error.filename, error.lineno or 0, error.offset or 0
    frames = traceback.extract_tb(error.__traceback__)
    return next(((f.filename, f.lineno or 0, 0) for f in reversed(frames) if _is_own(f.filename)), None)


def own_files(classes: Iterable[type]) -> set[Path]:
    """The source files of ``classes``, and of the modules of your own that these have imported."""
    start = (sys.modules.get(base.__module__) for each in classes for base in each.__mro__)
    waiting, seen = [module for module in start if module is not None], set()
    while waiting:
        module = waiting.pop()
        file = getattr(module, "__file__", None)
        if file is None or not _is_own(file) or Path(file) in seen:
            continue
        seen.add(Path(file))
        waiting += _used(module)
    return seen


def _used(module: ModuleType) -> Iterator[ModuleType]:
    for value in list(vars(module).values()):
        found = value if isinstance(value, ModuleType) else sys.modules.get(getattr(value, "__module__", None) or "")
        if isinstance(found, ModuleType):
            yield found


def _is_own(file: str) -> bool:
    """Whether a file is neither of Python, nor of an installed package, nor of this one."""
    path = Path(file).resolve()
    ours = Path(__file__).resolve().parents[4]
    packages = ("ontology", "onto_compiler", "grounding", "runtime", "benchmarks")
    if any(path.is_relative_to(ours / package) for package in packages) or not _INSTALLED.isdisjoint(path.parts):
        return False
    return path.is_file() and not any(path.is_relative_to(folder) for folder in _SHARED)
