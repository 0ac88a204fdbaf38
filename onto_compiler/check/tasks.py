"""The task files given to ``onto check``: parsed, lifted with the ontology given with them, and linted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from onto_compiler.check.model import load_model
from onto_compiler.check.run import Report, check
from onto_compiler.folders import actual, below
from onto_compiler.problems import OntoError, Problem

__all__ = ["check_all", "check_tasks", "split"]


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
    paths: Sequence[Path | str] = (), texts: Mapping[Path, str] | None = None, report: Report | None = None
) -> Report:
    """Check Turtle and task files together; the tasks are lifted by the shipped ontology with the given Turtle on top.

    ``texts`` is as :func:`onto_compiler.check.model.load_model` has it, and ``report`` what is known already of the
    Turtle among ``paths``. Tasks wait while their ontology is no Turtle.
    """
    turtle, tasks = split(paths)
    if report is None:
        report = check(turtle, texts) if turtle or not tasks else Report((), (), 0)
    if not tasks:
        return report
    files = (*report.files, *tasks)
    if turtle and any(problem.code.startswith("TTL") and problem.severity == "error" for problem in report.problems):
        return Report(report.problems, files, report.triples)
    problems = check_tasks(tasks, turtle, texts)
    return Report(tuple(sorted({*report.problems, *problems})), files, report.triples)


def check_tasks(
    tasks: Sequence[Path], turtle: Sequence[Path] = (), texts: Mapping[Path, str] | None = None
) -> tuple[Problem, ...]:
    """Every problem of the task files: what does not parse or lift, and what ``lift`` warns of."""
    from onto_compiler.bddl import lift, parse_file  # noqa: PLC0415 - Lark is heavy, and Turtle needs none
    from onto_compiler.compile_schema import compile_schema  # noqa: PLC0415 - as above

    problems: list[Problem] = []
    try:
        schema = compile_schema(load_model(turtle, texts).store)
    except OntoError as error:
        return error.problems
    for path in tasks:
        try:
            problems += lift(parse_file(path), schema, path.stem)[1]
        except OntoError as error:
            problems += error.problems
    return tuple(sorted(set(problems)))
