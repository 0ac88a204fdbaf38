"""The files of a package that adds a predicate with all that it takes to measure and to repair it, and parts of it.

The templates are the files of the package `in_line`: another name takes the place of that one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

from onto_compiler.scaffold.names import WordedName, read_name
from onto_compiler.scaffold.turtle import added, new_ontology
from onto_compiler.scaffold.values import Options

__all__ = ["entry_point", "module", "package"]

_DEFINITION = "Holds when the origins of both arguments differ by no more than 1 cm along y."
_FILES = {
    "pyproject.toml": "pyproject.toml.txt",
    "{name}/__init__.py": "init.py.txt",
    "{name}/grounding.py": "grounding_2.py.txt",
    "{name}/proposer.py": "proposer.py.txt",
    "{name}/{name}.bddl": "task.bddl.txt",
    "tests/test_{name}.py": "test.py.txt",
}


def module(kind: str, name: WordedName, arity: int = 2) -> str:
    """A Python module with a grounding function of ``arity`` names, or with the proposer of the route ``name``."""
    return _filled(f"grounding_{arity}.py.txt" if kind == "grounding" else "proposer.py.txt", name, name.snake)


def entry_point(kind: str, name: WordedName) -> str:
    """The lines of ``pyproject.toml`` that register what :func:`module` holds, in a file that is called ``name``."""
    group, member = ("groundings", name.snake) if kind == "grounding" else ("proposers", f"{name.camel}Proposer")
    return f'[project.entry-points."onto_evwm.{group}"]\n{name.snake} = "{name.snake}:{member}"\n'


def package(name: WordedName, options: Options, folder: Path) -> Iterator[tuple[Path, str]]:
    """The files of the package ``name`` in ``folder``, with their texts.

    Raises:
        OntoError: NEW005 if the given IRI is none that an ontology can have.

    """
    missing = read_name(f"{name.snake}_missing")
    for file, template in _FILES.items():
        yield folder / file.format(name=name.snake), _filled(template, name, f"{missing.snake}_route")
    turtle = folder / name.snake / f"{name.snake}.ttl"
    text = added("failure", missing, turtle, new_ontology(name, options), options)
    text = added("grounding", name, turtle, text, options)
    (own,) = re.findall(rf"(?m)^(\w+):{missing.camel} a owl:Class", text)
    predicate = Options(kind=f"{own}:{missing.camel}Relation", grounded_by=name.snake, definition=_DEFINITION)
    text = added("predicate", name, turtle, text, predicate)
    binding = Options(lifts=f"{own}:{name.snake}", native=name.camel)
    yield turtle, added("binding", read_name(f"{name.snake}_atom"), turtle, text, binding)


def _filled(template: str, name: WordedName, route: str) -> str:
    text = (files("onto_compiler.scaffold") / "files" / template).read_text("utf-8")
    new = {"in_line_missing_route": route, "in_line": name.snake, "InLine": name.camel, "in line": name.text}
    return re.sub("|".join(new), lambda found: new[found[0]], text)  # all at once: a name may hold `in_line`
