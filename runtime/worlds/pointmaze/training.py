"""The training of PointMaze's world model, stage by stage; each leaves one checkpoint, with its card, in a folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch

from grounding.world_model import dynamics as dynamics_module
from grounding.world_model import events as events_module
from grounding.world_model import facts as facts_module
from grounding.world_model.checkpoint import Card, save
from grounding.world_model.dynamics import Dynamics
from grounding.world_model.encoder import DEFAULT, encoder
from grounding.world_model.events import EventHead
from grounding.world_model.facts import FactHead
from grounding.world_model.model import FILES, load_dynamics
from grounding.world_model.projection import Projected, load_projected, save_projection
from grounding.world_model.projection import fit as fit_projection
from onto_compiler.knowledge import load_knowledge
from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name
from runtime.training.config import TrainingConfig
from runtime.training.fit import Schedule
from runtime.training.frames import HORIZON, Frames, encoded
from runtime.training.heads import LabelFunctions, RolloutEnds, RolloutSampler, event_loss, fact_loss
from runtime.training.measures import auroc, calibration_error
from runtime.training.request import Stage, TrainingRequest, given
from runtime.training.stages import Fitter, Log, TrainingDir, head_parameters, train_stage
from runtime.worlds.pointmaze.geodesic import Geodesic
from runtime.worlds.pointmaze.grounded import MazeFacts, required_facts
from runtime.worlds.pointmaze.maze import MACRO_STEPS, MAX_SPEED, STATE_DIM, Maze, maze_named
from runtime.worlds.pointmaze.picture import draw
from runtime.worlds.pointmaze.planning.sensing import POSITION
from runtime.worlds.pointmaze.trajectories import Split, Trajectories, collect

__all__ = ["MazeTrainingConfig", "stages", "train"]

_TEST = 200
"""Trajectories of the test split, on which a card's metrics are measured."""


def stages(asked: TrainingRequest) -> Stage:
    """The training of the request ``asked``; raises ``CLI002`` for options about demonstrations."""
    if asked.demos is not None or asked.count is not None:
        raise OntoError.of("CLI002", "`pointmaze` has no demonstrations to choose", "leave --demos and --count out")
    config = MazeTrainingConfig(seed=asked.seed, **given(encoder=asked.encoder))
    place = TrainingDir(asked.folder)
    return lambda stage, command, commit, log: train(stage, config, place, command, commit, log)


@dataclass(frozen=True, slots=True, kw_only=True)
class MazeTrainingConfig(TrainingConfig):
    """``trajectories`` of ``steps`` environment steps in ``maze``; ``heads``: optimiser steps of each head."""

    maze: str = "u_maze"
    encoder: str = DEFAULT
    trajectories: int = 2000
    steps: int = 100
    components: int = 128
    motion: int = 12000
    appearance: int = 2000
    estimate: int = 3000
    heads: int = 3000


def train(
    stage: str, config: MazeTrainingConfig, place: TrainingDir, command: str, commit: str, log: Log
) -> Mapping[str, float]:
    """Train one of :data:`runtime.training.STAGES` from the checkpoints in ``place``; returns the metrics of its card.

    An interrupted stage resumes where it stopped.

    Raises:
        OntoError: ``WM001`` ff. if an earlier stage's checkpoint is missing or damaged, ``WM006`` if the
        folder
            cannot be written.
    """
    makers = {"projection": _projection, "dynamics": _dynamics, "events": _events, "facts": _facts}
    return train_stage(stage, makers, config, place, command, commit, log)


def _projection(config: MazeTrainingConfig, place: TrainingDir, card: Card, log: Log) -> Mapping[str, float]:
    maze, base = maze_named(config.maze), encoder(config.encoder, place.device)
    found = _trajectories(config, "train")
    raw = _pictures(maze, found, base, place, log)
    projection = fit_projection(np.asarray(raw[:: max(len(raw) // 10_000, 1)]), min(config.components, raw.shape[1]))
    metrics = {"variance_kept": projection.share}
    about = replace(card, sees="pixels", metrics=metrics)
    save_projection(place.folder / FILES["projection"], Projected(base, projection), about)
    return metrics


def _dynamics(config: MazeTrainingConfig, place: TrainingDir, card: Card, log: Log) -> Mapping[str, float]:
    seen = load_projected(place.folder / FILES["projection"], place.device)
    frames = _frames(config, "train", seen, place, log)
    places = frames.states[..., :2].reshape(-1, 2).astype(np.float64)
    low, high = places.min(axis=0), places.max(axis=0)
    middle, half = ((low + high) / 2).round(2).tolist(), round(float((high - low).max() / 2), 2)
    motion = {
        "centre": [*middle, 0.0, 0.0],
        "scale": [half, half, MAX_SPEED, MAX_SPEED],
        "bound": [1e6, 1e6, MAX_SPEED, MAX_SPEED],
        "actions": frames.actions.shape[-1],
        "members": config.members,
    }
    parameters: dict[str, Any] = {
        "motion": motion,
        "features": seen.shape[0],
        "feature_scale": float(np.asarray(frames.features).std()),
        "macro": MACRO_STEPS,
    }
    network = Dynamics(**parameters).to(place.device)
    schedules = {
        "motion": Schedule(config.motion),
        "appearance": Schedule(config.appearance, rate=1e-3),
        "estimate": Schedule(config.estimate),
    }
    card = replace(card, encoder=seen.identity)
    Fitter(place, card, log).dynamics(network, frames, torch.tensor(POSITION, device=place.device), schedules)
    metrics = _imagining(network, _frames(config, "test", seen, place, log))
    about = replace(
        card, architecture=dynamics_module.ARCHITECTURE, parameters=parameters, sees="pixels, proprioception",
        metrics=metrics,
    )  # fmt: skip
    save(place.folder / FILES["dynamics"], network.state_dict(), about)
    return metrics


def _events(config: MazeTrainingConfig, place: TrainingDir, card: Card, log: Log) -> Mapping[str, float]:
    sampler, parameters, card = _for_heads(config, place, "train", card, log)
    head = EventHead(**parameters).to(place.device)
    Fitter(place, card, log).fit("events", head, event_loss(head, sampler), Schedule(config.heads))
    ends = _tested(config, place, log)
    found = head(*ends.read)
    success = (ends.margins[:, sampler.labels.success] > 0).cpu().numpy()
    clear = (ends.margins[:, sampler.labels.valid] > 0).cpu().numpy()
    there = torch.isfinite(ends.remaining)
    metrics = {
        "remaining_mae_m": float((found.remaining - ends.remaining)[there].abs().mean()),
        "success_auroc": auroc(found.success.cpu().numpy(), success),
        "feasibility_auroc": auroc(found.feasibility.cpu().numpy(), clear),
        "uncertainty_mae": float((found.uncertainty - ends.error).abs().mean()),
    }
    about = replace(card, architecture=events_module.ARCHITECTURE, parameters=parameters, metrics=metrics)
    save(place.folder / FILES["events"], head.state_dict(), about)
    return metrics


def _facts(config: MazeTrainingConfig, place: TrainingDir, card: Card, log: Log) -> Mapping[str, float]:
    sampler, parameters, card = _for_heads(config, place, "train", card, log)
    names = [local_name(fact.predicate) for fact in required_facts(load_knowledge()).facts]
    parameters = {"facts": names, **parameters}
    head = FactHead(**parameters).to(place.device)
    Fitter(place, card, log).fit("facts", head, fact_loss(head, sampler), Schedule(config.heads))
    ends = _tested(config, place, log)
    margin, logit = head(*ends.read)
    truth, score = (ends.margins > 0).cpu().numpy(), logit.sigmoid().cpu().numpy()
    metrics: dict[str, float] = {}
    for column, name in enumerate(names):
        metrics[f"{name}.margin_mae"] = float((margin - ends.margins)[:, column].abs().mean())
        metrics[f"{name}.auroc"] = auroc(score[:, column], truth[:, column])
        metrics[f"{name}.ece"] = calibration_error(score[:, column], truth[:, column])
    about = replace(
        card, architecture=facts_module.ARCHITECTURE, parameters=parameters, facts=tuple(names), metrics=metrics
    )
    save(place.folder / FILES["facts"], head.state_dict(), about)
    return metrics


def _for_heads(
    config: MazeTrainingConfig, place: TrainingDir, split: Split, card: Card, log: Log
) -> tuple[RolloutSampler, dict[str, Any], Card]:
    """The batch sampler of a head, its parameters, and a card with its training data."""
    seen, network, found = load_dynamics(place.folder, place.device)
    knowledge = load_knowledge()
    facts = MazeFacts(maze_named(config.maze), required_facts(knowledge), knowledge)
    names = [local_name(fact.predicate) for fact in facts.required.facts]
    labels = LabelFunctions(
        lambda states, goals: facts.label(states, goals).margin,
        Geodesic(facts.maze).distance,
        names.index("at_target"),
        names.index("free_of"),
    )
    frames = _frames(config, split, seen, place, log)
    parameters = head_parameters(network, found.card.parameters["motion"])
    about = replace(
        card, data={**card.data, "dynamics": found.identity}, encoder=seen.identity,
        sees="pixels, proprioception; labels of privileged-state",
    )  # fmt: skip
    return RolloutSampler(network, frames, labels, torch.tensor(POSITION, device=place.device)), parameters, about


def _tested(config: MazeTrainingConfig, place: TrainingDir, log: Log) -> RolloutEnds:
    """Ends of the test split, with velocity sensed."""
    sampler, _, _ = _for_heads(config, place, "test", Card(""), log)
    ends: RolloutEnds = sampler.ends(np.random.default_rng(config.seed), 2000, blind=False)
    return ends


def _imagining(network: Dynamics, frames: Frames) -> dict[str, float]:
    """The errors of predictions of five macro steps from every fifth mark of ``frames``, over all members."""
    marks = np.arange(0, frames.features.shape[1] - HORIZON, HORIZON)
    count = len(frames.states)
    piece = frames.piece(np.repeat(np.arange(count), len(marks)), np.tile(marks, count))
    found = network.imagine(piece.features[:, 0], piece.states[:, 0], piece.actions)
    true, looks = piece.states[:, -1], piece.features[:, -1]
    gap = found.proprio[:, :, -1] - true
    place, speed = gap[..., :2].norm(dim=-1), gap[..., 2:].norm(dim=-1)
    look = ((found.features[:, :, -1] - looks) / network.feature_scale).square().mean()
    return {
        "position_median_m": float(place.median()), "position_mean_m": float(place.mean()),
        "velocity_median_m_s": float(speed.median()), "velocity_mean_m_s": float(speed.mean()),
        "feature_error": float(look),
    }  # fmt: skip


def _trajectories(config: MazeTrainingConfig, split: Split) -> Trajectories:
    count = config.trajectories if split == "train" else _TEST
    return collect(maze_named(config.maze), count, config.steps, config.seed, split)


def _pictures(maze: Maze, found: Trajectories, base: Any, place: TrainingDir, log: Log) -> np.ndarray:  # noqa: ANN401
    states = found.states[:, ::MACRO_STEPS].reshape(-1, STATE_DIM)
    path = place.unfinished / f"features.{found.source.split}.npy"
    return encoded(states, lambda rows: draw(maze, rows, base.size), base, path, found.source, log)


def _frames(config: MazeTrainingConfig, split: Split, seen: Projected, place: TrainingDir, log: Log) -> Frames:
    found = _trajectories(config, split)
    raw = _pictures(maze_named(config.maze), found, seen.encoder, place, log)
    features = seen.projection(np.asarray(raw)).reshape(len(found.states), -1, *seen.shape)
    return Frames(found.states.astype(np.float32), found.actions.astype(np.float32), features, place.device)
