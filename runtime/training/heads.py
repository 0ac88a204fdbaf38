"""Training of the heads: predicted and true final states of trajectory segments, with goals, labelled by the simulator.

A goal is a state of some trajectory with its picture's features, half of the time one near the final state, where the
facts are decided; a picture does not show velocity, so a goal's velocity may be sampled again. In a third of the
batches velocity is not sensed, so that the heads learn to do without.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from grounding.world_model.dynamics import Dynamics, spread
from grounding.world_model.events import EventHead
from grounding.world_model.facts import FactHead
from runtime.training.frames import HORIZON, Frames, generator_of, segments

__all__ = ["LabelFunctions", "RolloutEnds", "RolloutSampler", "event_loss", "fact_loss"]

_SEGMENTS = 64
_NEAR = 64
"""Of how many frames a near goal is the nearest."""
_VELOCITIES = (0.1, 0.5, 2.0)
"""Standard deviations of a drawn goal velocity around the end's."""

Margins = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
Distances = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class LabelFunctions:
    """The simulator's labels: ``margins`` of states and goals (B, P) to (B, F), ``remaining`` metres of path to (B,).

    ``success``, ``valid``: the columns of the margins whose sign says that the task succeeds and that a state is valid.
    """

    margins: Margins
    remaining: Distances
    success: int
    valid: int


@dataclass(frozen=True, slots=True, eq=False)
class RolloutEnds:
    """Rows of a batch: the inputs of a head, and the labels."""

    features: torch.Tensor
    proprio: torch.Tensor
    goal_features: torch.Tensor
    goal_proprio: torch.Tensor
    spread: torch.Tensor
    sensed: torch.Tensor
    margins: torch.Tensor  # (B, F)
    remaining: torch.Tensor  # (B,) metres
    error: torch.Tensor  # (B,) of the proprioception, in its scale
    mismatch: torch.Tensor  # (B,) of the features, in their scale

    @property
    def read(self) -> tuple[torch.Tensor, ...]:
        """The inputs of a head."""
        return self.features, self.proprio, self.goal_features, self.goal_proprio, self.spread, self.sensed


class RolloutSampler:
    """Draws :class:`RolloutEnds`; ``sensed`` (P,) is the mask of coordinates that are sensed without velocity."""

    def __init__(self, dynamics: Dynamics, frames: Frames, labels: LabelFunctions, sensed: torch.Tensor) -> None:
        self.dynamics, self.frames, self.labels, self.sensed = dynamics, frames, labels, sensed
        size = frames.states.shape[-1]
        self._marks = frames.marks.reshape(-1, size)
        self._features = np.asarray(frames.features).reshape(-1, frames.features.shape[-1])

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def ends(self, random: np.random.Generator, count: int = _SEGMENTS, *, blind: bool | None = None) -> RolloutEnds:
        """``count`` segments, each with an end after every macro step: predicted by all members, and true.

        ``blind``: whether velocity is not sensed; random if None.
        """
        dynamics, frames = self.dynamics, self.frames
        blind = random.random() < 1 / 3 if blind is None else blind
        which, mark = segments(frames, random, count, HORIZON)
        piece = frames.piece(which, mark)
        begin, known = self._begin(which, mark, piece.states[:, 0], blind=blind)
        drawn = torch.Generator().manual_seed(int(random.integers(2**63)))
        found = dynamics.imagine(piece.features[:, 0], dynamics.apart(begin, drawn), piece.actions)
        true, true_looks = piece.states[:, 1:].flatten(0, 1), piece.features[:, 1:].flatten(0, 1)
        proprio, features = found.proprio.flatten(1, 2), found.features.flatten(1, 2)
        doubt = spread(proprio, dynamics.motion.scale)
        ended = true.cpu().numpy()
        goal, goal_looks = self._goals(ended, random)
        labelled = ended.astype(np.float64), goal.astype(np.float64)
        margins = frames.tensor(self.labels.margins(*labelled))
        remaining = frames.tensor(self.labels.remaining(*labelled))
        members = dynamics.members

        def every(imagined: torch.Tensor, exact: torch.Tensor) -> torch.Tensor:
            """The rows of all members, then the true ones."""
            return torch.cat([imagined.flatten(0, 1), exact])

        def again(rows: torch.Tensor) -> torch.Tensor:
            return rows.repeat(members + 1, *[1] * (rows.ndim - 1))

        all_proprio, all_looks = every(proprio, true), every(features, true_looks)
        error = ((all_proprio - again(true)) / dynamics.motion.scale).square().mean(dim=-1).sqrt()
        mismatch = ((all_looks - again(true_looks)) / dynamics.feature_scale).square().mean(dim=-1).sqrt()
        goals, goal_features = frames.tensor(goal), frames.tensor(goal_looks)
        doubts = every(doubt.expand(members, -1), torch.zeros_like(doubt))
        return RolloutEnds(
            all_looks, all_proprio, again(goal_features), again(goals), doubts, known.expand(len(all_proprio), -1),
            again(margins.float()), again(remaining.float()), error, mismatch,
        )  # fmt: skip

    def _begin(
        self, which: NDArray[np.int64], mark: NDArray[np.int64], latest: torch.Tensor, *, blind: bool
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """The initial proprioception (B, P) of segments, and the mask of sensed coordinates (P,)."""
        if not blind:
            return latest, torch.ones_like(self.sensed)
        length = self.dynamics.history
        proprio, actions = self.frames.past(which, mark, length, np.minimum(mark + 1, length))
        guess = self.dynamics.estimated(proprio, actions, self.sensed.expand(len(which), -1))
        return torch.where(self.sensed, latest, guess), self.sensed

    def _goals(self, ends: NDArray[np.float32], random: np.random.Generator) -> tuple[NDArray[np.float32], np.ndarray]:
        """Goal states (B, P) and the features of their pictures (B, D)."""
        count = len(ends)
        row = random.integers(len(self._marks), size=count)
        near = np.flatnonzero(random.random(count) < 0.5)
        drawn = random.integers(len(self._marks), size=(len(near), _NEAR))
        gap = np.linalg.norm(self._marks[drawn, :2] - ends[near, None, :2], axis=-1)
        row[near] = drawn[np.arange(len(near)), gap.argmin(axis=1)]
        goal = self._marks[row].copy()
        fresh = np.flatnonzero(random.random(count) < 0.5)
        width = random.choice(_VELOCITIES, size=(len(fresh), 1))
        goal[fresh, 2:] = ends[fresh, 2:] + width * random.standard_normal((len(fresh), goal.shape[1] - 2))
        return goal, self._features[row]


def fact_loss(head: FactHead, sampler: RolloutSampler) -> Callable[[torch.Generator], torch.Tensor]:
    """The error of the margins, and the cross entropy of the truth values, which are their signs."""

    def loss(random: torch.Generator) -> torch.Tensor:
        ends = sampler.ends(generator_of(random))
        margin, logit = head(*ends.read)
        truth = functional.binary_cross_entropy_with_logits(logit, (ends.margins > 0).float())
        return functional.smooth_l1_loss(margin, ends.margins, beta=0.1) + 0.3 * truth

    return loss


def event_loss(head: EventHead, sampler: RolloutSampler) -> Callable[[torch.Generator], torch.Tensor]:
    """The errors of all events."""
    labels = sampler.labels

    def loss(random: torch.Generator) -> torch.Tensor:
        ends = sampler.ends(generator_of(random))
        found = head(*ends.read)
        reached = torch.isfinite(ends.remaining)
        entropy = functional.binary_cross_entropy_with_logits
        return (
            functional.smooth_l1_loss(found.remaining[reached], ends.remaining[reached], beta=0.1)
            + 0.3 * entropy(found.success, (ends.margins[:, labels.success] > 0).float())
            + 0.3 * entropy(found.feasibility, (ends.margins[:, labels.valid] > 0).float())
            + 0.3 * entropy(found.consistency, torch.exp(-ends.mismatch))
            + functional.smooth_l1_loss(found.uncertainty, ends.error, beta=0.1)
        )

    return loss
