"""What the modules of this project import, read from their text and never run, held against the rules of its layout.

Every import counts, whether it runs with its module, waits in a function, or stands under ``TYPE_CHECKING``: a module
that cannot be understood without another depends on it. The rules are in ``docs/worlds.md``.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from runtime.worlds.world import TaskRef, world_named

__all__ = ["LAYERS", "Import", "import_circles", "imports", "naming_tasks_of", "upward_imports", "world_leaks"]

LAYERS = ("ontology", "onto_compiler", "grounding", "runtime", "benchmarks")
"""The packages, each of which imports itself and those before it."""
WORLDS = "runtime.worlds"
SIMULATORS = {"libero": {"libero"}, "robosuite": {"libero", "robosuite"}}
"""Packages that only some worlds import, and which those are."""
_TEXTS = {".py", ".ttl", ".bddl", ".rq"}
_ROOT = Path(__file__).parents[1]


@dataclass(frozen=True, slots=True, order=True)
class Import:
    """``module`` imports ``target`` in its line ``line``; both are names with dots."""

    module: str
    target: str
    line: int

    def __str__(self) -> str:
        return f"{self.module}:{self.line} imports {self.target}"


def imports(root: Path = _ROOT) -> tuple[Import, ...]:
    """Every import of the modules of :data:`LAYERS` below the folder ``root``, in their order.

    ``from package import name`` imports ``package.name`` where that is a module. A module that is loaded by a name in
    a string (``importlib.import_module("libero")``) is imported too.
    """
    modules = _modules(root)
    return tuple(found for name, path in modules.items() for found in sorted(set(_of_module(name, path, modules))))


def import_circles(found: Sequence[Import] | None = None) -> list[str]:
    """The circles of imports, each as its modules in order of their names: ``a <-> b <-> c``."""
    return [" <-> ".join(each) for each in _components(_edges(imports() if found is None else found))]


def upward_imports(found: Sequence[Import] | None = None) -> list[str]:
    """The imports of a package from one that stands above it in :data:`LAYERS`."""
    order = {name: number for number, name in enumerate(LAYERS)}
    return [
        str(each)
        for each in (imports() if found is None else found)
        if order.get(_top(each.target), 0) > order[_top(each.module)]
    ]


def world_leaks(found: Sequence[Import] | None = None) -> list[str]:
    """The imports of a world, or of its simulator, from outside it and outside ``benchmarks``.

    A world is a folder of ``runtime/worlds``; what stands beside the folders is shared, and imports none of them.
    """
    return [str(each) for each in (imports() if found is None else found) if _leaks(each)]


def naming_tasks_of(world: str) -> list[str]:
    """The files of :data:`LAYERS` that name a task of ``world``, outside its own folder and the bindings.

    A task is named by its name in quotation marks, by ``SUITE/NAME`` or ``SUITE/INDEX``, or as a problem. Raises
    ``RUN015``, ``SIM010`` if the world cannot say its tasks.
    """
    found = world_named(world)
    refs = [ref for suite in found.suites() for ref in found.tasks(suite)]
    suites, names = (
        "|".join(sorted({re.escape(each) for each in kind})) for kind in zip(*map(_names, refs), strict=True)
    )
    named = re.compile(rf"""["']({names})["']|(?<![\w/])({suites})/({names}|\d+)(?![\w.])|\bproblem ({names})\b""")
    own = (f"{WORLDS.replace('.', '/')}/{world}/", "ontology/bindings/")
    texts = sorted(path for layer in LAYERS for path in (_ROOT / layer).rglob("*") if path.suffix in _TEXTS)
    places = {path.relative_to(_ROOT).as_posix(): path for path in texts}
    return [
        place
        for place, path in places.items()
        if not place.startswith(own) and named.search(path.read_text(encoding="utf-8"))
    ]


def _names(ref: TaskRef) -> tuple[str, str]:
    return ref.suite, ref.name


def _leaks(each: Import) -> bool:
    if _top(each.module) == "benchmarks":
        return False
    here, there, package = _world(each.module), _world(each.target), _top(each.target)
    return here != there if there else package in SIMULATORS and here not in SIMULATORS[package]


def _world(module: str) -> str:
    """The world that ``module`` belongs to; empty for none. Shared modules stand beside the worlds' folders."""
    rest = module.removeprefix(f"{WORLDS}.") if module.startswith(f"{WORLDS}.") else ""
    name = rest.partition(".")[0]
    return name if name and (_ROOT.joinpath(*WORLDS.split("."), name)).is_dir() else ""


def _top(module: str) -> str:
    return module.partition(".")[0]


def _modules(root: Path) -> dict[str, Path]:
    paths = sorted(path for layer in LAYERS for path in (root / layer).rglob("*.py"))
    return {".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path for path in paths}


def _of_module(name: str, path: Path, modules: Mapping[str, Path]) -> Iterator[Import]:
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        match node:
            case ast.Import(names=names):
                yield from (Import(name, each.name, node.lineno) for each in names)
            case ast.ImportFrom(module=module, names=names, level=level):
                above = ".".join(package.split(".")[: len(package.split(".")) - level + 1]) if level else ""
                source = ".".join(part for part in (above, module) if part)
                for each in names:
                    inner = f"{source}.{each.name}"
                    yield Import(name, inner if inner in modules else source, node.lineno)
            case ast.Call(func=ast.Attribute(attr="import_module"), args=[ast.Constant(value=str(target)), *_]):
                yield Import(name, target, node.lineno)


def _edges(found: Sequence[Import]) -> dict[str, set[str]]:
    edges: dict[str, set[str]] = {each.module: set() for each in found}
    for each in found:
        if each.target in edges and each.target != each.module:
            edges[each.module].add(each.target)
    return edges


def _components(edges: Mapping[str, set[str]]) -> list[list[str]]:
    """The strongly connected components with more than one member: what reaches each other."""
    reach = {name: _reached(edges, name) for name in edges}
    circles = {tuple(sorted(other for other in reach[name] if name in reach[other])) for name in edges}
    return [list(circle) for circle in sorted(circles) if len(circle) > 1]


def _reached(edges: Mapping[str, set[str]], start: str) -> set[str]:
    seen: set[str] = set()
    todo = [start]
    while todo:
        for name in edges[todo.pop()] - seen:
            seen.add(name)
            todo.append(name)
    return seen
