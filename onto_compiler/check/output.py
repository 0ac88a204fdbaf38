"""What ``onto check`` prints: problems on standard output or in a file, and what it did on standard error."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from onto_compiler.check.baseline import beyond, read_baseline, write_baseline
from onto_compiler.check.formats import Checked, render
from onto_compiler.check.inputs import Inputs
from onto_compiler.check.run import Report
from onto_compiler.command import CLEAN, FINDINGS
from onto_compiler.problems import OntoError, Problem
from onto_compiler.wording import counted

__all__ = ["emit", "log", "print_problems", "print_report", "shown"]


def print_report(arguments: argparse.Namespace, report: Report, begin: float, inputs: Inputs) -> int:
    """Print ``report``, begun at the time ``begin``, in the format that is asked for; return the exit code."""
    problems = tuple(_relative(problem) for problem in _beyond_baseline(arguments, report.problems))
    repaired = {}
    if arguments.format == "sarif" and inputs.paths and not inputs.texts and not arguments.shapes:
        from onto_compiler.check.fix import repairs  # noqa: PLC0415 - only this format has them

        repaired = {_relative(problem): repair for problem, repair in repairs(report, inputs.paths).items()}
    checked = Checked(
        problems,
        tuple(shown(path) for path in report.files),
        arguments.fail_on,
        texts={shown(path): text for path, text in inputs.texts.items()},
        repairs=repaired,
        colour=_in_colour(arguments),
    )
    emit(arguments, _statistics(problems) if arguments.statistics else render(arguments.format, checked))
    if not arguments.quiet:
        log(_summary(problems) if problems else _clean(report, time.perf_counter() - begin))
    return FINDINGS if checked.failures and not arguments.exit_zero else CLEAN


def print_problems(arguments: argparse.Namespace, problems: Sequence[Problem]) -> None:
    """Print what keeps a check from running, in a format for programs, which find it there in every case."""
    emit(arguments, render(arguments.format, Checked(tuple(sorted(problems)), (), arguments.fail_on)))


def emit(arguments: argparse.Namespace, text: str) -> None:
    """Write to standard output, or to the file that takes its place.

    Raises:
        OntoError: CLI009, where the file cannot be written.

    """
    path: Path | None = arguments.output_file
    if path is None:
        sys.stdout.write(text)
        return
    from onto_compiler.atomic import replacing  # noqa: PLC0415 - few runs write a file

    try:
        with replacing(path) as whole:
            whole.write_text(text, encoding="utf-8")
    except OSError as error:
        message = f"cannot write `{path}`: {error.strerror or error}"
        raise OntoError.of("CLI009", message, "name a file that can be written", str(path)) from error


def log(message: str) -> None:
    """Write a line to standard error."""
    sys.stderr.write(message + "\n")


def shown(file: Path | str) -> str:
    """The path of a file, relative to the working directory if it is below it."""
    try:
        return str(Path(file).relative_to(Path.cwd()))
    except ValueError:
        return str(file)


def _relative(problem: Problem) -> Problem:
    """The problem with its file as people see it."""
    return replace(problem, file=shown(problem.file)) if problem.file else problem


def _in_colour(arguments: argparse.Namespace) -> bool:
    if arguments.format != "text" or arguments.color == "never":
        return False
    plain = arguments.output_file is not None or not sys.stdout.isatty()
    asked_not = bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM") == "dumb"
    return bool(arguments.color == "always" or not (plain or asked_not))


def _beyond_baseline(arguments: argparse.Namespace, problems: Sequence[Problem]) -> tuple[Problem, ...]:
    """What is left to report, where a baseline is read or written."""
    if arguments.write_baseline is not None:
        number = write_baseline(arguments.write_baseline, problems)
        if not arguments.quiet:
            log(f"wrote {counted(number, 'problem')} to {shown(arguments.write_baseline)}")
        return ()
    if arguments.baseline is not None:
        return tuple(beyond(arguments.baseline, read_baseline(arguments.baseline), problems))
    return tuple(problems)


def _statistics(problems: Sequence[Problem]) -> str:
    """One line for each code and severity: how often, and the first message; the most frequent first."""
    found: dict[tuple[str, str], list[str]] = {}
    for problem in problems:
        found.setdefault((problem.code, problem.severity), []).append(problem.message)
    rows = sorted(found.items(), key=lambda row: (-len(row[1]), row[0]))
    return "".join(f"{len(said):>7,}  {code}  {severity:<7}  {said[0]}\n" for (code, severity), said in rows)


def _summary(problems: Sequence[Problem]) -> str:
    kinds = {"error": 0, "warning": 0, "note": 0}
    for problem in problems:
        kinds["note" if problem.severity == "info" else problem.severity] += 1
    detail = ", ".join(counted(number, kind) for kind, number in kinds.items() if number)
    files = counted(len({problem.file for problem in problems}), "file")
    found = len(problems) - kinds["note"]
    return f"{counted(found, 'problem')} ({detail}) in {files}" if found else f"no problem found, {detail} in {files}"


def _clean(report: Report, seconds: float) -> str:
    return f"no problem found in {counted(len(report.files), 'file')} ({report.triples:,} triples), {seconds:.2f} s"
