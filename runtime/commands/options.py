"""Arguments that several commands share; light, as the help of every command imports it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

__all__ = ["add_budget", "add_state", "add_task", "chosen_state"]


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


def add_state(parser: argparse.ArgumentParser) -> None:
    """Where to start: ``--state``, ``--state-file`` and ``--seed``."""
    start = parser.add_mutually_exclusive_group()
    start.add_argument("--state", type=int, default=0, metavar="N", help="official initial state, from 0 (default 0)")
    start.add_argument(
        "--state-file", type=Path, metavar="FILE.npy", help="start from your own flat state instead: time, qpos, qvel"
    )
    parser.add_argument("--seed", type=int, default=0, help="places the fixtures (default 0)")


def chosen_state(options: argparse.Namespace) -> int | Path:
    """The number of the initial state to start from, or the file that holds one."""
    number: int = options.state
    path: Path | None = options.state_file
    return number if path is None else path


def add_budget(parser: argparse.ArgumentParser) -> None:
    """How many attempts the loop may make."""
    parser.add_argument("--budget", type=int, metavar="B", help="attempts that the loop may make")
