"""A maze's task as typed facts: the required ones, and their grounding in states.

One state is grounded as any scene is, by :class:`grounding.sim.SimGrounder` on MuJoCo's arrays. Thousands of states, to
label training data with, are grounded at once by the same arithmetic (:meth:`MazeFacts.label`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.predicates.planar import apart, clearance, target_address
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.bddl import lift, parse_file
from onto_compiler.bddl.parse import parse
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema, local_name
from runtime.worlds.pointmaze.maze import RADIUS, TARGET, Maze
from runtime.worlds.pointmaze.rollout import checked_states

__all__ = ["MazeFacts", "StateLabels", "place", "required_facts", "task_file"]

_TASKS = Path(__file__).parent / "tasks"
Margin: TypeAlias = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def task_file() -> Path:
    """The task of the published trials: ball at the target, at its velocity, in no wall."""
    return _TASKS / "u_maze.bddl"


def required_facts(knowledge: Knowledge, path: Path | None = None) -> RequiredABox:
    """The required ABox of the task file at ``path``, by default :func:`task_file`. Raises as ``onto compile``."""
    found = task_file() if path is None else path
    # Named as in its package, so that the same run makes the same trace everywhere.
    spec = parse_file(found) if path else parse(found.read_text(encoding="utf-8"), f"pointmaze/{found.name}")
    return lift(spec, knowledge.schema, found.stem)[0]


def place(data: mujoco.MjData, maze: Maze, state: NDArray[np.floating], goal: NDArray[np.floating]) -> None:
    """Write a state (4,) and a goal (4,) to ``data`` of the maze's model, and compute its poses."""
    here, there = checked_states(state), checked_states(goal)
    address = target_address(maze.model, TARGET)
    data.qpos[:], data.qvel[:] = here[:2], here[2:]
    data.userdata[address : address + len(there)] = there
    data.mocap_pos[0, :2] = maze.model.body(f"{TARGET}_main").pos[:2] + there[:2]
    mujoco.mj_kinematics(maze.model, data)


@dataclass(frozen=True, slots=True, eq=False)
class StateLabels:
    """Of states (...) and F required facts: ``truth`` and signed ``margin``, each (..., F), in the TBox's units."""

    truth: NDArray[np.bool_]
    margin: NDArray[np.float64]


class MazeFacts:
    """Grounds the required facts of ``required`` in states of ``maze``."""

    def __init__(self, maze: Maze, required: RequiredABox, knowledge: Knowledge) -> None:
        """Resolve every fact; raises ``SIM001`` ff. if one names what a maze lacks."""
        self.maze, self.required, self.scene = maze, required, Scene(maze.model)
        self._grounder = SimGrounder(self.scene, required.facts, knowledge.schema)
        self._data = mujoco.MjData(maze.model)
        self._margins = tuple(_margin(fact, knowledge.schema) for fact in required.facts)

    def observe(self, state: NDArray[np.floating], goal: NDArray[np.floating], step: int = 0) -> Observation:
        """The observed ABox, source ``sim``, of a state (4,) and a goal (4,).

        Raises ``PMZ003`` for other shapes, ``PMZ004`` for numbers that are not finite.
        """
        place(self._data, self.maze, state, goal)
        return self._grounder.observe(self._data, step)

    def label(self, states: NDArray[np.floating], goals: NDArray[np.floating]) -> StateLabels:
        """Truth and margin of every fact in ``states`` (..., 4), each for its goal of ``goals`` (4,) or (..., 4).

        They are those of :meth:`observe`. Raises ``PMZ003``, ``PMZ004`` as it does.
        """
        here, there = np.broadcast_arrays(checked_states(states), checked_states(goals))
        walls = self.maze.wall_boxes
        margin = np.stack([of(here, there, walls) for of in self._margins], axis=-1)
        return StateLabels(margin > 0.0, margin)


def _margin(fact: Fact, schema: Schema) -> Margin:
    """The margin of ``fact`` from states, goals (..., 4) and walls (W, 4); raises ``SIM005`` if there is none."""
    allowed = schema.predicates[fact.predicate].tolerance or 0.0
    margins: dict[str, Margin] = {
        "at_target": lambda here, there, _: allowed - apart(there[..., :2], here[..., :2]),
        "velocity_matches": lambda here, there, _: allowed - apart(there[..., 2:], here[..., 2:]),
        "free_of": lambda here, _, walls: allowed + (clearance(here[..., :2], walls) - RADIUS),
    }
    if fact.grounded_by not in margins:
        message = f"`{local_name(fact.predicate)}` is grounded by `{fact.grounded_by}`, which labels no states at once"
        raise OntoError.of("SIM005", message, f"a maze labels {', '.join(f'`{name}`' for name in margins)}")
    return margins[fact.grounded_by]
