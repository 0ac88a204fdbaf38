"""A planner's sensors in the maze: pictures and proprioception, one per macro step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from grounding.world_model.dynamics import History
from grounding.world_model.encoder import Encoder
from grounding.world_model.pred import ObservedGoal
from onto_compiler.rdf import PREFIXES
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.worlds.pointmaze.cells import cell_way
from runtime.worlds.pointmaze.maze import ACTION_DIM, MACRO_STEPS, STATE_DIM, Maze
from runtime.worlds.pointmaze.picture import draw

__all__ = ["FULL", "POSITION", "Sensor"]

FULL = (True, True, True, True)
POSITION = (True, True, False, False)
"""Proprioception without velocity."""
_METRE, _METRE_PER_SECOND = (PREFIXES["unit"] + name for name in ("M", "M-PER-SEC"))
_UNITS = (_METRE, _METRE, _METRE_PER_SECOND, _METRE_PER_SECOND)
"""Of the coordinates of a state."""


class Sensor:
    """Senses an episode in ``maze``: ``sensed`` (4,) says which coordinates of a state are known."""

    def __init__(
        self, maze: Maze, encoder: Encoder, sensed: tuple[bool, ...], length: int, device: str = "cpu"
    ) -> None:
        self._maze, self._encoder, self._device = maze, encoder, device
        self._sensed = torch.tensor(sensed, device=device)
        self._proprio = np.full((length, STATE_DIM), np.nan)
        self._actions = np.full((length - 1, MACRO_STEPS, ACTION_DIM), np.nan)
        self._target = np.full(STATE_DIM, np.nan)

    def look(self, state: NDArray[np.float64]) -> torch.Tensor:
        """Features (D,) of the picture of a state (4,)."""
        features = self._encoder.encode(draw(self._maze, state[None], self._encoder.size))
        return torch.from_numpy(features)[0].to(self._device)

    def goal(self, state: NDArray[np.float64]) -> ObservedGoal:
        """A goal state (4,) as it is sensed."""
        self._target = state
        return ObservedGoal(self.look(state), self._tensor(self._hidden(state)), self._sensed)

    def observes(self, facts: Sequence[Fact], schema: Schema) -> tuple[bool, ...]:
        """For each fact whether its margin can be observed: pictures show positions only."""
        sensed = self._sensed.cpu().tolist()
        hidden = {unit for unit, known in zip(_UNITS, sensed, strict=True) if not known} - {_METRE}
        return tuple(schema.predicates[fact.predicate].margin_unit not in hidden for fact in facts)

    def begin(self, state: NDArray[np.float64]) -> None:
        """Start an episode in ``state`` (4,), and clear the history."""
        self._proprio[:], self._actions[:] = np.nan, np.nan
        self._proprio[-1] = state

    def moved(self, states: NDArray[np.float64], actions: NDArray[np.float64]) -> None:
        """``actions`` (T, 2) led through ``states`` (T + 1, 4); T is a multiple of the macro step."""
        for first in range(0, len(actions), MACRO_STEPS):
            self._proprio = np.concatenate([self._proprio[1:], states[None, first + MACRO_STEPS]])
            self._actions = np.concatenate([self._actions[1:], actions[None, first : first + MACRO_STEPS]])

    def history(self) -> History:
        """The history so far."""
        state = self._proprio[-1]
        return History(
            self.look(state), self._tensor(self._hidden(self._proprio)), self._tensor(self._actions), self._sensed
        )

    def between(self) -> torch.Tensor | None:
        """The centre (2,) of the cell halfway to the goal; None if the goal's cell is adjacent."""
        way = cell_way(self._maze, self._proprio[-1], self._target)
        return self._tensor(way[len(way) // 2]) if len(way) > 2 else None

    def _hidden(self, states: NDArray[np.float64]) -> NDArray[np.float64]:
        """``states`` (..., 4) with zeros for what is not sensed."""
        return np.where(self._sensed.cpu().numpy() | np.isnan(states), states, 0.0)

    def _tensor(self, values: NDArray[np.float64]) -> torch.Tensor:
        return torch.from_numpy(values).float().to(self._device)
