"""The task files given to ``onto check``: parsed, lifted with the ontology given with them, and linted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.check.imports import Imports
from onto_compiler.check.model import load_model
from onto_compiler.check.progress import Step, silent
from onto_compiler.check.run import Report, check
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem

if TYPE_CHECKING:
    from onto_compiler.bddl import TaskSpec

__all__ = ["ENDINGS", "check_all", "check_tasks", "split"]

ENDINGS = (".ttl", ".bddl")
_OF_PREFIXES = frozenset(("TTL007", "TTL008"))  # of a file that is Turtle, whatever severity the settings give them
_SHARE = 16  # tasks: to begin a process takes longer than to check as many


def split(paths: Sequence[Path | str]) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    """What of ``paths`` is Turtle, folders included, and every ``*.bddl`` file among or below them.

    A folder that holds tasks alone is no folder of Turtle.
    """
    turtle: list[Path] = []
    tasks: dict[Path, None] = {}
    for given in map(Path, paths):
        if given.is_dir():
            found = below(given, "*.bddl")
            tasks.update(dict.fromkeys(map(actual, found)))
            if not found or below(given, "*.ttl"):
                turtle.append(given)
        elif given.suffix == ".bddl":
            tasks[actual(given)] = None
        else:
            turtle.append(given)
    return tuple(turtle), tuple(tasks)


def check_all(
    paths: Sequence[Path | str] = (),
    texts: Mapping[Path, str] | None = None,
    settings: Settings = DEFAULT,
    step: Step = silent,
    run: Callable[..., Report] = check,
    jobs: int = 1,
) -> Report:
    """Check Turtle and task files together; the tasks are lifted by the shipped ontology with the given Turtle on top.

    ``texts`` is as :func:`onto_compiler.check.model.load_model` has it. While their ontology is no Turtle, tasks
    are only parsed. ``run`` takes the place of :func:`~onto_compiler.check.run.check`, and ``jobs`` processes take the
    tasks.
    """
    turtle, tasks = split(paths)
    report = run(turtle, texts, settings, step) if turtle or not tasks else Report((), (), 0)
    if not tasks:
        return report
    if any(one.code.startswith("TTL") and one.code not in _OF_PREFIXES for one in report.problems):
        found = tuple(_parse_problems(tasks, texts or {}))
    else:
        found = check_tasks(tasks, turtle, texts, settings.imported, jobs)
    problems = tuple(sorted({*report.problems, *settings.chosen(found)}))
    return replace(report, problems=problems, files=(*report.files, *tasks))


def check_tasks(
    tasks: Sequence[Path],
    turtle: Sequence[Path] = (),
    texts: Mapping[Path, str] | None = None,
    imported: Mapping[str, Path] | None = None,
    jobs: int = 1,
) -> tuple[Problem, ...]:
    """Every problem of the task files: what does not parse or lift, and what ``lift`` warns of.

    ``imported`` are files by the IRI that the ontology imports them by. At most ``jobs`` processes each read the
    ontology, and a share of the tasks.
    """
    from onto_compiler.pool import map_over_processes  # noqa: PLC0415 - Turtle needs none

    workers = max(min(jobs, len(tasks) // _SHARE), 1)
    shares = [
        _Share(tuple(tasks[start::workers]), tuple(turtle), texts or {}, imported or {}) for start in range(workers)
    ]
    found = {problem for _, problems in map_over_processes(_lifted, shares, workers) for problem in problems}
    return tuple(sorted(found))


@dataclass(frozen=True)
class _Share:
    """The tasks that one process takes, and what it reads for them."""

    tasks: tuple[Path, ...]
    turtle: tuple[Path, ...]
    texts: Mapping[Path, str]
    imported: Mapping[str, Path]


def _lifted(share: _Share) -> tuple[Problem, ...]:
    from onto_compiler.bddl import lift  # noqa: PLC0415 - Lark is heavy, and Turtle needs none
    from onto_compiler.compile_schema import compile_schema  # noqa: PLC0415 - as above

    try:
        schema = compile_schema(load_model(share.turtle, share.texts, lead=Imports(share.imported)).store)
    except OntoError as error:
        return error.problems
    problems: list[Problem] = []
    for path in share.tasks:
        try:
            problems += lift(_parsed(path, share.texts), schema, path.stem)[1]
        except OntoError as error:
            problems += error.problems
    return tuple(problems)


def _parse_problems(tasks: Sequence[Path], texts: Mapping[Path, str]) -> list[Problem]:
    problems: list[Problem] = []
    for path in tasks:
        try:
            _parsed(path, texts)
        except OntoError as error:
            problems += error.problems
    return problems


def _parsed(path: Path, texts: Mapping[Path, str]) -> TaskSpec:
    from onto_compiler.bddl import parse, parse_file  # noqa: PLC0415 - Lark is heavy, and Turtle needs none

    return parse(texts[path], str(path)) if path in texts else parse_file(path)
