"""Problems of a buffer: those that a keystroke is answered with, and those that wait for a pause.

The quick answer is the syntax, the prefixes and every check that is a query; the whole of ``onto check`` follows once
the typing stops. Until then, what only the whole check finds stays where the text around it is unchanged.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from pyoxigraph import Store

from onto_compiler.check.datatypes import check_datatypes
from onto_compiler.check.deprecated import check_deprecated
from onto_compiler.check.domains import check_domains
from onto_compiler.check.hierarchy import check_hierarchy
from onto_compiler.check.house import House
from onto_compiler.check.imports import Imports
from onto_compiler.check.locate import locate
from onto_compiler.check.model import load_model
from onto_compiler.check.prefixes import check_prefixes
from onto_compiler.check.queries import query_checks, run_query
from onto_compiler.check.run import check
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.check.suppressions import unsuppressed
from onto_compiler.problems import OntoError, Problem
from onto_compiler.schema import Schema
from onto_compiler.sources import read_into

__all__ = ["NOTHING", "Around", "formatted", "moved", "quick_turtle", "task_problems", "texts_of", "whole_turtle"]

Around = Mapping[Path, str | None]
NOTHING: Around = {}
_LINE_END = re.compile(r"\r\n|\n|\r")


def quick_turtle(path: Path, text: str, around: Around = NOTHING, settings: Settings = DEFAULT) -> tuple[Problem, ...]:
    """Syntax, prefixes, and the checks that are quick, of ``text`` as the content of ``path``.

    ``around`` are the other files of the same ontology, each with its text where that is not what is on disk.
    """
    if not path.exists():  # a buffer that was never saved has no place among other files
        return tuple(read_into(Store(), path, text))
    try:
        model = load_model([path, *around], texts_of(path, text, around), lead=Imports(settings.imported))
    except OntoError as error:
        return _own(path, error.problems)
    found = (finding for one in query_checks() for finding in run_query(model, one))
    findings = [one for one in found if one.code != "OWL003" or one.object in model.unresolved]
    findings += [*check_hierarchy(model), *check_domains(model), *check_datatypes(model), *check_deprecated(model)]
    house = House(model, settings.namespaces, settings.select)
    problems = {house.judged_problem(problem, graph) for problem, graph in check_prefixes(model)}
    problems |= {*locate(model, house.judged(findings))}
    chosen = sorted(settings.chosen(_own(path, problems)))
    kept = unsuppressed(str(path), text, chosen, settings.reports)
    return tuple(problem for problem in kept if problem.code != "CFG002")  # what the rest finds is not known yet


def whole_turtle(path: Path, text: str, around: Around = NOTHING, settings: Settings = DEFAULT) -> tuple[Problem, ...]:
    """Everything that ``onto check`` says of ``text`` as the content of ``path``, with the files ``around`` it."""
    if not path.exists():
        return quick_turtle(path, text)
    return _own(path, check([path, *around], texts_of(path, text, around), settings).problems)


def task_problems(path: Path, text: str, schema: Schema, settings: Settings = DEFAULT) -> tuple[Problem, ...]:
    """All problems from parsing and lifting a task file."""
    from onto_compiler.bddl import lift, parse  # noqa: PLC0415 - Lark is heavy, and Turtle needs none

    try:
        _, warnings = lift(parse(text, str(path)), schema, path.stem)
    except OntoError as error:
        warnings = error.problems
    return tuple(sorted(set(settings.chosen(_own(path, warnings)))))


def formatted(path: Path, text: str, *, task: bool) -> str:
    """``text`` as ``onto fmt`` lays it out.

    Raises:
        OntoError: as ``onto fmt`` reports what it leaves alone.

    """
    from onto_compiler.bddl.layout import format_text  # noqa: PLC0415 - Lark is heavy, and Turtle needs none
    from onto_compiler.turtle.layout import format_turtle  # noqa: PLC0415 - nobody asks at start

    return format_text(text, str(path)) if task else format_turtle(text, path)


def moved(problems: Iterable[Problem], before: str, after: str) -> tuple[Problem, ...]:
    """``problems`` of ``before`` as places of ``after``; those on lines that changed are left out."""
    old, new = _LINE_END.split(before), _LINE_END.split(after)
    top = 0
    while top < min(len(old), len(new)) and old[top] == new[top]:
        top += 1
    bottom = 0
    while bottom < min(len(old), len(new)) - top and old[-1 - bottom] == new[-1 - bottom]:
        bottom += 1
    kept = []
    for problem in problems:
        if problem.line <= top:
            kept.append(problem)
        elif problem.line > len(old) - bottom:
            down = len(new) - len(old)
            end = problem.end_line and problem.end_line + down
            kept.append(replace(problem, line=problem.line + down, end_line=end))
    return tuple(kept)


def texts_of(path: Path, text: str, around: Around) -> dict[Path, str]:
    """What the editor holds of ``path`` and of the files around it."""
    return {**{file: held for file, held in around.items() if held is not None}, path: text}


def _own(path: Path, problems: Iterable[Problem]) -> tuple[Problem, ...]:
    return tuple(problem for problem in problems if problem.file == str(path))
