"""Losses of the dynamics: the environment step, the appearance, and the estimate of unsensed coordinates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch.nn import functional

from grounding.world_model.dynamics import Dynamics
from runtime.training.frames import HORIZON, Frames, generator_of, segments

__all__ = ["appearance_loss", "estimate_loss", "histories", "motion_loss"]

_BATCH = 1024
"""Transitions of one step, for each member."""
_SEGMENTS = 192
_FINE = 0.1
"""The error that counts as one, as a fraction of a coordinate's scale."""

Loss = Callable[[torch.Generator], torch.Tensor]


def motion_loss(dynamics: Dynamics, frames: Frames) -> Loss:
    """The error of one environment step; each member draws a batch of its own."""
    begin = frames.tensor(frames.states[:, :-1].reshape(-1, frames.states.shape[-1]))
    end = frames.tensor(frames.states[:, 1:].reshape(-1, frames.states.shape[-1]))
    action = frames.tensor(frames.actions.reshape(-1, frames.actions.shape[-1]))
    motion = dynamics.motion
    fine = motion.scale * _FINE

    def loss(random: torch.Generator) -> torch.Tensor:
        rows = torch.randint(len(begin), (motion.members, _BATCH), generator=random).to(frames.device)
        return functional.smooth_l1_loss(motion(begin[rows], action[rows]) / fine, end[rows] / fine, beta=0.05)

    return loss


def appearance_loss(dynamics: Dynamics, frames: Frames) -> Loss:
    """The error of the features over five macro steps, each predicted from the prediction before it.

    The proprioception is the prediction of the (already trained) motion, so that its errors are included.
    """

    def loss(random: torch.Generator) -> torch.Tensor:
        piece = frames.piece(*segments(frames, generator_of(random), _SEGMENTS, HORIZON))
        begin, seen = piece.states[:, 0], piece.features
        with torch.no_grad():
            path = dynamics.motion.path(begin.expand(dynamics.members, *begin.shape), piece.actions.flatten(1, 2))
        ends = path[:, :, :: dynamics.macro]
        imagined = seen[:, 0].expand(dynamics.members, *seen[:, 0].shape)
        total = torch.zeros((), device=frames.device)
        for step in range(HORIZON):
            imagined = dynamics.appear(imagined, ends[:, :, step], ends[:, :, step + 1])
            total = total + ((imagined - seen[:, step + 1]) / dynamics.feature_scale).square().mean()
        return total / HORIZON

    return loss


def estimate_loss(dynamics: Dynamics, frames: Frames, sensed: torch.Tensor) -> Loss:
    """The error of the estimate of coordinates that are not ``sensed`` (P,), also from short histories."""
    scale, centre = dynamics.motion.scale, dynamics.motion.centre
    hidden = ~sensed

    def loss(random: torch.Generator) -> torch.Tensor:
        numbers = generator_of(random)
        proprio, actions, latest = histories(frames, numbers, _BATCH, dynamics.history)
        found = dynamics.estimated(proprio, actions, sensed.expand(_BATCH, -1))
        return functional.smooth_l1_loss(
            ((found - centre) / scale)[:, hidden], ((latest - centre) / scale)[:, hidden], beta=0.05
        )

    return loss


def histories(
    frames: Frames, random: np.random.Generator, count: int, length: int
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Rows of :meth:`Frames.past`, a third of them short, and the latest state (B, P) of each."""
    which, first = segments(frames, random, count, length)
    age = np.where(random.random(count) < 1 / 3, random.integers(1, length, count), length)
    latest = first + length - 1
    return *frames.past(which, latest, length, age), frames.tensor(frames.marks[which, latest])
