"""F_theta: features, proprioception and actions to the features and the proprioception that follow.

The proprioception moves by environment steps (:mod:`grounding.world_model.motion`), the features by macro steps, each
from the features before it and the proprioception at both ends. What a robot does not sense of its proprioception is
estimated from a history of macro steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import torch
from torch import nn

from grounding.world_model.layers import mlp
from grounding.world_model.motion import Motion

__all__ = ["ARCHITECTURE", "Dynamics", "History", "Imagined", "spread"]

ARCHITECTURE = "dynamics"


@dataclass(frozen=True, slots=True, eq=False)
class History:
    """What was sensed before a plan, latest last, macro step by macro step.

    ``features`` (D,) of the latest picture; ``proprio`` (K, P) and ``actions`` (K - 1, macro, A), rows of NaN where
    an episode is younger than K; ``sensed`` (P,): which coordinates of ``proprio`` are known.
    """

    features: torch.Tensor
    proprio: torch.Tensor
    actions: torch.Tensor
    sensed: torch.Tensor


@dataclass(frozen=True, slots=True, eq=False)
class Imagined:
    """What N candidates of H macro steps lead to, by each of M members.

    ``features`` (M, N, H, D) and ``proprio`` (M, N, H, P) after each macro step; ``path`` (M, N, H * macro + 1, P)
    at each environment step, the beginning first.
    """

    features: torch.Tensor
    proprio: torch.Tensor
    path: torch.Tensor


class Dynamics(nn.Module):
    """``motion``: the parameters of :class:`Motion`; ``features``: D; ``macro``: environment steps in a macro step.

    ``apart``: how far from each other members may begin (:meth:`apart`), in units of a coordinate's scale.
    """

    def __init__(
        self,
        motion: Mapping[str, Any],
        features: int,
        feature_scale: float,
        macro: int = 5,
        history: int = 3,
        width: int = 256,
        apart: float = 0.01,
    ) -> None:
        super().__init__()
        self.macro, self.history, self.feature_scale, self._apart = macro, history, feature_scale, apart
        self.motion = Motion(**motion)
        size, actions = len(motion["centre"]), int(motion["actions"])
        self.appearance = mlp([features + 2 * size, width, width, features], zero=True)
        seen = history * (2 * size + 1) + (history - 1) * macro * actions
        self.estimate = mlp([seen, width, width, size], zero=True)

    @property
    def members(self) -> int:
        """M."""
        return self.motion.members

    def begin(self, history: History) -> torch.Tensor:
        """The latest proprioception (P,), what is not sensed of it estimated from ``history``."""
        latest = history.proprio[-1]
        if bool(history.sensed.all()):
            return latest
        guess = self.estimated(history.proprio[None], history.actions[None], history.sensed[None])[0]
        return torch.where(history.sensed, latest, guess)

    def estimated(self, proprio: torch.Tensor, actions: torch.Tensor, sensed: torch.Tensor) -> torch.Tensor:
        """The latest proprioception (B, P) by the estimator, from rows of what :class:`History` holds (B, ...)."""
        there = ~proprio.isnan().any(dim=-1, keepdim=True)
        shown = there & sensed[:, None]
        scaled = torch.where(shown, (proprio - self.motion.centre) / self.motion.scale, 0.0)
        given = torch.cat([scaled, shown.to(scaled), there.to(scaled)], dim=-1).flatten(1)
        found = self.estimate(torch.cat([given, actions.nan_to_num(0.0).flatten(1)], dim=-1))
        return found * self.motion.scale + self.motion.centre

    def appear(self, features: torch.Tensor, before: torch.Tensor, after: torch.Tensor) -> torch.Tensor:
        """The features (..., D) one macro step after ``features``, the proprioception (..., P) at both ends given."""
        ends = [(end - self.motion.centre) / self.motion.scale for end in (before, after)]
        change = self.appearance(torch.cat([features / self.feature_scale, *ends], dim=-1))
        return features + change * self.feature_scale

    def apart(self, begin: torch.Tensor, random: torch.Generator) -> torch.Tensor:
        """Beginnings (M, B, P) of the members around ``begin`` (B, P): the first there, the others in pairs around it.

        Contact makes a small difference large, in exact motion too. So how far members spread tells of a plan whether
        it needs luck.
        """
        pairs = self.members // 2
        drawn = torch.randn((pairs, *begin.shape), generator=random).to(begin)
        off = torch.cat([torch.zeros_like(begin)[None], drawn, -drawn])[: self.members]
        return begin + self._apart * self.motion.scale * off

    def imagine(self, features: torch.Tensor, begin: torch.Tensor, actions: torch.Tensor) -> Imagined:
        """Roll ``actions`` (N, H, macro, A) out from ``features`` and ``begin``.

        ``features`` are (D,) or (N, D); ``begin`` is (P,), (N, P), or for each member (M, 1, P) or (M, N, P).
        """
        rows, horizon = actions.shape[:2]
        start = begin.expand(self.members, rows, begin.shape[-1])
        path = self.motion.path(start, actions.flatten(1, 2))
        ends = path[:, :, :: self.macro]
        seen = [features.expand(self.members, rows, features.shape[-1])]
        for step in range(horizon):
            seen.append(self.appear(seen[-1], ends[:, :, step], ends[:, :, step + 1]))
        return Imagined(torch.stack(seen[1:], dim=2), ends[:, :, 1:], path)


def spread(proprio: torch.Tensor, scale: torch.Tensor) -> torch.Tensor:
    """How far members disagree: (M, ..., P) to (...,), the root mean square deviation in units of ``scale``."""
    return ((proprio - proprio.mean(dim=0)) / scale).square().mean(dim=(0, -1)).sqrt()
