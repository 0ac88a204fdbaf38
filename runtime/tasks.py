"""What a person types for a task, and the flags that the commands share."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from onto_compiler.problems import OntoError
from runtime.simulator.assets import TaskRef, find_task, suites

__all__ = ["add_state", "add_task", "read_state", "resolve_task"]


def add_task(parser: argparse.ArgumentParser) -> None:
    """The positional argument TASK."""
    parser.add_argument("task", help="SUITE/INDEX or SUITE/NAME, e.g. libero_goal/8, or the path of a BDDL file")


def add_state(parser: argparse.ArgumentParser) -> None:
    """Where to start: ``--state``, ``--state-file`` and ``--seed``."""
    parser.add_argument("--state", type=int, default=0, metavar="N", help="official initial state, from 0 (default 0)")
    parser.add_argument(
        "--state-file", type=Path, metavar="FILE.npy", help="start from your own flat state instead: time, qpos, qvel"
    )
    parser.add_argument("--seed", type=int, default=0, help="places the fixtures (default 0)")


def resolve_task(text: str) -> TaskRef:
    """The task that ``text`` names.

    Raises:
        OntoError: ``CLI004`` for a text of neither form, ``SIM010`` to ``SIM012`` for what the installed LIBERO lacks.
    """
    path = Path(text)
    if path.suffix == ".bddl":
        # Only official tasks have official initial states; any other starts from a seeded reset.
        return TaskRef("", 0, path.stem, path, Path())
    suite, slash, name = text.partition("/")
    if not slash or not name:
        raise OntoError.of(
            "CLI004", f"`{text}` names no task", f"write SUITE/INDEX with a suite such as {', '.join(suites()[:5])}"
        )
    return find_task(suite, int(name) if name.isdigit() else name)


def read_state(path: Path | None) -> NDArray[np.float64] | None:
    """The flat state in a ``.npy`` file, or None without a path.

    Raises:
        OntoError: ``CLI005``, where the file does not hold one plain array of numbers.
    """
    if path is None:
        return None
    try:
        state = np.load(path, allow_pickle=False)
        return np.asarray(state, dtype=np.float64).ravel()
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise OntoError.of(
            "CLI005", f"cannot read a state from `{path}`: {error}", "save it with numpy.save", str(path)
        ) from error
