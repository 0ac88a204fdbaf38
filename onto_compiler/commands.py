"""``onto compile``: a task file in, its typed required ABox out; folders of them in, a verdict on each out."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

from onto_compiler.check.formats import FORMATS, Checked, render
from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from onto_compiler.problems import OntoError, Problem, render_all
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.wording import counted

__all__ = ["COMPILE"]

REPORTS = tuple(name for name in FORMATS if name not in {"text", "json"})

SHOWN_WAYS = 8  # how many alternatives of a goal are written out


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "paths",
        nargs="+",
        metavar="PATH",
        help="task files; of folders, and with --jobs, every *.bddl is validated too, and only problems are printed",
    )
    add_ontology(parser)
    parser.add_argument("--jobs", type=int, metavar="N", help="worker processes (default: one for each processor)")
    kept = parser.add_mutually_exclusive_group()
    kept.add_argument(
        "--cache", type=Path, metavar="FOLDER", help="where verdicts are kept (default: the user's cache)"
    )
    kept.add_argument("--no-cache", action="store_true", help="compile every file anew, and keep nothing")
    add_format(parser, *REPORTS)


def _run(options: argparse.Namespace) -> int:
    if options.jobs is not None and options.jobs < 1:
        raise OntoError.of("CLI002", f"--jobs must be at least 1, and is {options.jobs}", "leave it out")
    whole = options.jobs is not None or options.format in REPORTS
    return _batch(options) if whole or any(Path(path).is_dir() for path in options.paths) else _each(options)


def _batch(options: argparse.Namespace) -> int:
    from onto_compiler.batch import available_jobs, compile_files, task_files  # noqa: PLC0415 - as in _each
    from onto_compiler.cache import cache_folder  # noqa: PLC0415
    from onto_compiler.compiled_rows import BATCH  # noqa: PLC0415

    begin = time.perf_counter()
    files = task_files(options.paths)
    cache = None if options.no_cache else options.cache or cache_folder()
    batch = compile_files(files, options.ontology, jobs=options.jobs or available_jobs(), cache=cache)
    if options.format == "json":
        print_json(BATCH.of(batch))
    else:
        checked = Checked(batch.problems, tuple(map(str, batch.verdicts)))
        sys.stdout.write(render(options.format, checked))
    for remark in batch.remarks:
        sys.stderr.write(f"onto compile: {remark}\n")
    total = batch.summary
    sys.stderr.write(
        f"{counted(total['files'], 'file')}: {total['compiled']:,} compiled, "
        f"{total['failed']:,} failed ({total['cached']:,} from cache), {time.perf_counter() - begin:.2f} s\n"
    )
    return FINDINGS if total["failed"] else CLEAN


def _each(options: argparse.Namespace) -> int:
    from onto_compiler.bddl.compile import compile_task  # noqa: PLC0415 - heavy imports wait for the command to run
    from onto_compiler.compiled_rows import COMPILATION  # noqa: PLC0415

    compiled: list[RequiredABox] = []
    problems: list[Problem] = []
    for path in options.paths:
        try:
            compiled.append(compile_task(path, ontology=options.ontology, warn=problems.append))
        except OntoError as error:
            problems += error.problems
    if options.format == "json":
        print_json(COMPILATION.of({"tasks": compiled, "problems": problems}))
    else:
        sys.stdout.write("\n\n".join(_text(abox) for abox in compiled) + "\n" if compiled else "")
        sys.stderr.write(render_all(problems))
    return FINDINGS if any(problem.severity == "error" for problem in problems) else CLEAN


def _text(abox: RequiredABox) -> str:
    lines = [f"{abox.task}", f"  “{abox.language}”", "  must hold at the end:"]
    lines += [_line(fact) for fact in abox.facts] if not abox.alternatives else _ways(abox)
    lines += ["  must hold at the start:", *(_line(fact) for fact in abox.premise)] if abox.premise else []
    return "\n".join(lines)


def _ways(abox: RequiredABox) -> list[str]:
    lines = []
    for number, way in enumerate(abox.alternatives[:SHOWN_WAYS], 1):
        lines += [f"    alternative {number} of {len(abox.alternatives)}:", *(_line(abox.facts[i]) for i in way)]
    hidden = len(abox.alternatives) - SHOWN_WAYS
    return [*lines, f"    and {hidden} more, which --json lists"] if hidden > 0 else lines


def _line(fact: Fact) -> str:
    typed = ", ".join(f"{a.name}: {local_name(a.type)}" for a in fact.arguments)
    sign = "" if fact.polarity else "not "
    place = f"line {fact.span.line}" if fact.span else ""
    return f"    {sign}{local_name(fact.predicate)}({typed})\n        from {fact.native}, {place}".rstrip(", ")


COMPILE = Command(
    name="compile",
    help="Compile BDDL task files to the typed facts that they require.",
    example="onto compile put_the_bowl_on_the_plate.bddl --json",
    configure=_configure,
    run=_run,
)
