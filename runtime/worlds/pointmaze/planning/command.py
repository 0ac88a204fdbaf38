"""``onto plan``: play trials with the rows of a comparison, and print, record and draw the plans."""

from __future__ import annotations

import argparse
from pathlib import Path

from onto_compiler.command import Command, add_format
from runtime.trace.options import add_identity

__all__ = ["PLAN"]


def _configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("world", choices=("pointmaze",), help="where to plan")
    parser.add_argument("--row", nargs="+", default=["onto"], metavar="NAME", help="who plans (default onto)")
    parser.add_argument("--trials", default="0", metavar="N", help="numbers, as 7 or 0-49 or 0-9,20 (default 0)")
    parser.add_argument("--model", type=Path, metavar="DIR", help="a world model's folder; default: the shipped one")
    parser.add_argument(
        "--seed", type=int, default=0, help="of the search, and which of the shipped models it is (default 0)"
    )
    parser.add_argument("--trace", type=Path, metavar="FILE", help="also record the trials, as .trig, .nq or .jsonld")
    add_identity(parser)
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="also draw plans, margins and reliability, as .html"
    )
    add_format(parser)


def _run(options: argparse.Namespace) -> int:
    """Play; exit code 1 where a trial did not reach its target."""
    from runtime.worlds.pointmaze.planning.playing import run  # noqa: PLC0415 - torch takes a second to import

    return run(options)


PLAN = Command(
    name="plan",
    help="Plan in a world model, execute, and compare the predictions with the simulator.",
    example="onto plan pointmaze --row onto search --trials 0-9 --picture out/plans.html",
    configure=_configure,
    run=_run,
)
