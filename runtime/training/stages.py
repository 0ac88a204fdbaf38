"""What the stages of every training share: their folder, and the parts of a network, fitted one after another.

The checkpoint of a part is deleted when its stage is done.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from grounding.world_model.checkpoint import Card
from grounding.world_model.device import device_named
from grounding.world_model.dynamics import Dynamics
from runtime.training.fit import Schedule, fit
from runtime.training.frames import Frames
from runtime.training.motion import appearance_loss, estimate_loss, motion_loss

__all__ = ["Fitter", "Log", "TrainingDir", "head_parameters"]

Log = Callable[[str], None]
_PARTS = {"dynamics": ("motion", "appearance", "estimate"), "events": ("events",), "facts": ("facts",)}


@dataclass(frozen=True)
class TrainingDir:
    """The ``folder`` of a training's checkpoints, and the ``device`` that it computes on: a GPU where there is one."""

    folder: Path
    device: str = field(default_factory=device_named, kw_only=True)

    @property
    def unfinished(self) -> Path:
        """The folder of checkpoints that an interrupted stage resumes from."""
        return self.folder / "unfinished"


@dataclass(frozen=True, slots=True)
class Fitter:
    """Fits the network that ``card`` describes, by its seed; checkpoints of its parts are in ``place``."""

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
        """Fit motion, appearance and estimate, each by its schedule, with what is fitted already."""
        parts = {
            "motion": (network.motion, motion_loss(network, frames)),
            "appearance": (network.appearance, appearance_loss(network, frames)),
            "estimate": (network.estimate, estimate_loss(network, frames, sensed)),
        }
        for name, (part, loss) in parts.items():
            self.fit(name, part, loss, schedules[name])

    def forget(self, stage: str) -> None:
        """Delete the parts' checkpoints of ``stage``, which is done."""
        for name in _PARTS.get(stage, ()):
            (self.place.unfinished / name).unlink(missing_ok=True)


def head_parameters(dynamics: Dynamics, motion: Mapping[str, Any]) -> dict[str, Any]:
    """What builds a head that reads what ``dynamics``, of the parameters ``motion``, imagine."""
    return {
        "centre": motion["centre"],
        "scale": motion["scale"],
        "features": dynamics.appearance[-1].out_features,
        "feature_scale": dynamics.feature_scale,
    }
