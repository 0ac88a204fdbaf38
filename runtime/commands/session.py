"""What the commands share: an ontology, its proposers, and an opened task."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from onto_compiler.knowledge import load_knowledge
from runtime.episodes import BUDGET, EpisodeRunner
from runtime.proposers.registry import load_proposers
from runtime.tasks import resolve_task

__all__ = ["open_runner"]


@contextmanager
def open_runner(options: argparse.Namespace) -> Iterator[EpisodeRunner]:
    """The runner for ``options.task`` under ``options.ontology`` and ``options.seed``; closed at the end."""
    knowledge = load_knowledge(*options.ontology)
    budget = getattr(options, "budget", BUDGET)
    runner = EpisodeRunner.open(
        resolve_task(options.task), knowledge, load_proposers(knowledge.schema), options.seed, budget
    )
    try:
        yield runner
    finally:
        runner.close()
