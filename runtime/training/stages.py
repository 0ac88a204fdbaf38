"""What the trainings of all worlds share: a stage's folder, and the fit of a network's parts, one after another.

A part's checkpoint is deleted when its stage is done.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import torch

from grounding.world_model.checkpoint import Card
from grounding.world_model.device import device_named
from grounding.world_model.dynamics import Dynamics
from runtime.training.config import TrainingConfig
from runtime.training.fit import Schedule, fit
from runtime.training.frames import Frames
from runtime.training.motion import appearance_loss, estimate_loss, motion_loss

__all__ = ["Fitter", "Log", "TrainingDir", "head_parameters", "train_stage"]

Log = Callable[[str], None]
Config = TypeVar("Config", bound=TrainingConfig)
Place = TypeVar("Place", bound="TrainingDir")
_PARTS = {"dynamics": ("motion", "appearance", "estimate"), "events": ("events",), "facts": ("facts",)}


@dataclass(frozen=True)
class TrainingDir:
    """The ``folder`` of a training's checkpoints and the ``device`` it runs on: by default a GPU if there is one."""

    folder: Path
    device: str = field(default_factory=device_named, kw_only=True)

    @property
    def unfinished(self) -> Path:
        """The folder of checkpoints that an interrupted stage resumes from."""
        return self.folder / "unfinished"


@dataclass(frozen=True, slots=True)
class Fitter:
    """Fits the network that ``card`` describes, with its seed; checkpoints of its parts are in ``place``."""

    place: TrainingDir
    card: Card
    log: Log

    def fit(
        self, name: str, part: torch.nn.Module, loss: Callable[[torch.Generator], torch.Tensor], schedule: Schedule
    ) -> None:
        """Fit ``part`` on the device of its weights, and freeze it; raises as :func:`runtime.training.fit.fit`."""

        def report(step: int, found: float) -> None:
            if step % 500 == 0:
                self.log(f"{name}: step {step:,}, loss {found:.4f}")

        source = json.dumps([self.card.data, self.card.encoder], sort_keys=True)
        fit(part, loss, schedule, self.card.seed or 0, self.place.unfinished / name, report, source)
        part.eval().requires_grad_(requires_grad=False)

    def dynamics(
        self, network: Dynamics, frames: Frames, sensed: torch.Tensor, schedules: Mapping[str, Schedule]
    ) -> None:
        """Fit motion, appearance and estimate in this order, each by its schedule."""
        parts = {
            "motion": (network.motion, motion_loss(network, frames)),
            "appearance": (network.appearance, appearance_loss(network, frames)),
            "estimate": (network.estimate, estimate_loss(network, frames, sensed)),
        }
        for name, (part, loss) in parts.items():
            self.fit(name, part, loss, schedules[name])

    def forget(self, stage: str) -> None:
        """Delete the checkpoints of the parts of ``stage``, which is finished."""
        for name in _PARTS.get(stage, ()):
            (self.place.unfinished / name).unlink(missing_ok=True)


def train_stage(
    stage: str,
    makers: Mapping[str, Callable[[Config, Place, Card, Log], Mapping[str, float]]],
    config: Config,
    place: Place,
    command: str,
    commit: str,
    log: Log,
) -> Mapping[str, float]:
    """Run the maker of ``stage`` with torch seeded, then delete its parts' checkpoints; returns its metrics."""
    torch.manual_seed(config.seed)
    card = Card("", data=config.data, seed=config.seed, command=command, commit=commit)
    metrics = makers[stage](config, place, card, log)
    Fitter(place, card, log).forget(stage)
    return metrics


def head_parameters(dynamics: Dynamics, motion: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a head that reads predictions of ``dynamics``, whose motion has the parameters ``motion``."""
    return {
        "centre": motion["centre"],
        "scale": motion["scale"],
        "features": dynamics.appearance[-1].out_features,
        "feature_scale": dynamics.feature_scale,
    }
