"""Subcommands of ``onto``. Packages register theirs in the entry-point group ``onto_evwm.commands``.

A command's module imports what is heavy inside :attr:`Command.run`, so that ``onto --help`` stays quick.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = ["CLEAN", "FINDINGS", "MISUSE", "Command", "add_format", "add_ontology", "print_json"]

CLEAN, FINDINGS, MISUSE = 0, 1, 2  # exit codes, as Ruff's


@dataclass(frozen=True, slots=True)
class Command:
    """``help`` is one sentence; ``example`` is a command line that works; ``run`` returns the exit code."""

    name: str
    help: str
    example: str
    configure: Callable[[argparse.ArgumentParser], None]
    run: Callable[[argparse.Namespace], int]


def add_format(parser: argparse.ArgumentParser, *others: str) -> None:
    """Give ``parser`` the options ``--format text|json|...`` and ``--json``, its short form."""
    choices = ("text", "json", *others)
    parser.add_argument("--format", choices=choices, default="text", help="what to print on standard output")
    parser.add_argument("--json", dest="format", action="store_const", const="json", help="short for --format json")


def add_ontology(parser: argparse.ArgumentParser) -> None:
    """Give ``parser`` the option ``--ontology PATH...``: the user's own Turtle on top of the shipped one."""
    parser.add_argument(
        "--ontology",
        nargs="+",
        default=[],
        metavar="PATH",
        help="Turtle files or folders that are added to the shipped ontology",
    )


def print_json(value: Any) -> None:  # noqa: ANN401 - any value that json.dumps accepts
    """Write ``value`` to standard output; NaN and infinities, which JSON lacks, become null."""
    json.dump(_finite(value), sys.stdout, indent=2, ensure_ascii=False, allow_nan=False)
    sys.stdout.write("\n")


def _finite(value: Any) -> Any:  # noqa: ANN401
    if isinstance(value, float):
        return value if value == value and abs(value) != float("inf") else None  # noqa: PLR0124 - NaN differs from itself
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value
