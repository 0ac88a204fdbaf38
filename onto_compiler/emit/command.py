"""``onto schema``: files generated from the ontology, printed, written, or compared with the committed ones."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from onto_compiler.command import CLEAN, FINDINGS, Command, add_format, add_ontology, print_json
from onto_compiler.emit import OUTPUTS, emit
from onto_compiler.problems import Problem, render

__all__ = ["SCHEMA"]


def _configure(parser: argparse.ArgumentParser) -> None:
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--emit", choices=OUTPUTS, help="print one output, or write it to --output")
    what.add_argument(
        "--write", action="store_true", help="write every file that [tool.onto.schema] of pyproject.toml names"
    )
    what.add_argument("--check", action="store_true", help="list which of those files are stale; exit 1 where one is")
    parser.add_argument("--output", type=Path, metavar="FILE", help="where --emit writes instead of standard output")
    add_ontology(parser)
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    import shlex  # noqa: PLC0415 - `onto --help` is quick

    from onto_compiler.emit.artefacts import find_settings, fresh, sources_of, write_text  # noqa: PLC0415
    from onto_compiler.emit.tbox import read_tbox  # noqa: PLC0415

    if options.emit:
        text = emit(options.emit, read_tbox(options.ontology))
        if options.output is None:
            sys.stdout.write(text)
        else:
            write_text(options.output, text)
        return CLEAN
    settings = find_settings(Path.cwd())
    tbox = read_tbox([*sources_of(settings), *options.ontology])
    states = []
    for artefact in settings.artefacts:
        state = fresh(artefact, tbox)
        if options.write and state != "fresh":
            write_text(artefact.path, emit(artefact.output, tbox))
            state = "written"
        states.append({"output": artefact.output, "file": _relative(artefact.path), "state": state})
    stale = [row for row in states if row["state"] in {"stale", "missing"}]
    again = shlex.join(["onto", "schema", "--write", *(["--ontology", *options.ontology] if options.ontology else [])])
    problems = [_problem(row["file"], row["state"], again) for row in stale]
    if options.format == "json":
        print_json({"files": states, "problems": [problem.as_dict() for problem in problems]})
    else:
        _report(states, problems, sys.stdout.write)
    return FINDINGS if problems else CLEAN


def _relative(path: Path) -> str:
    """The path of a file, relative to the working directory if it is below it."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def _report(states: list[dict[str, str]], problems: list[Problem], write: Callable[[str], object]) -> None:
    for row in states:
        if row["state"] == "written":
            write(f"wrote {row['file']}\n")
    for problem in problems:
        write(render(problem) + "\n\n")
    kept = sum(row["state"] != "written" for row in states) - len(problems)
    sys.stderr.write(f"{kept} of {len(states)} generated files were fresh\n")


def _problem(file: str, state: str, again: str) -> Problem:
    """``again`` is the command that writes what is stale from the same ontology."""
    fault = "does not exist" if state == "missing" else "is not what the ontology generates now"
    hint = f"run `{again}`"
    if Path(file).is_dir():
        fault, hint = "is a folder", "name a file in `[tool.onto.schema]` of `pyproject.toml`"
    return Problem(file, 0, 0, "SCH003", "error", f"`{Path(file).name}` {fault}", hint)


SCHEMA = Command(
    name="schema",
    help="Generate SHACL shapes, JSON Schema, a JSON-LD context, Python types, diagrams or arrays from the ontology.",
    example="onto schema --emit shacl --output shapes.ttl",
    configure=_configure,
    run=_run,
)
