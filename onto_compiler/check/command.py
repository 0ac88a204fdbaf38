"""The subcommands ``onto check`` and ``onto explain``."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.check.formats import FORMATS
from onto_compiler.command import CLEAN, FINDINGS, MISUSE, Command, add_format
from onto_compiler.problems import OntoError, Problem, near, render_all
from onto_compiler.wording import counted

if TYPE_CHECKING:
    from onto_compiler.check.inputs import Inputs
    from onto_compiler.check.run import Report
    from onto_compiler.check.settings import Settings

__all__ = ["CHECK", "EXPLAIN"]

_STDIN = Path("-")


def _configure_check(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="*",
        type=Path,
        metavar="PATH",
        help="Turtle and BDDL files, folders of them, globs, or - for standard input; without, the shipped ontology",
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
        help="validate PATH, data of any ontology in any RDF format, with these SHACL shapes and nothing else; "
        "a file, a folder or a glob in quotes",
    )
    parser.add_argument(
        "--import",
        action="append",
        default=[],
        dest="imports",
        metavar="IRI=FILE",
        help="the file to read where a file imports this IRI; nothing is ever fetched",
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
    parser.add_argument(
        "--exclude",
        action="append",
        metavar="GLOB",
        help="pass over these files in folders: *_old.ttl and vendor by name, lib/*.ttl as seen from here",
    )
    parser.add_argument(
        "--stdin-filename", type=Path, metavar="FILE", help="the file that standard input, given as -, stands for"
    )
    parser.add_argument("--no-cache", action="store_true", help="check large files again, even where nothing changed")
    kept = parser.add_mutually_exclusive_group()
    kept.add_argument("--baseline", type=Path, metavar="FILE", help="leave out the problems that this file holds")
    kept.add_argument("--write-baseline", type=Path, metavar="FILE", help="write all problems to this file")
    parser.add_argument("--exit-zero", action="store_true", help="exit with 0, whatever is found")
    parser.add_argument("--statistics", action="store_true", help="print how often each code is found, and no problems")
    parser.add_argument(
        "--jobs", type=int, default=1, metavar="N", help="processes for task files (default: 1); Turtle takes one"
    )
    parser.add_argument("--quiet", action="store_true", help="print the problems, and nothing else")
    parser.add_argument("--output-file", type=Path, metavar="FILE", help="write to this file, not to standard output")
    parser.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colours in text (default: at a terminal)"
    )
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
        from onto_compiler.check.output import print_problems  # noqa: PLC0415 - `onto --help` stays quick

        print_problems(arguments, error.problems)
        sys.stderr.write(render_all(error.problems))
        return MISUSE


def _checked(arguments: argparse.Namespace) -> int:
    _refuse_combinations(arguments)
    if arguments.report is not None:
        _refuse_report(arguments)
    mapped = _mapped(arguments)
    if arguments.watch:
        return _watch(arguments, mapped)
    return _once(arguments, mapped)[0]


def _refuse_combinations(arguments: argparse.Namespace) -> None:
    """Say which options do not go together."""
    if arguments.jobs < 1:
        raise OntoError.of("CLI002", f"--jobs {arguments.jobs} is no number of processes", "give 1 or more")
    repairing = arguments.fix or arguments.diff
    given = (*arguments.paths, *arguments.shapes)
    if repairing and not arguments.paths:
        raise OntoError.of("CLI002", "the shipped ontology is not repaired in place", "say which files to repair")
    if arguments.shapes and repairing:
        raise OntoError.of("CLI002", "data are not repaired by shapes", "leave out --fix and --diff, or --shapes")
    if arguments.shapes and not arguments.paths:
        raise OntoError.of("CLI002", "--shapes is given without data", "say which files to validate")
    if _STDIN in given:
        if repairing or arguments.watch or arguments.reasoner == "hermit":
            message = "standard input is not repaired, watched or given to HermiT"
            raise OntoError.of("CLI002", message, "give a file instead of `-`")
        if given.count(_STDIN) > 1:
            raise OntoError.of(
                "CLI002", "standard input is read once, and `-` is given twice", "give one of them a file"
            )
    elif arguments.stdin_filename is not None:
        raise OntoError.of("CLI002", "--stdin-filename is given without `-`", "write `-` where the paths are")


def _refuse_report(arguments: argparse.Namespace) -> None:
    """Say why ``--report`` cannot be written, before anything is validated."""
    from onto_compiler.check.report import ENDINGS  # noqa: PLC0415 - as above

    if not arguments.shapes:
        raise OntoError.of("CLI002", "--report is given without --shapes", "say which shapes to validate with")
    if arguments.report.suffix.lower() not in ENDINGS:
        hint = f"name a file that ends in {' or '.join(ENDINGS)}"
        raise OntoError.of("CLI002", f"`{arguments.report}` has no ending that says how to write it", hint)


def _mapped(arguments: argparse.Namespace) -> tuple[tuple[str, Path], ...]:
    """The files that ``--import`` gives, each behind the IRI that it is imported by."""
    found = []
    for given in arguments.imports:
        iri, equals, file = given.rpartition("=")
        if not (iri and equals and file):
            hint = "write --import http://example.org/ontology=FILE"
            raise OntoError.of("CLI002", f"`{given}` is no IRI=FILE", hint)
        if not Path(file).exists():
            raise OntoError.of("TTL002", f"`{file}` does not exist", f"give an existing file for `{iri}`", file)
        found.append((iri, Path(file)))
    return tuple(found)


def _once(arguments: argparse.Namespace, mapped: tuple[tuple[str, Path], ...]) -> tuple[int, tuple[Path, ...]]:
    """Check once; return the exit code, and the files whose change asks for another check."""
    from onto_compiler.check.documents import ENDINGS  # noqa: PLC0415 - as above
    from onto_compiler.check.inputs import expanded, read_stdin, without_excluded  # noqa: PLC0415 - as above
    from onto_compiler.check.output import print_report  # noqa: PLC0415 - as above
    from onto_compiler.check.settings import FILES  # noqa: PLC0415 - as above
    from onto_compiler.check.tasks import ENDINGS as WRITTEN  # noqa: PLC0415 - as above

    begin = time.perf_counter()
    texts = read_stdin((*arguments.paths, *arguments.shapes), arguments.stdin_filename)
    inputs, shapes = expanded(arguments.paths, texts), expanded(arguments.shapes, texts)
    settings = replace(_settings(arguments, inputs.paths), mapped=mapped)
    endings = ENDINGS if arguments.shapes else WRITTEN
    inputs, shapes = (without_excluded(one, settings, tuple(endings)) for one in (inputs, shapes))
    missing = (*inputs.problems, *shapes.problems)
    if shapes.problems or (missing and not inputs.paths):
        raise OntoError(*missing)
    if arguments.diff:
        return _diff(inputs, settings), ()
    if arguments.fix:
        report = _fix(inputs, settings)
    elif arguments.shapes:
        report = _validate(inputs, shapes, settings)
    else:
        report = _report(arguments, inputs, settings)
    failed = _write_report(arguments, report)
    report = replace(report, problems=tuple(sorted((*report.problems, *missing, *failed))))
    code = print_report(arguments, report, begin, inputs)
    watched = (*inputs.paths, *shapes.paths, *report.consulted, *(settings.root / name for name in FILES))
    return (MISUSE if missing or failed else code), watched


def _report(arguments: argparse.Namespace, inputs: Inputs, settings: Settings) -> Report:
    from onto_compiler.check.cached import cached_check  # noqa: PLC0415 - as above
    from onto_compiler.check.progress import progress  # noqa: PLC0415 - as above
    from onto_compiler.check.run import check  # noqa: PLC0415 - as above
    from onto_compiler.check.tasks import check_all  # noqa: PLC0415 - as above

    with progress() as step:
        run = check if arguments.no_cache else cached_check
        report = check_all(inputs.paths, inputs.texts, settings, step, run, arguments.jobs)
        if arguments.reasoner == "hermit":
            from onto_compiler.check.hermit import with_hermit  # noqa: PLC0415 - as above

            report = with_hermit(report, inputs.paths, imported=settings.imported)
    return report


def _validate(inputs: Inputs, shapes: Inputs, settings: Settings) -> Report:
    from onto_compiler.check.data import check_data  # noqa: PLC0415 - as above
    from onto_compiler.check.progress import progress  # noqa: PLC0415 - as above

    with progress():
        report = check_data(inputs.paths, shapes.paths, dict(settings.mapped), dict(settings.imports), inputs.texts)
    return replace(report, problems=tuple(sorted(settings.chosen(report.problems))))


def _write_report(arguments: argparse.Namespace, report: Report) -> tuple[Problem, ...]:
    """Write what ``--report`` asks for; what is wrong is returned, as the problems are printed all the same."""
    if arguments.report is None or report.validation is None:
        return ()
    from onto_compiler.check.report import write_report  # noqa: PLC0415 - as above

    try:
        write_report(arguments.report, report.validation)
    except OntoError as error:
        return error.problems
    return ()


def _settings(arguments: argparse.Namespace, paths: Sequence[Path]) -> Settings:
    """Those of the nearest file, and what the command line says instead."""
    from onto_compiler.check.settings import anchored, parse_codes, read_settings  # noqa: PLC0415 - as above

    def codes(given: Sequence[str]) -> tuple[str, ...]:
        return parse_codes(code for one in given for code in one.split(",") if code.strip())

    settings = read_settings(paths)
    if arguments.select is not None:
        settings = replace(settings, select=codes(arguments.select))
    if arguments.ignore is not None:
        settings = replace(settings, ignore=codes(arguments.ignore))
    if arguments.exclude is not None:
        settings = replace(settings, exclude=anchored(arguments.exclude, Path.cwd()))
    return settings


def _diff(inputs: Inputs, settings: Settings) -> int:
    from onto_compiler.check.fix import diff, fix  # noqa: PLC0415 - as above
    from onto_compiler.check.output import log, shown  # noqa: PLC0415 - as above

    fixed = fix(inputs.paths, settings)
    sys.stdout.write(diff(fixed, {path: shown(path) for path in fixed.after}))
    log(f"{counted(len(fixed.edits), 'repair')} in {counted(len(fixed.after), 'file')} would be made")
    return FINDINGS if fixed.edits else CLEAN


def _fix(inputs: Inputs, settings: Settings) -> Report:
    from onto_compiler.check.fix import fix, write  # noqa: PLC0415 - as above
    from onto_compiler.check.output import log, shown  # noqa: PLC0415 - as above

    fixed = fix(inputs.paths, settings)
    write(fixed)
    for edit in fixed.edits:
        place = f"{shown(edit.problem.file)}:{edit.problem.line}:{edit.problem.column}"
        log(f"{place}: {edit.done} [{edit.problem.code}]")
    return fixed.report


def _watch(arguments: argparse.Namespace, mapped: tuple[tuple[str, Path], ...]) -> int:
    import ontology  # noqa: PLC0415 - as above
    from onto_compiler.check.output import log, shown  # noqa: PLC0415 - as above
    from onto_compiler.check.watch import changes  # noqa: PLC0415 - as above

    code = CLEAN
    watched = [*arguments.paths, *arguments.shapes] or [ontology.ROOT]
    try:
        for changed in changes(watched):
            if changed:
                log(f"\n{', '.join(dict.fromkeys(shown(path.resolve()) for path in changed))} changed")
            try:
                code, more = _once(arguments, mapped)
                watched += more
            except OntoError as error:  # the next change may mend it
                code = MISUSE
                sys.stderr.write(render_all(error.problems))
            sys.stdout.flush()
            log("watching; Ctrl-C ends")
    except KeyboardInterrupt:
        log("")
    return code


def _configure_explain(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "code", nargs="?", metavar="CODE", help="the code of a problem, e.g. VOC001; without, all codes"
    )


def _explain(arguments: argparse.Namespace) -> int:
    from onto_compiler.check.pages import codes, page, titles  # noqa: PLC0415 - as above

    if arguments.code is None:
        sys.stdout.write("".join(f"{code:<8}  {title}\n" for code, title in titles().items()))
        return CLEAN
    code = str(arguments.code).strip().upper()
    text = page(code)
    if text is None:
        hint = near(code, codes())
        hint = hint or "`onto explain` lists all codes"
        sys.stderr.write(f"onto explain: `{arguments.code}` is no code of a problem; {hint}\n")
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
