"""Training of the heads of a scene: predicted and true marks of windows, labelled by the simulator's grounding."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from grounding.world_model.dynamics import Dynamics, spread
from grounding.world_model.scene import SceneEventHead, SceneFactHead
from runtime.training.frames import HORIZON, generator_of
from runtime.worlds.libero.training.hand import HIDDEN
from runtime.worlds.libero.training.windows import Windows

__all__ = ["Loss", "WindowEnds", "WindowSampler", "calibrate", "event_loss", "fact_loss", "sensed_all", "sensed_still"]

_WINDOWS = 48
_BLUR = 0.1
"""Noise on the training features of a head, relative to their standard deviation."""

Loss = Callable[[torch.Generator], torch.Tensor]
Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class WindowEnds:
    """R rows: the inputs of a head at a mark, and the labels.

    ``window`` (R,) and ``mark`` (R,) identify them.
    """

    features: torch.Tensor
    proprio: torch.Tensor
    spread: torch.Tensor
    sensed: torch.Tensor
    truth: torch.Tensor  # (R, F)
    margin: torch.Tensor  # (R, F)
    clear: torch.Tensor  # (R,)
    remaining: torch.Tensor  # (R,) seconds
    error: torch.Tensor  # (R,) of the proprioception, in its scale
    mismatch: torch.Tensor  # (R,) of the features, in their scale
    task: torch.Tensor  # (R,)

    @property
    def read(self) -> tuple[torch.Tensor, ...]:
        """The inputs of a head."""
        return self.features, self.proprio, self.spread, self.sensed


def sensed_all(size: int) -> torch.Tensor:
    """Every coordinate (P,)."""
    return torch.ones(size, dtype=torch.bool)


def sensed_still(size: int) -> torch.Tensor:
    """Every coordinate (P,) but the speeds."""
    return torch.arange(size) < size - HIDDEN


class WindowSampler:
    """Draws :class:`WindowEnds` from windows: the marks after the first of each, predicted by all members, and true."""

    def __init__(self, dynamics: Dynamics, data: Windows) -> None:
        self.dynamics, self.data = dynamics, data
        self._task = data.task

    def drawn(self, random: np.random.Generator, count: int = _WINDOWS) -> WindowEnds:
        """The ends of ``count`` windows at random."""
        found: WindowEnds = self.ends(random.integers(len(self.data), size=count))
        return found

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def ends(self, which: Indices) -> WindowEnds:
        """The ends of the windows ``which`` (B,): members first, then marks and windows; the true ones last."""
        dynamics, data = self.dynamics, self.data
        piece = data.frames.piece(which, np.zeros_like(which))
        found = dynamics.imagine(piece.features[:, 0], piece.states[:, 0], piece.actions)
        true, true_looks = piece.states[:, 1:].flatten(0, 1), piece.features[:, 1:].flatten(0, 1)
        proprio, features = found.proprio.flatten(1, 2), found.features.flatten(1, 2)
        doubt = spread(proprio, dynamics.motion.scale)
        members = dynamics.members

        def again(rows: NDArray[np.generic]) -> torch.Tensor:
            """Labels (B, H + 1, ...) of the marks after the first, for every member and once more."""
            flat = data.frames.tensor(np.ascontiguousarray(rows[:, 1:])).flatten(0, 1)
            return flat.repeat(members + 1, *[1] * (flat.ndim - 1))

        all_proprio = torch.cat([proprio.flatten(0, 1), true])
        all_looks = torch.cat([features.flatten(0, 1), true_looks])
        gap = all_proprio - true.repeat(members + 1, 1)
        unlike = all_looks - true_looks.repeat(members + 1, 1)
        return WindowEnds(
            all_looks, all_proprio,
            torch.cat([doubt.expand(members, -1).flatten(), torch.zeros_like(doubt)]),
            sensed_all(true.shape[-1]).to(true.device),
            again(data.truth[which]), again(data.margin[which]), again(data.clear[which]),
            again(data.remaining[which]),
            (gap / dynamics.motion.scale).square().mean(dim=-1).sqrt(),
            (unlike / dynamics.feature_scale).square().mean(dim=-1).sqrt(),
            data.frames.tensor(self._task[which]).repeat_interleave(HORIZON).repeat(members + 1),
        )  # fmt: skip


def fact_loss(head: SceneFactHead, sampler: WindowSampler) -> Loss:
    """The error of the margins in their units, and the cross entropy of the truth."""

    def loss(random: torch.Generator) -> torch.Tensor:
        ends = sampler.drawn(generator_of(random))
        margin, logit = head(_blurred(head, ends.features, random), *ends.read[1:])
        entropy = functional.binary_cross_entropy_with_logits(logit, ends.truth.float())
        return functional.smooth_l1_loss(margin / head.units, ends.margin / head.units, beta=0.3) + entropy

    return loss


def event_loss(head: SceneEventHead, sampler: WindowSampler, goals: Mapping[int, tuple[int, ...]]) -> Loss:
    """The errors of all events; half of the rows are for another task than the one that is played."""
    device = sampler.data.frames.device
    asked = torch.zeros(max(goals) + 1, sampler.data.truth.shape[-1], device=device)
    for task, places in goals.items():
        asked[task, list(places)] = 1
    known = torch.tensor(sorted(goals))

    def loss(random: torch.Generator) -> torch.Tensor:
        ends = sampler.drawn(generator_of(random))
        rows = len(ends.task)
        other = known[torch.randint(len(known), (rows,), generator=random)].to(device)
        task = torch.where((torch.rand(rows, generator=random) < 0.5).to(device), other, ends.task)
        goal = asked[task]
        success = (ends.truth | ~goal.bool()).all(dim=-1)
        found = head(_blurred(head, ends.features, random), *ends.read[1:], goal)
        # The remaining time is known if the task is the one that is played, or is done.
        left = torch.where(task == ends.task, ends.remaining, torch.where(success, 0.0, torch.inf))
        known_left = torch.isfinite(left)
        entropy = functional.binary_cross_entropy_with_logits
        return (
            functional.smooth_l1_loss(found.remaining[known_left], left[known_left], beta=0.5)
            + entropy(found.success, success.float())
            + 0.3 * entropy(found.feasibility, ends.clear.float())
            + 0.3 * entropy(found.consistency, torch.exp(-ends.mismatch))
            + functional.smooth_l1_loss(found.uncertainty, ends.error, beta=0.1)
        )

    return loss


def calibrate(head: SceneFactHead, ends: WindowEnds) -> None:
    """Fit the temperature of each fact by maximum likelihood on ``ends``, on which no weight was trained.

    A fact that is never true or never false there takes the temperature of all facts together.
    """
    with torch.no_grad():
        _, logit = head(*ends.read)
    logit = logit * head.temperature
    truth = ends.truth.float()
    grid = torch.logspace(-0.7, 1.0, 69, device=logit.device)
    entropy = torch.stack(
        [functional.binary_cross_entropy_with_logits(logit / one, truth, reduction="none").mean(dim=0) for one in grid]
    )
    alone, together = grid[entropy.argmin(dim=0)], grid[entropy.mean(dim=1).argmin()]
    both = ends.truth.any(dim=0) & ~ends.truth.all(dim=0)
    head.temperature.copy_(torch.where(both, alone, together))


def _blurred(head: SceneFactHead | SceneEventHead, features: torch.Tensor, random: torch.Generator) -> torch.Tensor:
    noise = torch.randn(features.shape, generator=random).to(features)
    return features + _BLUR * head.scaling.feature_scale * noise
