"""What `onto train libero` runs."""

from __future__ import annotations

from onto_compiler.batch import available_jobs
from onto_compiler.problems import OntoError
from runtime.training.request import Stage, TrainingRequest, given
from runtime.worlds.libero.training.config import SceneTrainingConfig
from runtime.worlds.libero.training.train import FilmPlace, train

__all__ = ["stages"]


def stages(asked: TrainingRequest) -> Stage:
    """The training of the request ``asked``; raises ``CLI002`` for less than one demonstration."""
    if asked.count is not None and asked.count < 1:
        raise OntoError.of("CLI002", f"--count must be at least 1, and is {asked.count}")
    config = SceneTrainingConfig(seed=asked.seed, **given(encoder=asked.encoder, demos=asked.count))
    place = FilmPlace(asked.folder, asked.folder.parent / "data", asked.demos, asked.threads or available_jobs())
    return lambda stage, command, commit, log: train(stage, config, place, command, commit, log)
