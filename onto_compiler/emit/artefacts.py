"""Which generated files a project keeps: the table ``[tool.onto.schema]`` of its ``pyproject.toml``.

Each output names its file; ``ontology`` may name Turtle files or folders of the project's own, as ``--ontology`` does::

    [tool.onto.schema]
    ontology = ["kitchen.ttl"]
    shacl = "generated/shapes.ttl"
    python = "kitchen/predicates.py"
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from onto_compiler.emit import OUTPUTS, emit
from onto_compiler.emit.tbox import TBox
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.sources import collect

__all__ = ["Artefact", "Settings", "find_settings", "fresh", "sources_of", "write_text"]

_TABLE = "[tool.onto.schema]"
_EXAMPLE = f'add a table such as `{_TABLE}` with `shacl = "generated/shapes.ttl"`'


@dataclass(frozen=True, slots=True)
class Artefact:
    """One generated file."""

    output: str
    path: Path


@dataclass(frozen=True, slots=True)
class Settings:
    """``ontology`` and the artefacts' paths are absolute; ``root`` is the folder of the ``pyproject.toml``."""

    root: Path
    ontology: tuple[Path, ...]
    artefacts: tuple[Artefact, ...]


def find_settings(start: Path) -> Settings:
    """Read the table in the nearest ``pyproject.toml`` at or above ``start``.

    Raises:
        OntoError: SCH002 if there is none, or it says something else than is meant above.
    """
    file = next((f for f in (folder / "pyproject.toml" for folder in (start, *start.parents)) if f.is_file()), None)
    if file is None:
        raise OntoError.of("SCH002", f"no `pyproject.toml` in `{start.name}` or above it", _EXAMPLE)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8")).get("tool", {}).get("onto", {}).get("schema")
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, AttributeError) as error:
        raise OntoError.of("SCH002", f"`{file.name}` cannot be read: {error}", "correct it", str(file)) from error
    if not isinstance(table, dict) or not set(table) - {"ontology"}:
        raise OntoError.of("SCH002", f"`{file.name}` has no table `{_TABLE}` that names a file", _EXAMPLE, str(file))
    return _settings(file, table)


def _settings(file: Path, table: dict[str, Any]) -> Settings:
    problems = []
    for key, value in table.items():
        if key == "ontology":
            wrong = not isinstance(value, list) or not all(isinstance(one, str) for one in value)
            fault, hint = "is not a list of paths", "write a list of Turtle files or folders"
        elif key not in OUTPUTS:
            wrong, fault = True, "is no output of `onto schema`"
            hint = near(key, OUTPUTS) or f"the outputs are {', '.join(OUTPUTS)}"
        else:
            wrong, fault, hint = not isinstance(value, str), "is no path", "write the path of the file to generate"
        if wrong:
            problems.append(Problem(str(file), 0, 0, "SCH002", "error", f"`{key}` in `{_TABLE}` {fault}", hint))
    if problems:
        raise OntoError(*problems)
    root = file.parent
    sources = tuple(root / path for path in table.get("ontology", ()))
    artefacts = tuple(Artefact(output, root / table[output]) for output in OUTPUTS if output in table)
    used = {path.resolve(): "ontology" for path in sources}
    for one in artefacts:
        other = used.setdefault(one.path.resolve(), one.output)
        if other != one.output:
            fault = f"`{one.output}` in `{_TABLE}` names `{table[one.output]}`, as `{other}` does"
            problems.append(Problem(str(file), 0, 0, "SCH002", "error", fault, "give each a file of its own"))
    if problems:
        raise OntoError(*problems)
    return Settings(root, sources, artefacts)


def sources_of(settings: Settings) -> tuple[Path, ...]:
    """The Turtle files that the table names, without generated ones in their folders, which would feed themselves.

    Raises:
        OntoError: TTL002 if one does not exist, or a folder holds no Turtle.
    """
    generated = {artefact.path.resolve() for artefact in settings.artefacts}
    return tuple(path for path in collect(settings.ontology) if path.resolve() not in generated)


def fresh(artefact: Artefact, tbox: TBox) -> str:
    """``fresh``, ``stale`` or ``missing``: how the file compares with what would be generated now."""
    try:
        text = artefact.path.read_bytes()
    except OSError:
        return "missing"
    return "fresh" if text == emit(artefact.output, tbox).encode() else "stale"


def write_text(path: Path, text: str) -> None:
    """Write UTF-8, byte for byte the same on every system; missing folders are made.

    Raises:
        OntoError: SCH004 if the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
    except OSError as error:
        message = f"cannot write `{path.name}`: {error.strerror or error}"
        raise OntoError.of("SCH004", message, "give a path that can be written", str(path)) from error
