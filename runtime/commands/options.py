"""Arguments that several commands share; light, as the help of every command imports it."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

__all__ = [
    "add_budget",
    "add_state",
    "add_task",
    "chosen_state",
    "control_steps",
    "settled_words",
    "start_options",
    "uncertain_lines",
]


class _InSuite(argparse.Action):
    """Joins a suite and the index or name that follows it."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> None:
        del parser, option_string
        if values is not None:
            namespace.task = f"{namespace.task}/{values}"


def add_task(parser: argparse.ArgumentParser) -> None:
    """The positional argument TASK, also as two words."""
    parser.add_argument("task", help="SUITE/INDEX or SUITE/NAME, e.g. libero_goal/8, or the path of a BDDL file")
    parser.add_argument(
        "within", nargs="?", action=_InSuite, metavar="INDEX", help="index or name, where the first is a suite alone"
    )
    parser.add_argument(
        "--import",
        dest="imports",
        action="append",
        default=[],
        metavar="MODULE",
        help="import this module first, which registers objects or predicates of your own with LIBERO; it may stand "
        "beside the task file or in the working folder",
    )


def add_state(parser: argparse.ArgumentParser) -> None:
    """Where to start: ``--state``, ``--state-file`` and ``--seed``."""
    start = parser.add_mutually_exclusive_group()
    start.add_argument("--state", type=int, default=0, metavar="N", help="official initial state, from 0 (default 0)")
    start.add_argument(
        "--state-file", type=Path, metavar="FILE.npy", help="start from your own flat state instead: time, qpos, qvel"
    )
    placed = parser.add_mutually_exclusive_group()
    placed.add_argument("--seed", type=int, help="places the fixtures, as LIBERO's reset does after it (default 0)")
    placed.add_argument(
        "--model",
        metavar="FILE",
        help="the fixtures stand as in this file: MJCF that was saved from the scene, or demonstrations in HDF5 "
        "(FILE.hdf5/demo_3 for one of them)",
    )
    parser.add_argument(
        "--settle",
        type=control_steps,
        metavar="N",
        help="control steps without motion before the start is judged (default: 10 for an official initial state, "
        "0 for your own)",
    )


def uncertain_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """As text: the facts whose verdict depends on fixture poses that neither --model nor --seed gives."""
    lines = [
        f"  uncertain: {row['fact']} hangs on where {' and '.join(row['fixtures'])} stood, which the state does not "
        f"say; seed 0 is assumed, and another placement is up to {row['reach'] * 1000:.0f} mm away"
        for row in rows
    ]
    return [*lines, "  --model FILE or --seed N says where fixtures stand"] if lines else []


def start_options(options: argparse.Namespace) -> dict[str, Any]:
    """The options for a run's start, by the parameter names of :mod:`runtime.commands.tasks`."""
    return {
        "state": chosen_state(options),
        "seed": options.seed,
        "settle": options.settle,
        "model": options.model,
        "imports": options.imports,
    }


def settled_words(steps: int) -> str:
    """How a start was settled, for a heading."""
    return f"settled for {steps} step{'' if steps == 1 else 's'}" if steps else "not settled"


def control_steps(text: str, least: int = 0) -> int:
    """A number of control steps on the command line, ``least`` or more."""
    try:
        steps = int(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"`{text}` is not a number of control steps") from error
    if steps < least:
        raise argparse.ArgumentTypeError(f"{steps} control steps; give {least} or more")
    return steps


def chosen_state(options: argparse.Namespace) -> int | Path:
    """The number of the initial state to start from, or the file that holds one."""
    number: int = options.state
    path: Path | None = options.state_file
    return number if path is None else path


def add_budget(parser: argparse.ArgumentParser) -> None:
    """How many attempts the loop may make."""
    parser.add_argument("--budget", type=int, metavar="B", help="attempts that the loop may make")
