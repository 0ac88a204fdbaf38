"""The subcommand ``onto new``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from onto_compiler.command import CLEAN, Command
from onto_compiler.problems import OntoError

__all__ = ["NEW"]

KINDS = ("ontology", "predicate", "failure", "route", "task")


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("kind", choices=KINDS, help="what to begin")
    parser.add_argument("name", metavar="NAME", help="its name, e.g. served_on")
    parser.add_argument(
        "--into",
        type=Path,
        metavar="FILE",
        help="the file to write; a term is added at its end (default: NAME.ttl, or NAME.bddl for a task)",
    )
    parser.add_argument("--iri", default="", help="the IRI of a new ontology (default: https://example.org/NAME)")
    parser.add_argument("--of", default="", metavar="KIND", help="a predicate's kind (default: man:ObjectRelation)")
    parser.add_argument("--admits", nargs="+", default=[], metavar="FAILURE", help="what a route admits")
    parser.add_argument("--supports", nargs="+", default=[], metavar="KIND", help="what a route supports")


def _run(arguments: argparse.Namespace) -> int:
    from onto_compiler.scaffold import templates  # noqa: PLC0415 - `onto --help` stays quick
    from onto_compiler.scaffold.names import read_name  # noqa: PLC0415
    from onto_compiler.scaffold.turtle import Options, added, new_ontology  # noqa: PLC0415

    kind: str = arguments.kind
    name = read_name(arguments.name)
    into: Path = arguments.into or Path(name.snake + (".bddl" if kind == "task" else ".ttl"))
    plain = Options()
    options = Options(
        arguments.iri,
        arguments.of or plain.kind,
        tuple(arguments.admits) or plain.admits,
        tuple(arguments.supports) or plain.supports,
    )
    if kind in {"ontology", "task"}:
        if into.exists():
            raise OntoError.of("NEW004", f"`{into}` exists already", "give another file with --into", str(into))
        sentence = name.text.capitalize()
        new = _laid_out(new_ontology(name, options), into) if kind == "ontology" else ""
        text = new or templates.TASK.format(sentence=sentence)
    else:
        before = _read(into) or _laid_out(new_ontology(name, options), into)
        text = added(kind, name, into, before, options)
        # A file that somebody lays out in another way keeps its ways.
        if before == _laid_out(before, into):
            text = _laid_out(text, into)
    _write(into, text)
    sys.stdout.write(f"{into}\n")
    sys.stderr.write(f"wrote the {kind} `{name.snake}`; next: edit it, and run `onto check {into}`\n")
    return CLEAN


def _read(path: Path) -> str:
    """A file's text; nothing where there is no file yet."""
    try:
        return path.read_bytes().decode("utf-8-sig") if path.exists() else ""
    except (OSError, UnicodeDecodeError) as error:
        raise OntoError.of("NEW004", f"cannot read `{path}`: {error}", "give a text file in UTF-8", str(path)) from None


def _laid_out(text: str, path: Path) -> str:
    """Turtle as `onto fmt` lays it out; as it is where it holds what `onto fmt` does not know."""
    from onto_compiler.turtle.layout import format_turtle  # noqa: PLC0415 - `onto --help` stays quick

    try:
        return format_turtle(text, path)
    except OntoError as error:
        if {problem.code for problem in error.problems} != {"FMT001"}:
            raise
        return text


def _write(path: Path, text: str) -> None:
    try:
        path.write_bytes(text.encode())
    except OSError as error:
        message = f"cannot write `{path}`: {error.strerror or error}"
        raise OntoError.of("NEW004", message, "give a file in a folder that exists, with --into", str(path)) from None


NEW = Command(
    name="new",
    help="Begin an ontology, a predicate, a failure, a route or a task with a text that passes `onto check`.",
    example="onto new predicate served_on --into kitchen.ttl",
    configure=_configure,
    run=_run,
)
