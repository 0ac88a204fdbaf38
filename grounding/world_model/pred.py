"""phi_pred: a world model's predictions as facts (paper, section 3): the predicted ABox, in the simulator's terms.

A predicted fact holds if its score exceeds one half. It also has a margin and a score, and does not imply success:
a satisfied prediction may keep a plan, and only the native predicate accepts what came of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.world_model.dynamics import Imagined, spread
from grounding.world_model.facts import FactHead
from grounding.world_model.scene import SceneFactHead
from onto_compiler.problems import OntoError, Problem
from onto_compiler.required import Fact
from onto_compiler.schema import local_name

__all__ = ["ObservedGoal", "PredGrounder", "Predicted", "ScenePredGrounder"]


@dataclass(frozen=True, slots=True, eq=False)
class ObservedGoal:
    """The goal as it is observed: ``features`` (D,) of its picture, ``proprio`` (P,), and what of it is ``sensed``."""

    features: torch.Tensor
    proprio: torch.Tensor
    sensed: torch.Tensor


@dataclass(frozen=True, slots=True, eq=False)
class Predicted:
    """Of candidates and required facts, each (..., F): ``margin`` in the TBox's unit, ``score`` from 0 to 1.

    Both are means over the members of the dynamics. Where a fact is not ``observed`` (F,), they are what is usual.
    """

    margin: torch.Tensor
    score: torch.Tensor
    observed: NDArray[np.bool_]

    def observation(self, *candidate: int, step: int) -> Observation:
        """The predicted ABox of one candidate at an environment step."""
        margin = self.margin[candidate].detach().cpu().numpy().astype(np.float64)
        score = self.score[candidate].detach().cpu().numpy().astype(np.float64)
        return Observation(
            source="pred",
            step=step,
            observed=self.observed,
            truth=self.observed & (score > 0.5),
            margin=np.where(self.observed, margin, np.nan),
            score=np.where(self.observed, score, np.nan),
            limit=("",) * len(margin),
        )


class PredGrounder:
    """Grounds ``facts`` by ``head``, whose columns it puts in their order.

    ``observed`` (F,): the facts for which the sensors give evidence; by default all.
    """

    def __init__(
        self, head: FactHead, facts: Sequence[Fact], file: str = "", observed: Sequence[bool] | None = None
    ) -> None:
        """Raises ``WM013``, a problem for each fact that the head was not trained for."""
        self.head, self.facts = head, tuple(facts)
        self.observed = np.array([True] * len(facts) if observed is None else observed, dtype=np.bool_)
        missing = [fact for fact in facts if local_name(fact.predicate) not in head.facts]
        if missing:
            known = ", ".join(f"`{name}`" for name in head.facts)
            hint = f"it was trained for {known}; train it on a task that requires this predicate"
            raise OntoError(*(_untrained(fact, file, hint) for fact in missing))
        self._columns = [head.facts.index(local_name(fact.predicate)) for fact in self.facts]

    def ground(self, imagined: Imagined, goal: ObservedGoal, *, every: bool = False) -> Predicted:
        """Facts at the end of each of N candidates (N, F), or with ``every`` after each of H macro steps (N, H, F)."""
        features, proprio = imagined.features, imagined.proprio
        if not every:
            features, proprio = features[:, :, -1], proprio[:, :, -1]
        doubt = spread(proprio, self.head.scaling.scale)
        margin, logit = self.head(features, proprio, goal.features, goal.proprio, doubt, goal.sensed)
        return _of_members(margin, logit, self._columns, self.observed)


class ScenePredGrounder:
    """Grounds ``facts`` of a scene by ``head``, which knows them by their atoms; what is asked negated is its atom."""

    def __init__(self, head: SceneFactHead, facts: Sequence[Fact], file: str = "") -> None:
        """Raises ``WM013``, a problem for each fact that the head was not trained for."""
        self.head, self.facts = head, tuple(facts)
        names = [str(replace(fact, polarity=True)) for fact in facts]
        missing = [fact for fact, name in zip(facts, names, strict=True) if name not in head.facts]
        if missing:
            hint = f"it was trained for {len(head.facts)} facts of one scene; train it on tasks that require this one"
            raise OntoError(*(_untrained(fact, file, hint) for fact in missing))
        self._columns = [head.facts.index(name) for name in names]

    def ground(self, imagined: Imagined, sensed: torch.Tensor, *, every: bool = False) -> Predicted:
        """As :meth:`PredGrounder.ground`; ``sensed`` (P,) is the mask of sensed proprioception."""
        features, proprio = imagined.features, imagined.proprio
        if not every:
            features, proprio = features[:, :, -1], proprio[:, :, -1]
        margin, logit = self.head(features, proprio, spread(proprio, self.head.scaling.scale), sensed)
        return _of_members(margin, logit, self._columns, np.ones(len(self.facts), dtype=np.bool_))


def _of_members(
    margin: torch.Tensor, logit: torch.Tensor, columns: Sequence[int], observed: NDArray[np.bool_]
) -> Predicted:
    """What M members predict (M, ..., columns of a head), as one prediction of the facts of ``columns``."""
    return Predicted(margin.mean(dim=0)[..., columns], logit.sigmoid().mean(dim=0)[..., columns], observed)


def _untrained(fact: Fact, file: str, hint: str) -> Problem:
    line, column = (fact.span.line, fact.span.column) if fact.span else (0, 0)
    return Problem(file, line, column, "WM013", "error", f"the fact head was not trained for `{fact}`", hint)
