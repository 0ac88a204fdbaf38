"""The task files given to ``onto check``: parsed, lifted with the ontology given with them, and linted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from onto_compiler.check.imports import Imports
from onto_compiler.check.model import load_model
from onto_compiler.check.progress import Step, silent
from onto_compiler.check.run import Report, check
from onto_compiler.check.settings import DEFAULT, Settings
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem

__all__ = ["ENDINGS", "check_all", "check_tasks", "split"]

ENDINGS = (".ttl", ".bddl")


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
) -> Report:
    """Check Turtle and task files together; the tasks are lifted by the shipped ontology with the given Turtle on top.

    ``texts`` is as :func:`onto_compiler.check.model.load_model` has it. Tasks wait while their ontology is no Turtle.
    ``run`` takes the place of :func:`~onto_compiler.check.run.check`.
    """
    turtle, tasks = split(paths)
    report = run(turtle, texts, settings, step) if turtle or not tasks else Report((), (), 0)
    if not tasks:
        return report
    files = (*report.files, *tasks)
    if turtle and any(problem.code.startswith("TTL") and problem.severity == "error" for problem in report.problems):
        return replace(report, files=files)
    problems = settings.chosen(check_tasks(tasks, turtle, texts, settings.imported))
    return replace(report, problems=tuple(sorted({*report.problems, *problems})), files=files)


def check_tasks(
    tasks: Sequence[Path],
    turtle: Sequence[Path] = (),
    texts: Mapping[Path, str] | None = None,
    imported: Mapping[str, Path] | None = None,
) -> tuple[Problem, ...]:
    """Every problem of the task files: what does not parse or lift, and what ``lift`` warns of.

    ``imported`` are files by the IRI that the ontology imports them by.
    """
    from onto_compiler.bddl import lift, parse, parse_file  # noqa: PLC0415 - Lark is heavy, and Turtle needs none
    from onto_compiler.compile_schema import compile_schema  # noqa: PLC0415 - as above

    problems: list[Problem] = []
    try:
        schema = compile_schema(load_model(turtle, texts, lead=Imports(imported or {})).store)
    except OntoError as error:
        return error.problems
    for path in tasks:
        try:
            task = parse(texts[path], str(path)) if texts and path in texts else parse_file(path)
            problems += lift(task, schema, path.stem)[1]
        except OntoError as error:
            problems += error.problems
    return tuple(sorted(set(problems)))
