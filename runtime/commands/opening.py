"""From a command's arguments to an opened task."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from onto_compiler.bddl.impossible import refuse_impossible
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.loop.records import GIVEN
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.required import required_of
from runtime.worlds.world import named_task

__all__ = ["start_of", "task_runner"]


@contextmanager
def task_runner(options: argparse.Namespace, *, possible: bool = False) -> Iterator[EpisodeRunner]:
    """The runner for ``options.task`` under ``options.ontology`` and ``options.seed``; closed at the end.

    Raises:
        OntoError: as :func:`onto_compiler.bddl.impossible.refuse_impossible`, where the goal must be ``possible``.
    """
    knowledge = load_knowledge(*options.ontology)
    world, ref = named_task(options.task)
    proposers = world.proposers(knowledge.schema, dict(getattr(options, "proposer", ())))
    budget = getattr(options, "budget", None)
    if possible:
        refuse_impossible(required_of(ref, knowledge), knowledge.schema)
    # A line that moves while MuJoCo compiles; it shows on a terminal only.
    with Console(stderr=True).status(f"building the scene of {ref.name}"):
        runner = EpisodeRunner.open(world, ref, knowledge, proposers, options.seed, budget)
    try:
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


def _read(path: Path) -> NDArray[np.float64]:
    try:
        state = np.load(path, allow_pickle=False)
        return np.asarray(state, dtype=np.float64).ravel()
    except (OSError, EOFError, ValueError, TypeError, AttributeError) as error:
        raise OntoError.of(
            "CLI005", f"cannot read a state from `{path}`: {error}", "save it with numpy.save", str(path)
        ) from error
