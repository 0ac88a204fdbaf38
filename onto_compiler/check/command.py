"""The subcommands ``onto check`` and ``onto explain``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.check.formats import FORMATS, Checked, render
from onto_compiler.command import CLEAN, FINDINGS, MISUSE, Command, add_format
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.wording import counted

if TYPE_CHECKING:
    from onto_compiler.check.run import Report
    from onto_compiler.check.settings import Settings

__all__ = ["CHECK", "EXPLAIN"]


def _configure_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="*",
        type=Path,
        metavar="PATH",
        help="Turtle and BDDL files, or folders of them; without any, the shipped ontology",
    )
    parser.add_argument(
        "--fail-on",
        choices=("error", "warning"),
        default="error",
        help="the least severity that makes the exit code 1 (default: error)",
    )
    parser.add_argument(
        "--shapes",
        action="append",
        default=[],
        type=Path,
        metavar="SHAPES",
        help="validate PATH, data of any ontology in any RDF format, with these SHACL shapes and nothing else",
    )
    parser.add_argument(
        "--import",
        action="append",
        default=[],
        dest="imports",
        metavar="IRI=FILE",
        help="with --shapes: the file to read where data or shapes import this IRI; nothing is ever fetched",
    )
    parser.add_argument(
        "--reasoner",
        choices=("rl", "hermit"),
        default="rl",
        help="what finds contradictions: OWL 2 RL rules, or HermiT as well, which runs on Java (default: rl)",
    )
    parser.add_argument(
        "--report",
        type=Path,
        metavar="FILE",
        help="also write the W3C's SHACL validation report of --shapes: FILE.ttl or FILE.jsonld",
    )
    parser.add_argument(
        "--select",
        action="append",
        metavar="CODES",
        help="report these codes alone, of other people's terms too: VOC006, or DOC,OWL for all that begin so, or ALL",
    )
    parser.add_argument(
        "--ignore", action="append", metavar="CODES", help="report everything but these codes, as for --select"
    )
    parser.add_argument("--no-cache", action="store_true", help="check large files again, even where nothing changed")
    kept = parser.add_mutually_exclusive_group()
    kept.add_argument("--baseline", type=Path, metavar="FILE", help="leave out the problems that this file holds")
    kept.add_argument("--write-baseline", type=Path, metavar="FILE", help="write all problems to this file")
    parser.add_argument("--exit-zero", action="store_true", help="exit with 0, whatever is found")
    parser.add_argument("--statistics", action="store_true", help="print how often each code is found, and no problems")
    acting = parser.add_mutually_exclusive_group()
    acting.add_argument("--fix", action="store_true", help="repair what is mechanical, in the files themselves")
    acting.add_argument("--diff", action="store_true", help="print what --fix would change, and change nothing")
    acting.add_argument("--watch", action="store_true", help="check again whenever a file changes, until Ctrl-C")
    add_format(parser, *(name for name in FORMATS if name not in {"text", "json"}))


def _check(arguments: argparse.Namespace) -> int:
    if arguments.format == "text":
        return _checked(arguments)
    try:
        return _checked(arguments)
    except OntoError as error:  # whoever reads a format finds it in every case
        sys.stdout.write(render(arguments.format, Checked(error.problems, (), arguments.fail_on)))
        raise


def _checked(arguments: argparse.Namespace) -> int:
    paths: Sequence[Path] = arguments.paths
    imports = _imports(arguments)
    missing = [path for path in (*paths, *arguments.shapes, *imports.values()) if not path.exists()]
    for path in missing:
        _log(f"onto check: `{path}` does not exist")
    if missing:
        hint = "give an existing file, or a folder that holds some"
        found = (Problem(str(path), 0, 0, "TTL002", "error", f"`{path}` does not exist", hint) for path in missing)
        if arguments.format != "text":
            sys.stdout.write(render(arguments.format, Checked(tuple(sorted(found)), (), arguments.fail_on)))
        return MISUSE
    if arguments.report is not None:
        _refuse_report(arguments)
    if (arguments.fix or arguments.diff) and not paths:
        raise OntoError.of("CLI002", "the shipped ontology is not repaired in place", "say which files to repair")
    if arguments.shapes and (arguments.fix or arguments.diff):
        raise OntoError.of("CLI002", "data are not repaired by shapes", "leave out --fix and --diff, or --shapes")
    if arguments.shapes and not paths:
        raise OntoError.of("CLI002", "--shapes is given without data", "say which files to validate")
    if arguments.watch:
        return _watch(arguments)
    return _fix(arguments) if arguments.fix or arguments.diff else _once(arguments)


def _once(arguments: argparse.Namespace) -> int:
    from onto_compiler.check.progress import progress  # noqa: PLC0415 - `onto --help` stays quick
    from onto_compiler.check.run import check  # noqa: PLC0415 - as above
    from onto_compiler.check.tasks import check_all  # noqa: PLC0415 - as above

    begin = time.perf_counter()
    settings = _settings(arguments)
    with progress() as step:
        if arguments.shapes:
            from onto_compiler.check.data import check_data  # noqa: PLC0415

            report = check_data(arguments.paths, arguments.shapes, _imports(arguments))
            report = replace(report, problems=tuple(sorted(settings.chosen(report.problems))))
        else:
            from onto_compiler.check.cached import cached_check  # noqa: PLC0415

            run = check if arguments.no_cache else cached_check
            report = check_all(arguments.paths, settings=settings, step=step, run=run)
        if arguments.reasoner == "hermit" and not arguments.shapes:
            from onto_compiler.check.hermit import with_hermit  # noqa: PLC0415 - as above

            report = with_hermit(report, arguments.paths)
    if arguments.report is not None and report.validation is not None:
        from onto_compiler.check.report import write_report  # noqa: PLC0415 - as above

        try:
            write_report(arguments.report, report.validation)
        except OntoError as error:  # what was found is printed all the same
            _print(arguments, replace(report, problems=(*report.problems, *error.problems)), begin)
            return MISUSE
    return _print(arguments, report, begin)


def _imports(arguments: argparse.Namespace) -> dict[str, Path]:
    """The files that ``--import`` gives, by the IRI that each is imported by."""
    found = {}
    for given in arguments.imports:
        iri, equals, file = given.rpartition("=")
        if not (iri and equals and file):
            hint = "write --import http://example.org/ontology=FILE"
            raise OntoError.of("CLI002", f"`{given}` is no IRI=FILE", hint)
        found[iri] = Path(file)
    if found and not arguments.shapes:
        raise OntoError.of("CLI002", "--import is given without --shapes", "say which shapes to validate with")
    return found


def _refuse_report(arguments: argparse.Namespace) -> None:
    """Say why ``--report`` cannot be written, before anything is validated."""
    from onto_compiler.check.report import ENDINGS  # noqa: PLC0415

    if not arguments.shapes:
        raise OntoError.of("CLI002", "--report is given without --shapes", "say which shapes to validate with")
    if arguments.report.suffix.lower() not in ENDINGS:
        hint = f"name a file that ends in {' or '.join(ENDINGS)}"
        raise OntoError.of("CLI002", f"`{arguments.report}` has no ending that says how to write it", hint)


def _beyond_baseline(arguments: argparse.Namespace, problems: Sequence[Problem]) -> tuple[Problem, ...]:
    """What is left to report, where a baseline is read or written."""
    from onto_compiler.check.baseline import beyond, read_baseline, write_baseline  # noqa: PLC0415 - as above

    if arguments.write_baseline is not None:
        number = write_baseline(arguments.write_baseline, problems)
        _log(f"wrote {counted(number, 'problem')} to {_shown(arguments.write_baseline)}")
        return ()
    if arguments.baseline is not None:
        return tuple(beyond(arguments.baseline, read_baseline(arguments.baseline), problems))
    return tuple(problems)


def _settings(arguments: argparse.Namespace) -> Settings:
    """Those of the nearest file, and what the command line says instead."""
    from onto_compiler.check.settings import parse_codes, read_settings  # noqa: PLC0415 - as above

    def codes(given: Sequence[str]) -> tuple[str, ...]:
        return parse_codes(code for one in given for code in one.split(",") if code.strip())

    settings = read_settings(arguments.paths)
    if arguments.select is not None:
        settings = replace(settings, select=codes(arguments.select))
    if arguments.ignore is not None:
        settings = replace(settings, ignore=codes(arguments.ignore))
    return settings


def _print(arguments: argparse.Namespace, report: Report, begin: float) -> int:
    left = _beyond_baseline(arguments, report.problems)
    problems = tuple(_relative(problem) for problem in left)
    repaired = {}
    if arguments.format == "sarif" and arguments.paths and not arguments.shapes:
        from onto_compiler.check.fix import repairs  # noqa: PLC0415 - only this format has them

        repaired = {_relative(problem): repair for problem, repair in repairs(report, arguments.paths).items()}
    files = tuple(_shown(path) for path in report.files)
    checked = Checked(problems, files, arguments.fail_on, repairs=repaired)
    if arguments.statistics:
        sys.stdout.write(_statistics(problems))
    else:
        sys.stdout.write(render(arguments.format, checked))
    if problems:
        _log(_summary(problems))
    else:
        seconds = time.perf_counter() - begin
        number = counted(len(report.files), "file")
        _log(f"no problem found in {number} ({report.triples:,} triples), {seconds:.2f} s")
    return FINDINGS if checked.failures and not arguments.exit_zero else CLEAN


def _statistics(problems: Sequence[Problem]) -> str:
    """One line for each code and severity: how often, and the first message; the most frequent first."""
    found: dict[tuple[str, str], list[str]] = {}
    for problem in problems:
        found.setdefault((problem.code, problem.severity), []).append(problem.message)
    rows = sorted(found.items(), key=lambda row: (-len(row[1]), row[0]))
    return "".join(f"{len(said):>7,}  {code}  {severity:<7}  {said[0]}\n" for (code, severity), said in rows)


def _fix(arguments: argparse.Namespace) -> int:
    from onto_compiler.check.fix import diff, fix, write  # noqa: PLC0415 - as above

    begin = time.perf_counter()
    fixed = fix(arguments.paths, _settings(arguments))
    if arguments.diff:
        sys.stdout.write(diff(fixed, {path: _shown(path) for path in fixed.after}))
        _log(f"{counted(len(fixed.edits), 'repair')} in {counted(len(fixed.after), 'file')} would be made")
        return FINDINGS if fixed.edits else CLEAN
    write(fixed)
    for edit in fixed.edits:
        place = f"{_shown(edit.problem.file)}:{edit.problem.line}:{edit.problem.column}"
        _log(f"{place}: {edit.done} [{edit.problem.code}]")
    return _print(arguments, fixed.report, begin)


def _watch(arguments: argparse.Namespace) -> int:
    import ontology  # noqa: PLC0415 - as above
    from onto_compiler.check.watch import changes  # noqa: PLC0415

    code = CLEAN
    try:
        for changed in changes([*arguments.paths, *arguments.shapes] or [ontology.ROOT]):
            if changed:
                _log(f"\n{', '.join(_shown(path.resolve()) for path in changed)} changed")
            code = _once(arguments)
            sys.stdout.flush()
            _log("watching; Ctrl-C ends")
    except KeyboardInterrupt:
        _log("")
    return code


def _log(message: str) -> None:
    sys.stderr.write(message + "\n")


def _relative(problem: Problem) -> Problem:
    """The problem with its file as people see it."""
    return replace(problem, file=_shown(problem.file)) if problem.file else problem


def _shown(file: Path | str) -> str:
    """The path of a file, relative to the working directory if it is below it."""
    try:
        return str(Path(file).relative_to(Path.cwd()))
    except ValueError:
        return str(file)


def _summary(problems: Sequence[Problem]) -> str:
    kinds = {"error": 0, "warning": 0, "note": 0}
    for problem in problems:
        kinds["note" if problem.severity == "info" else problem.severity] += 1
    detail = ", ".join(counted(number, kind) for kind, number in kinds.items() if number)
    files = counted(len({problem.file for problem in problems}), "file")
    found = len(problems) - kinds["note"]
    return f"{counted(found, 'problem')} ({detail}) in {files}" if found else f"no problem found, {detail} in {files}"


def _configure_explain(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("code", metavar="CODE", help="the code of a problem, e.g. VOC001")


def _explain(arguments: argparse.Namespace) -> int:
    from onto_compiler.check.pages import codes, page  # noqa: PLC0415 - as above

    code = str(arguments.code).upper()
    text = page(code)
    if text is None:
        hint = near(code, codes())
        _log(f"onto explain: `{arguments.code}` is no code of a problem; {hint}".rstrip("; "))
        return MISUSE
    sys.stdout.write(text.rstrip() + "\n")
    return CLEAN


CHECK = Command(
    name="check",
    help="Find what is wrong with an ontology: syntax, names, signatures, routes, rules, bindings and shapes.",
    example="onto check my_domain.ttl --fail-on warning",
    configure=_configure_check,
    run=_check,
)
EXPLAIN = Command(
    name="explain",
    help="Print what a problem's code means, why it matters and what to write instead.",
    example="onto explain VOC001",
    configure=_configure_explain,
    run=_explain,
)
