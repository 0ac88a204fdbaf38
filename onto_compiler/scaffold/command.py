"""The subcommand ``onto new``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from onto_compiler.command import CLEAN, Command
from onto_compiler.problems import OntoError

if TYPE_CHECKING:  # `onto --help` reads this module, and stays without Oxigraph
    from onto_compiler.scaffold.names import WordedName
    from onto_compiler.scaffold.values import Options

__all__ = ["NEW"]

_TAKES = {
    "ontology": ("iri",),
    "predicate": ("iri", "of", "arity", "domain", "range", "unit", "grounded_by"),
    "failure": ("iri",),
    "route": ("iri", "admits", "supports"),
    "binding": ("iri", "lifts", "native", "grounded_by"),
    "task": (),
    "grounding": ("iri", "arity"),
    "proposer": (),
    "package": ("iri",),
}
"""What can be begun, and the options that say something of it."""
KINDS = tuple(_TAKES)
_MODULES = frozenset(("grounding", "proposer", "package"))
_ENDINGS = {"task": ".bddl", "grounding": ".py", "proposer": ".py", "package": ""}


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("kind", choices=KINDS, help="what to begin")
    parser.add_argument(
        "name", metavar="NAME", help="its name, e.g. served_on; of a proposer, the route that it serves"
    )
    parser.add_argument(
        "--into",
        type=Path,
        metavar="FILE",
        help="the file to write, a package's folder; a term is added at the file's end (default: NAME.ttl, NAME.bddl "
        "for a task, NAME.py for a grounding function or a proposer, NAME for a package)",
    )
    parser.add_argument("--iri", help="the IRI of a new ontology (default: https://example.org/NAME)")
    parser.add_argument("--of", metavar="KIND", help="a predicate's kind (default: man:ObjectRelation)")
    parser.add_argument("--arity", type=int, metavar="N", help="how many arguments it takes: 1 or 2 (default: 2)")
    parser.add_argument("--domain", metavar="CLASS", help="of the first argument (default: man:Object)")
    parser.add_argument("--range", metavar="CLASS", help="of the second argument (default: man:Object)")
    parser.add_argument("--unit", metavar="UNIT", help="of a predicate's margin (default: unit:M)")
    parser.add_argument(
        "--grounded-by", metavar="FUNCTION", help="what measures it (default of a predicate of two: on_object)"
    )
    parser.add_argument("--lifts", metavar="PREDICATE", help="what a binding lifts its atom to")
    parser.add_argument("--native", metavar="ATOM", help="the atom of a binding in task files (default: Name)")
    parser.add_argument("--admits", nargs="+", metavar="FAILURE", help="what a route admits")
    parser.add_argument("--supports", nargs="+", metavar="KIND", help="what a route supports")


def _run(arguments: argparse.Namespace) -> int:
    from onto_compiler.scaffold.names import read_name  # noqa: PLC0415 - `onto --help` stays quick

    kind: str = arguments.kind
    name = read_name(arguments.name, module=kind in _MODULES)
    into: Path = arguments.into or Path(name.snake + _ENDINGS.get(kind, ".ttl"))
    options = _options(arguments)
    written = tuple(_new(kind, name, into, options))
    for path, text in written:
        _write(path, text, folders=kind == "package")
        sys.stdout.write(f"{path}\n")
    sys.stderr.write(_next(kind, name, into))
    return CLEAN


def _options(arguments: argparse.Namespace) -> Options:
    from onto_compiler.scaffold.values import Options  # noqa: PLC0415 - as above

    names = {option for options in _TAKES.values() for option in options}
    given = {name: value for name in names if (value := getattr(arguments, name)) is not None}
    for option in sorted(given.keys() - _TAKES[arguments.kind]):
        flag = f"--{option.replace('_', '-')}"
        takers = [kind for kind, options in _TAKES.items() if option in options]
        message = f"`{flag}` says nothing of a new {arguments.kind}"
        raise OntoError.of("NEW006", message, f"leave it out; it is an option of: {', '.join(takers)}")
    if "of" in given:
        given["kind"] = given.pop("of")
    return Options(**given)


def _new(kind: str, name: WordedName, into: Path, options: Options) -> Iterable[tuple[Path, str]]:
    """The files to write, with their texts; nothing that exists is among them, but for a file that gets a term."""
    from onto_compiler.registered import GROUNDINGS, points  # noqa: PLC0415 - as above
    from onto_compiler.scaffold import templates  # noqa: PLC0415
    from onto_compiler.scaffold.package import module, package  # noqa: PLC0415
    from onto_compiler.scaffold.turtle import added, new_ontology  # noqa: PLC0415

    if options.arity not in (1, 2):
        raise OntoError.of("NEW006", f"an arity of {options.arity} is not supported", "give --arity 1 or 2")
    term = kind not in {"ontology", "task", *_MODULES} or (kind == "grounding" and into.suffix == ".ttl")
    empty = kind == "package" and into.is_dir() and not any(into.iterdir())
    if into.exists() and not term and not empty:
        raise OntoError.of("NEW004", f"`{into}` exists already", "give another file with --into", str(into))
    if kind in {"grounding", "package"} and name.snake in {point.name for point in points(GROUNDINGS)}:
        message = f"a grounding function `{name.snake}` is registered already"
        raise OntoError.of("NEW002", message, "choose another name")
    if kind == "package":
        return [
            (path, _laid_out(text, path) if path.suffix == ".ttl" else text)
            for path, text in package(name, options, into)
        ]
    if kind == "task":
        return [(into, templates.TASK.format(sentence=name.text.capitalize()))]
    if kind in _MODULES and not term:
        return [(into, module(kind, name, options.arity))]
    if kind == "ontology":
        return [(into, _laid_out(new_ontology(name, options), into))]
    before = _read(into) or _laid_out(new_ontology(name, options), into)
    text = added(kind, name, into, before, options)
    # A file that somebody lays out in another way keeps its ways.
    return [(into, _laid_out(text, into) if before == _laid_out(before, into) else text)]


def _next(kind: str, name: WordedName, into: Path) -> str:
    from shlex import quote  # noqa: PLC0415 - as above

    from onto_compiler.scaffold.package import entry_point  # noqa: PLC0415

    wrote = f"wrote the {kind} `{name.snake}`; next: "
    if kind == "package":
        return f"{wrote}`pip install -e {quote(str(into))}`, then `pytest {quote(str(into))}`\n"
    if kind in _MODULES and into.suffix != ".ttl":
        return f"{wrote}edit it, and register it in `pyproject.toml`:\n\n{entry_point(kind, name)}"
    return f"{wrote}edit it, and run `onto check {quote(str(into))}`\n"


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


def _write(path: Path, text: str, *, folders: bool) -> None:
    try:
        if folders:
            path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
    except OSError as error:
        message = f"cannot write `{path}`: {error.strerror or error}"
        raise OntoError.of("NEW004", message, "give a file in a folder that exists, with --into", str(path)) from None


NEW = Command(
    name="new",
    help="Begin an ontology, a term of one, a task, a grounding function, a proposer or a whole package.",
    example="onto new predicate served_on --range man:Support --into kitchen.ttl",
    configure=_configure,
    run=_run,
)
