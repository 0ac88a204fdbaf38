"""``onto demo``: repair the ten LIBERO-Goal tasks, record the episodes, query them and write a report."""

from __future__ import annotations

import argparse
from pathlib import Path

from onto_compiler.command import Command, add_format, add_ontology
from runtime.commands.options import add_budget
from runtime.trace.options import add_identity

__all__ = ["DEMO"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", type=Path, default=Path("out/demo"), metavar="DIR", help="default out/demo")
    parser.add_argument("--suite", default="libero_goal", help="which suite's tasks (default libero_goal)")
    parser.add_argument("--state", type=int, default=0, metavar="N", help="official initial state, from 0 (default 0)")
    parser.add_argument("--seed", type=int, default=0, help="places the fixtures (default 0)")
    add_budget(parser)
    add_identity(parser)
    add_ontology(parser)
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    from runtime.worlds.pictures import enable  # noqa: PLC0415 - heavy imports wait for the command to run

    drawing = enable()  # before MuJoCo is imported, which settles how it draws
    from runtime.commands.demonstration import demonstrate  # noqa: PLC0415

    return demonstrate(options, drawing=drawing)


DEMO = Command(
    name="demo",
    help="Diagnose, repair and verify the ten LIBERO-Goal tasks from their initial states, and report it.",
    example="onto demo --json",
    configure=_configure,
    run=_run,
)
