"""The help: the list of commands, and each command's parser."""

from __future__ import annotations

import argparse
import re
import textwrap
from importlib.metadata import EntryPoint
from typing import Any, NoReturn

from onto_compiler.command import Command
from onto_compiler.problems import OntoError, near
from runtime.cli.discovery import advice, group_title, load_all

__all__ = ["TeachingParser", "overview", "parser_of"]

_INTRO = """\
usage: onto COMMAND [OPTIONS]
       onto --help | --version

Diagnose what a robot task lacks, repair it, and keep a record that SPARQL can question."""
_OUTRO = """\
`onto COMMAND --help` explains a command. Data goes to standard output, messages to standard error.
Exit codes: 0 clean, 1 findings, 2 misuse, 70 a fault of `onto` itself, 130 interrupted."""
_CHOICE = re.compile(r"invalid choice: '(?P<given>[^']*)' \(choose from (?P<known>.*)\)")
_WIDTH = 80


class TeachingParser(argparse.ArgumentParser):
    """An argument parser that raises :class:`OntoError` CLI002 instead of leaving the process."""

    def __init__(self, **options: Any) -> None:  # noqa: ANN401 - argparse's own keywords
        # Abbreviated options would break scripts on the day a longer option is added.
        options.setdefault("allow_abbrev", False)
        options.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(**options)

    def error(self, message: str) -> NoReturn:
        """Report a misuse of the command line with its nearest remedy."""
        hint = ""
        if match := _CHOICE.search(message):
            hint = near(match["given"], re.findall(r"[\w.-]+", match["known"]))
        raise OntoError.of("CLI002", f"`{self.prog}`: {message}", hint or f"see `{self.prog} --help`")


def parser_of(command: Command) -> TeachingParser:
    """The complete parser of one command, its example at the foot of its help."""
    parser = TeachingParser(
        prog=f"onto {command.name}",
        description=command.help,
        epilog=f"example:\n{textwrap.indent(command.example, '  ')}",
    )
    command.configure(parser)
    return parser


def overview(points: dict[str, EntryPoint]) -> str:
    """The text of ``onto --help``: every command with its sentence and its example, under its heading."""
    sections: dict[str, list[str]] = {}
    for name, command in load_all(points):
        if isinstance(command, ImportError):
            lines = _entry(name, f"Not available: {command}.", advice(command))
        else:
            lines = _entry(name, command.help, f"$ {command.example.splitlines()[0]}")
        sections.setdefault(group_title(points[name]), []).extend(lines)
    blocks = ["\n".join([f"{title}:", *lines]) for title, lines in sections.items()]
    return "\n\n".join([_INTRO, *blocks, _OUTRO]) + "\n"


def _entry(name: str, sentence: str, example: str) -> list[str]:
    indent = " " * 14
    first = textwrap.wrap(sentence, _WIDTH, initial_indent=f"  {name:<12}", subsequent_indent=indent)
    return [*first, f"{indent}{example}"] if example else first
