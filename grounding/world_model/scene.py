"""Heads for a scene whose goals are facts and not pictures: H_omega and G_psi of one set of ground facts.

Tasks that share a scene share its things, so a fact is asked for by its name, such as ``on(bowl_1, plate_1)``, and a
goal is which of the facts it requires. What the heads read is features and proprioception; no pose of a thing is there.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import nn

from grounding.world_model.events import Events
from grounding.world_model.layers import mlp
from grounding.world_model.terminal import Scaling

__all__ = ["SCENE_EVENTS", "SCENE_FACTS", "SceneEventHead", "SceneFactHead"]

SCENE_FACTS = "scene-facts"
SCENE_EVENTS = "scene-events"


class SceneFactHead(nn.Module):
    """``facts``: the names of the F facts that it speaks of; ``units`` (F,): a margin's usual size, in its own unit.

    ``centre``, ``scale``, ``features``, ``feature_scale`` as of :class:`grounding.world_model.terminal.Scaling`.
    """

    temperature: torch.Tensor

    def __init__(
        self,
        facts: Sequence[str],
        units: Sequence[float],
        centre: Sequence[float],
        scale: Sequence[float],
        features: int,
        feature_scale: float,
        width: int = 256,
    ) -> None:
        super().__init__()
        self.facts = tuple(facts)
        self.scaling = Scaling(centre, scale, features, feature_scale)
        self.network = mlp([features + 2 * len(centre) + 1, width, width, 2 * len(self.facts)])
        self.register_buffer("units", torch.tensor(units, dtype=torch.float32), persistent=False)
        self.register_buffer("temperature", torch.ones(len(self.facts)))

    def forward(
        self, features: torch.Tensor, proprio: torch.Tensor, spread: torch.Tensor, sensed: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Margins, each in its own unit, and logits of the scores (..., F).

        ``features`` (..., D), ``proprio`` (..., P), ``spread`` (...) as of
        :func:`grounding.world_model.dynamics.spread`; ``sensed`` (..., P) or (P,).
        """
        found = self.network(_read(self.scaling, features, proprio, spread, sensed))
        margin, logit = found.unflatten(-1, (2, len(self.facts))).unbind(-2)
        return margin * self.units, logit / self.temperature


class SceneEventHead(nn.Module):
    """Events of a task that is given by which of ``facts`` facts it requires.

    Here :attr:`Events.remaining` is in seconds: the remaining time to the goal if the task succeeds.
    """

    def __init__(
        self,
        facts: int,
        centre: Sequence[float],
        scale: Sequence[float],
        features: int,
        feature_scale: float,
        width: int = 256,
    ) -> None:
        super().__init__()
        self.scaling = Scaling(centre, scale, features, feature_scale)
        self.network = mlp([features + 2 * len(centre) + 1 + facts, width, width, 5])

    def forward(
        self,
        features: torch.Tensor,
        proprio: torch.Tensor,
        spread: torch.Tensor,
        sensed: torch.Tensor,
        goal: torch.Tensor,
    ) -> Events:
        """As :meth:`SceneFactHead.forward`, to events of (...); ``goal`` (..., F) or (F,) is 1 where it is required."""
        read = _read(self.scaling, features, proprio, spread, sensed)
        asked = goal.to(read).expand(*read.shape[:-1], goal.shape[-1])
        return Events.of(self.network(torch.cat([read, asked], dim=-1)))


def _read(
    scaling: Scaling, features: torch.Tensor, proprio: torch.Tensor, spread: torch.Tensor, sensed: torch.Tensor
) -> torch.Tensor:
    """What both heads read, scaled, (..., D + 2 P + 1)."""
    doubt = (spread + 1e-3).log().expand(proprio.shape[:-1])[..., None]
    return torch.cat([scaling.look(features), scaling.proprio(proprio, sensed), doubt], dim=-1)
