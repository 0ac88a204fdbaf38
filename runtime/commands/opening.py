"""From a command's arguments to an opened task."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.loop.records import GIVEN
from runtime.loop.registry import load_proposers
from runtime.worlds.libero.demos.fixtures import fixtures_of
from runtime.worlds.libero.loop.episodes import EpisodeRunner
from runtime.worlds.libero.loop.uncertain import uncertain_line, uncertain_row
from runtime.worlds.libero.simulator.assets import named_task
from runtime.worlds.libero.simulator.own_code import import_own

__all__ = ["start_of", "task_runner", "uncertain_lines", "uncertain_rows"]


@contextmanager
def task_runner(options: argparse.Namespace) -> Iterator[EpisodeRunner]:
    """The runner for ``options.task`` under ``options.ontology`` and ``options.seed``; closed at the end."""
    knowledge = load_knowledge(*options.ontology)
    proposers = load_proposers(knowledge.schema)
    budget = getattr(options, "budget", None)
    ref = named_task(options.task)
    import_own(options.imports, ref.bddl.parent)
    # A line that moves while MuJoCo compiles; it shows on a terminal only.
    with Console(stderr=True).status(f"building the scene of {ref.name}"):
        runner = EpisodeRunner.open(ref, knowledge, proposers, options.seed, budget)
    try:
        if options.model is not None:
            runner = runner.placing(fixtures_of(options.model, runner.task.model), options.model)
        yield runner
    finally:
        runner.close()


def start_of(options: argparse.Namespace) -> tuple[int, NDArray[np.float64] | None]:
    """Number of the official initial state to start from, and None; or :data:`GIVEN` and the state of a file.

    Raises:
        OntoError: ``CLI005``, where the file does not hold one plain array of numbers.
    """
    path: Path | None = options.state_file
    return (options.state, None) if path is None else (GIVEN, _read(path))


def uncertain_rows(runner: EpisodeRunner, start: int) -> list[dict[str, Any]]:
    """The required facts whose verdict hangs on where fixtures stand, where neither --model nor --seed says it."""
    return [uncertain_row(each, runner.knowledge.schema) for each in runner.uncertain(start)]


def uncertain_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The same for people."""
    how = "  --model FILE or --seed N says where fixtures stand"
    return [*(f"  {uncertain_line(row)}" for row in rows), how] if rows else []


def _read(path: Path) -> NDArray[np.float64]:
    try:
        state = np.load(path, allow_pickle=False)
        return np.asarray(state, dtype=np.float64).ravel()
    except (OSError, EOFError, ValueError, TypeError, AttributeError) as error:
        raise OntoError.of(
            "CLI005", f"cannot read a state from `{path}`: {error}", "save it with numpy.save", str(path)
        ) from error
