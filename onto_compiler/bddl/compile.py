"""From a task file to its required ABox: :mod:`parse`, then :mod:`lift`, with the user's own ontology."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from onto_compiler.bddl.lift import lift
from onto_compiler.bddl.parse import parse_file
from onto_compiler.compile_schema import load_schema
from onto_compiler.problems import Problem
from onto_compiler.required import RequiredABox

__all__ = ["compile_task"]


def compile_task(
    path: str | Path, *, ontology: Sequence[str | Path] = (), warn: Callable[[Problem], object] | None = None
) -> RequiredABox:
    """The typed facts that the BDDL file at ``path`` requires, under the shipped ontology with ``ontology`` on top.

    ``warn`` is called with each problem that does not keep the file from being compiled.

    Raises:
        OntoError: BDDL problems of the file, TTL and SCH problems of the ontology.
    """
    schema = load_schema(*ontology)
    spec = parse_file(path)
    required, warnings = lift(spec, schema, spec.file.rpartition("/")[2].removesuffix(".bddl"))
    if warn is not None:
        for problem in warnings:
            warn(problem)
    return required
