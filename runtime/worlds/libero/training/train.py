"""The training of LIBERO-Goal's world model, stage by stage; each leaves one checkpoint, with its card, in a folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from grounding.world_model import dynamics as dynamics_module
from grounding.world_model.checkpoint import Card, save
from grounding.world_model.dynamics import Dynamics
from grounding.world_model.encoder import encoder
from grounding.world_model.model import FILES, load_dynamics
from grounding.world_model.projection import Projected, load_projected, save_projection
from grounding.world_model.projection import fit as fit_projection
from grounding.world_model.scene import SCENE_EVENTS, SCENE_FACTS, SceneEventHead, SceneFactHead
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from runtime.training.fit import Schedule
from runtime.training.stages import Fitter, Log, TrainingDir, head_parameters, train_stage
from runtime.worlds.libero.training.config import SceneTrainingConfig
from runtime.worlds.libero.training.film import MACRO, PIXELS
from runtime.worlds.libero.training.hand import PLACES, SIZE
from runtime.worlds.libero.training.heads import WindowSampler, calibrate, event_loss, fact_loss, sensed_still
from runtime.worlds.libero.training.library import Filmed, FilmRequest, filmed
from runtime.worlds.libero.training.measure import event_metrics, fact_metrics, imagining_metrics
from runtime.worlds.libero.training.scene import SceneFacts, scene_facts
from runtime.worlds.libero.training.windows import Windows, pictures_of, windows

__all__ = ["FilmPlace", "load_windows", "train"]

_FITTED = 4000
"""The largest number of pictures for fitting the projection."""
_ACTIONS = 7
_SEES = "pixels, proprioception"
_LABELS = f"{_SEES}; labels of privileged-state"


@dataclass(frozen=True)
class FilmPlace(TrainingDir):
    """A place with films and demonstrations in ``data``, which seeds share.

    ``demos`` is as of :class:`~runtime.worlds.libero.training.library.FilmRequest`; ``jobs`` processes film.
    """

    data: Path
    demos: Path | None = None
    jobs: int = 1


def train(
    stage: str, config: SceneTrainingConfig, place: FilmPlace, command: str, commit: str, log: Log
) -> Mapping[str, float]:
    """Train one of :data:`runtime.training.STAGES` from the checkpoints in ``place``; returns the metrics of its card.

    Raises:
        OntoError: as :func:`runtime.worlds.pointmaze.training.train` and
        :func:`runtime.worlds.libero.training.library.filmed`.
    """
    makers = {"projection": _projection, "dynamics": _dynamics, "events": _events, "facts": _facts}
    return train_stage(stage, makers, config, place, command, commit, log)


def load_windows(config: SceneTrainingConfig, place: FilmPlace, split: str, seen: Projected, log: Log) -> Windows:
    """The windows of the split ``train`` or ``held``; makes missing films and features.

    Raises:
        OntoError: as :func:`train`; ``WM016`` if the split has no demonstration.
    """
    films = _of_split(config, place, split, log)
    path = place.unfinished / f"features.{split}.npy"
    return windows(films, _suite_facts(), seen, path, log, place.device)


def _projection(config: SceneTrainingConfig, place: FilmPlace, card: Card, log: Log) -> Mapping[str, float]:
    base = encoder(config.encoder, place.device)
    base.encode(
        np.zeros((0, PIXELS, PIXELS, 3), dtype=np.uint8)
    )  # films take hours: fail before them if the encoder does
    films = _of_split(config, place, "train", log)
    rows, draw = pictures_of(films)
    some = rows[:: -(-len(rows) // _FITTED)]
    raw = np.concatenate([base.encode(draw(some[start : start + 256])) for start in range(0, len(some), 256)])
    projection = fit_projection(raw, min(config.components, raw.shape[1]))
    metrics = {"variance_kept": projection.share, "pictures": float(len(some)), "films": float(len(films))}
    save_projection(
        place.folder / FILES["projection"],
        Projected(base, projection),
        replace(card, sees="pixels", metrics=metrics),
    )
    return metrics


def _dynamics(config: SceneTrainingConfig, place: FilmPlace, card: Card, log: Log) -> Mapping[str, float]:
    seen = load_projected(place.folder / FILES["projection"], place.device)
    frames = load_windows(config, place, "train", seen, log).frames
    states = frames.states.reshape(-1, SIZE).astype(np.float64)
    motion = {
        "centre": states.mean(axis=0).round(4).tolist(),
        "scale": np.maximum(states.std(axis=0), 1e-3).round(4).tolist(),
        "bound": [1e6] * SIZE,
        "actions": _ACTIONS,
        "places": PLACES,
        "members": config.members,
    }
    parameters: dict[str, Any] = {
        "motion": motion,
        "features": seen.shape[0],
        "feature_scale": float(frames.features.std()),
        "macro": MACRO,
    }
    network = Dynamics(**parameters).to(place.device)
    schedules = {
        "motion": Schedule(config.motion),
        "appearance": Schedule(config.appearance, 1e-3, 1e-2),
        "estimate": Schedule(config.estimate),
    }
    card = replace(card, encoder=seen.identity)
    Fitter(place, card, log).dynamics(network, frames, sensed_still(SIZE).to(place.device), schedules)
    metrics = imagining_metrics(network, load_windows(config, place, "held", seen, log))
    about = replace(card, architecture=dynamics_module.ARCHITECTURE, parameters=parameters, sees=_SEES, metrics=metrics)
    save(place.folder / FILES["dynamics"], network.state_dict(), about)
    return metrics


def _events(config: SceneTrainingConfig, place: FilmPlace, card: Card, log: Log) -> Mapping[str, float]:
    sampler, parameters, card, seen = _for_heads(config, place, card, log)
    asked = _suite_facts()
    parameters = {"facts": len(asked.names), **parameters}
    head = SceneEventHead(**parameters).to(place.device)
    loss = event_loss(head, sampler, asked.goals)
    Fitter(place, card, log).fit("events", head, loss, Schedule(config.events, 1e-3, 1e-2))
    metrics: dict[str, float] = event_metrics(
        sampler.dynamics, head, asked, load_windows(config, place, "held", seen, log)
    )
    save(
        place.folder / FILES["events"],
        head.state_dict(),
        replace(card, architecture=SCENE_EVENTS, parameters=parameters, facts=asked.names, metrics=metrics),
    )
    return metrics


def _facts(config: SceneTrainingConfig, place: FilmPlace, card: Card, log: Log) -> Mapping[str, float]:
    sampler, parameters, card, seen = _for_heads(config, place, card, log)
    names = list(_suite_facts().names)
    units = np.maximum(sampler.data.margin.reshape(-1, len(names)).std(axis=0), 1e-3).round(4).tolist()
    parameters = {"facts": names, "units": units, **parameters}
    head = SceneFactHead(**parameters).to(place.device)
    Fitter(place, card, log).fit("facts", head, fact_loss(head, sampler), Schedule(config.facts, 1e-3, 1e-2))
    held = load_windows(config, place, "held", seen, log)
    calibrate(head, WindowSampler(sampler.dynamics, held).ends(np.arange(len(held))))
    metrics = fact_metrics(sampler.dynamics, head, _suite_facts().facts, held)
    about = replace(card, architecture=SCENE_FACTS, parameters=parameters, facts=tuple(names), metrics=metrics)
    save(place.folder / FILES["facts"], head.state_dict(), about)
    return metrics


def _for_heads(
    config: SceneTrainingConfig, place: FilmPlace, card: Card, log: Log
) -> tuple[WindowSampler, dict[str, Any], Card, Projected]:
    """The batch sampler of a head, its parameters, a card with its training data, and the encoder."""
    seen, network, found = load_dynamics(place.folder, place.device)
    data = load_windows(config, place, "train", seen, log)
    parameters = head_parameters(network, found.card.parameters["motion"])
    about = replace(card, data={**card.data, "dynamics": found.identity}, encoder=seen.identity, sees=_LABELS)
    return WindowSampler(network, data), parameters, about, seen


def _suite_facts() -> SceneFacts:
    return scene_facts(load_knowledge())


def _of_split(config: SceneTrainingConfig, place: FilmPlace, split: str, log: Log) -> tuple[Filmed, ...]:
    shoot = FilmRequest(place.data, config.demos, config.demo_seed, config.indices, demos=place.demos)
    films = tuple(film for film in filmed(shoot, place.jobs, log) if film.split == split)
    if not films:
        message = f"no demonstration starts from an initial state of the {split} split"
        raise OntoError.of(
            "WM016", message, "take 40 demonstrations a task, as many as there are initial states", str(place.data)
        )
    return films
