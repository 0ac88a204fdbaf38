"""Play actions in a task's scene, and film them: pictures and the simulator's labels of every fact at the marks.

A mark is every fifth control step. Picture and proprioception are from the substep at which LIBERO observes; the labels
are from the end of the control step, like LIBERO's success check.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.sim import SimGrounder
from onto_compiler.knowledge import Knowledge
from runtime.worlds.libero.demos.proprioception import OBSERVED, proprioception
from runtime.worlds.libero.scene.observations import Observer
from runtime.worlds.libero.scene.views import Views
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.training.hand import sensed
from runtime.worlds.libero.training.scene import SceneFacts
from runtime.worlds.snapshot import Snapshot

__all__ = ["CAMERA", "MACRO", "PIXELS", "Film", "Filmer"]

CAMERA, PIXELS = "agentview", 128
MACRO = 5
"""Control steps between two marks."""
_KEY = f"{CAMERA}_image"
_FINGERS = ("finger",)
_ROBOT = ("robot0_", "gripper0_", "mount0_")


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """T control steps with K + 1 marks, K = T // 5.

    ``proprio`` (T + 1, P) and ``actions`` (T, 7) by control step; at the marks ``pictures`` (K + 1, S, S, 3), rows from
    the top, ``truth`` and ``margin`` (K + 1, F), margins in metres or radians, and ``clear`` (K + 1,): whether nothing
    of the robot but its fingers touches anything.
    """

    proprio: NDArray[np.float32]
    actions: NDArray[np.float32]
    pictures: NDArray[np.uint8]
    truth: NDArray[np.bool_]
    margin: NDArray[np.float32]
    clear: NDArray[np.bool_]


class Filmer:
    """Films episodes of one task, in a scene of its own.

    ``exact`` replays a demonstration bit for bit. The compiled loop is faster and may deviate in contacts; the film
    then shows the deviating run.
    """

    def __init__(self, ref: TaskRef, asked: SceneFacts, knowledge: Knowledge, *, exact: bool) -> None:
        """Load the scene; raises ``SIM031`` if this machine cannot draw, and as ``onto ground``."""
        self._scene = compile_scene(ref.bddl, pictures=True)
        self._simulation = Simulation(self._scene, exact=exact)
        self._grounder = SimGrounder(self._scene.index, asked.facts, knowledge.schema)
        self._observer = Observer(self._scene, (), OBSERVED)
        self._views = Views(self._scene.model, (CAMERA,), (PIXELS, PIXELS), "opencv", fast=True)
        self._robot, self._finger = _of_robot(self._scene.model)

    def film(self, start: Snapshot, actions: NDArray[np.float64], first: int = 0) -> Film:
        """Play ``actions`` (T, 7) from ``start``, and film from control step ``first`` on, a multiple of 5.

        Raises ``SIM004`` for a snapshot of another scene, and :class:`~runtime.loop.faults.RunFault` where it diverges.
        """
        simulation = self._simulation
        simulation.restore(start)
        observed = [self._observer.read(simulation.data)]
        marks = [self._mark(self._shoot())] if first == 0 else []
        seen: dict[str, Any] = {}

        def before_last_substep() -> None:
            seen["hand"] = self._observer.read(simulation.data)
            if seen["shoot"]:
                seen["picture"] = self._shoot()

        for step, action in enumerate(actions, start=1):
            seen["shoot"] = step >= first and step % MACRO == 0
            simulation.step(action, before_last_substep)
            observed.append(seen["hand"])
            if seen["shoot"]:
                marks.append(self._mark(seen["picture"]))
        states = proprioception(observed)
        hand = sensed(states["ee_pos"], states["ee_ori"], states["gripper_states"])
        columns = {name: np.stack([mark[name] for mark in marks]) for name in marks[0]}
        return Film(hand[first:], actions[first:].astype(np.float32), **columns)

    def _shoot(self) -> NDArray[np.uint8]:
        picture: NDArray[np.uint8] = self._views.look(self._simulation.data)[_KEY]
        return picture

    def _mark(self, picture: NDArray[np.uint8]) -> Mapping[str, NDArray[Any]]:
        found = self._grounder.observe(self._simulation.data)
        margin = found.margin.astype(np.float32)
        return {"pictures": picture, "truth": found.truth, "margin": margin, "clear": np.array(self._clear())}

    def _clear(self) -> bool:
        """Whether nothing of the robot but its fingers touches anything else than itself."""
        data, model = self._simulation.data, self._scene.model
        bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
        robot, finger = self._robot[bodies], self._finger[bodies]
        return not bool((robot & ~finger & ~robot[:, ::-1]).any())

    def close(self) -> None:
        """Free the renderer."""
        self._views.close()


def _of_robot(model: mujoco.MjModel) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Of each body: whether it is the robot's, and whether it is one of its fingers."""
    names = [model.body(body).name for body in range(model.nbody)]
    robot = np.array([name.startswith(_ROBOT) for name in names])
    return robot, robot & np.array([any(part in name for part in _FINGERS) for name in names])
