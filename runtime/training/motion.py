"""What trains the dynamics: the environment step, the appearance, and the estimate of what is not sensed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch.nn import functional

from grounding.world_model.dynamics import Dynamics
from runtime.training.frames import Frames, segments

__all__ = ["appearance_loss", "estimate_loss", "generator_of", "histories", "motion_loss"]

_BATCH = 1024
"""Transitions of one step, for each member."""
_SEGMENTS = 192
_HORIZON = 5
_FINE = 0.1
"""Of a coordinate's scale: the error that counts as one."""

Loss = Callable[[torch.Generator], torch.Tensor]


def generator_of(random: torch.Generator) -> np.random.Generator:
    """A numpy generator that ``random`` decides."""
    return np.random.default_rng(int(torch.randint(2**62, (), generator=random)))


def motion_loss(dynamics: Dynamics, frames: Frames) -> Loss:
    """The error of one environment step; each member draws a batch of its own."""
    begin = torch.from_numpy(frames.states[:, :-1].reshape(-1, frames.states.shape[-1]))
    end = torch.from_numpy(frames.states[:, 1:].reshape(-1, frames.states.shape[-1]))
    action = torch.from_numpy(frames.actions.reshape(-1, frames.actions.shape[-1]))
    motion = dynamics.motion
    fine = motion.scale * _FINE

    def loss(random: torch.Generator) -> torch.Tensor:
        rows = torch.randint(len(begin), (motion.members, _BATCH), generator=random)
        return functional.smooth_l1_loss(motion(begin[rows], action[rows]) / fine, end[rows] / fine, beta=0.05)

    return loss


def appearance_loss(dynamics: Dynamics, frames: Frames) -> Loss:
    """The error of the features over five macro steps, each from the features imagined before it.

    The proprioception is the one that the (already trained) motion imagines, so that its errors are met here too.
    """
    states, actions, features = (torch.from_numpy(np.asarray(part)) for part in _parts(frames))

    def loss(random: torch.Generator) -> torch.Tensor:
        which, mark = segments(frames, generator_of(random), _SEGMENTS, _HORIZON)
        pushes, seen, begin = _piece(which, mark, states, actions, features, dynamics.macro)
        with torch.no_grad():
            path = dynamics.motion.path(begin.expand(dynamics.members, *begin.shape), pushes)
        ends = path[:, :, :: dynamics.macro]
        imagined = seen[:, 0].expand(dynamics.members, *seen[:, 0].shape)
        total = torch.zeros(())
        for step in range(_HORIZON):
            imagined = dynamics.appear(imagined, ends[:, :, step], ends[:, :, step + 1])
            total = total + ((imagined - seen[:, step + 1]) / dynamics.feature_scale).square().mean()
        return total / _HORIZON

    return loss


def estimate_loss(dynamics: Dynamics, frames: Frames, sensed: torch.Tensor) -> Loss:
    """The error of what is estimated where only ``sensed`` (P,) is known; younger histories are among them."""
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
    """Proprioception and actions as a :class:`~grounding.world_model.dynamics.History` has them, and the latest state.

    A third of the histories are young.
    """
    which, mark = segments(frames, random, count, length)
    macro = (frames.states.shape[1] - 1) // (frames.features.shape[1] - 1)
    steps = mark[:, None] + np.arange(length)
    proprio = torch.from_numpy(frames.states[which[:, None], steps * macro])
    moved = (steps[:, :-1, None] * macro + np.arange(macro)).reshape(count, -1)
    actions = torch.from_numpy(frames.actions[which[:, None], moved]).reshape(count, length - 1, macro, -1)
    age = np.where(random.random(count) < 1 / 3, random.integers(1, length, count), length)
    missing = torch.from_numpy(np.arange(length)[None] < length - age[:, None])
    latest = proprio[:, -1].clone()
    proprio[missing] = torch.nan
    actions[missing[:, :-1]] = torch.nan
    return proprio, actions, latest


def _parts(frames: Frames) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return frames.states, frames.actions, frames.features


def _piece(
    which: np.ndarray,
    mark: np.ndarray,
    states: torch.Tensor,
    actions: torch.Tensor,
    features: torch.Tensor,
    macro: int,
) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
    """Actions (B, H * macro, A), features (B, H + 1, D) and first states (B, P) of segments."""
    row = torch.from_numpy(which)[:, None]
    steps = torch.from_numpy(mark)[:, None] * macro + torch.arange(_HORIZON * macro)
    marks = torch.from_numpy(mark)[:, None] + torch.arange(_HORIZON + 1)
    return actions[row, steps], features[row, marks], states[row[:, 0], steps[:, 0]]
