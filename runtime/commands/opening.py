"""Open a task by its name, and find the initial state that an argument means."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.console import Console

from onto_compiler.bddl.impossible import refuse_impossible
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.loop.records import GIVEN
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.required import required_of
from runtime.worlds.world import named_task

__all__ = ["open_task", "start_of"]


@contextmanager
def open_task(
    task: str,
    ontology: Sequence[str | Path] = (),
    seed: int | None = None,
    budget: int | None = None,
    judge: str = "native",
    *,
    proposers: Mapping[str, str] | None = None,
    possible: bool = False,
    model: str | None = None,
    imports: Sequence[str] = (),
) -> Iterator[EpisodeRunner]:
    """The runner for ``task`` under the shipped ontology with ``ontology`` on top; closed at the end.

    ``model`` is a file with the fixtures' poses; ``imports`` are modules that register objects of your own.
    ``proposers`` chooses among several proposers of a route.

    Raises:
        OntoError: as :func:`onto_compiler.bddl.impossible.refuse_impossible`, where the goal must be ``possible``.
    """
    knowledge = load_knowledge(*ontology)
    world, ref = named_task(task)
    world.prepare(ref, imports)
    offered = world.proposers(knowledge.schema, dict(proposers or {}))
    if possible:
        refuse_impossible(required_of(ref, knowledge), knowledge.schema)
    # A line that moves while MuJoCo compiles; it shows on a terminal only.
    with Console(stderr=True).status(f"building the scene of {ref.name}"):
        runner = EpisodeRunner.open(world, ref, knowledge, offered, seed, budget, judge)
    try:
        yield runner if model is None else runner.placing(model)
    finally:
        runner.close()


def start_of(state: int | str | Path | ArrayLike) -> tuple[int, NDArray[np.float64] | None]:
    """The number of an official initial state, and None; or :data:`GIVEN` and a flat state, of a file or as it is.

    Raises:
        OntoError: ``CLI005`` if there is no plain array of numbers.
    """
    if isinstance(state, (int, np.integer)):
        return int(state), None
    name = f"`{state}`" if isinstance(state, (str, Path)) else "what was given"
    try:
        found = np.load(state, allow_pickle=False) if isinstance(state, (str, Path)) else state
        return GIVEN, np.asarray(found, dtype=np.float64).ravel()
    except (OSError, EOFError, ValueError, TypeError, AttributeError) as error:
        file = str(state) if isinstance(state, (str, Path)) else ""
        raise OntoError.of(
            "CLI005", f"cannot read a state from {name}: {error}", "save it with numpy.save", file
        ) from error
