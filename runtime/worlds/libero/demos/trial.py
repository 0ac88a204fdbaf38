"""Collects one trial: a demonstration, or the reason why there is none.

A trial is determined by its task, the seed and its number: collecting it again gives the same bytes.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from runtime.loop.diagnosis import unmet
from runtime.loop.faults import RunFault
from runtime.worlds.libero.demos.describe import SIZE
from runtime.worlds.libero.demos.disturb import Disturber
from runtime.worlds.libero.demos.hidden import hidden_of
from runtime.worlds.libero.demos.proprioception import OBSERVED, proprioception, robot_states
from runtime.worlds.libero.demos.recorder import DemoRecorder
from runtime.worlds.libero.demos.records import IMAGES, Demonstration, Origin
from runtime.worlds.libero.demos.released import Released
from runtime.worlds.libero.loop.environment import PREMISE_STEPS
from runtime.worlds.libero.scene.facts import ForwardedFacts
from runtime.worlds.libero.scene.horizons import horizon_of
from runtime.worlds.libero.scene.observations import Observer
from runtime.worlds.libero.scene.views import Views
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.skills.play import PlayedEpisode, Player
from runtime.worlds.required import required_of

__all__ = ["AFTER", "HELD_OUT", "PAST", "TaskCollector"]

HELD_OUT = 40  # official initial states from this one on are for evaluation, and never demonstrated from
PAST = 10  # steps with an open, resting hand that are recorded past the end of the skill
AFTER = 20  # further steps, unrecorded, after which the task must still be done


class TaskCollector:
    """Collects trials of one task, in a scene of its own."""

    def __init__(self, ref: TaskRef, knowledge: Knowledge, seed: int, model_file: str, *, images: bool) -> None:
        """Load the scene; raises ``SIM013`` if the task has no official initial states, and as ``onto ground``."""
        self._ref, self._seed, self._model_file = ref, seed, model_file
        self._states = initial_states(ref)[:HELD_OUT]
        scene = compile_scene(ref.bddl, pictures=images)
        self._required: RequiredABox = required_of(ref, knowledge, ordered=True)
        self._player = Player(scene, self._required, knowledge)
        self._observer = Observer(scene, (), OBSERVED)
        cameras = tuple(IMAGES.values()) if images else ()
        self._views = Views(scene.model, cameras, (SIZE, SIZE), "opengl", fast=False)
        self._keys = {f"{camera}_image": key for key, camera in IMAGES.items()} if images else {}
        self._released = Released(scene.model)
        self._recorder = DemoRecorder(scene, self._look, self._holds, ForwardedFacts(self._player.grounder))

    def collect(self, trial: int) -> Demonstration | str:
        """The demonstration of ``trial`` (from 0), or why it gave none.

        It starts from an official initial state that is not held out, and counts if the goal holds at its end and still
        after :data:`AFTER` steps with the gripper open and touching no movable object.
        """
        index = trial % len(self._states)
        rng = np.random.default_rng([self._seed, zlib.crc32(f"{self._ref.suite}/{self._ref.name}".encode()), trial])
        # The first quarter of the scale is left as it is, so that some demonstrations are undisturbed.
        severity = max(0.0, float(rng.uniform(-1.0 / 3.0, 1.0)))
        disturber = Disturber(rng, severity)
        recorder = self._recorder
        try:
            recorder.prepare(self._states[index], PREMISE_STEPS)
            recorder.begin(disturber)
            horizon = horizon_of(self._ref.suite)
            played = self._player.reactive(recorder, horizon)
            if not played.holds:
                return f"not done in {len(recorder.actions)} steps: {_why(played)}"
            recorder.calm()
            recorder.settle(PAST)
            recorder.end()
            if (wrong := self._lacking(recorder.data)) or not recorder.success_step:
                return f"after {PAST} steps: {wrong or 'never true'}"
            recorder.settle(AFTER)
            if wrong := self._lacking(recorder.data):
                return f"after {PAST + AFTER} steps: {wrong}"
        except RunFault as fault:
            return str(fault)
        origin = Origin(
            trial,
            self._seed,
            index,
            recorder.success_step,
            severity,
            tuple(disturber.events),
            tuple(asdict(one) for one in played.tries),
            np.array(recorder.wanted),
        )
        return self._demonstration(origin)

    def _demonstration(self, origin: Origin) -> Demonstration:
        recorder = self._recorder
        before, count, flat = recorder.before, len(recorder.actions), recorder.state_size
        states = np.stack([one.integration[:flat] for one in before])
        last = np.zeros(count, dtype=np.uint8)
        last[-1] = 1
        pictures = {key: np.stack([seen[image] for seen in recorder.observed]) for image, key in self._keys.items()}
        return Demonstration(
            name="demo_0",
            states=states,
            actions=np.array(recorder.actions),
            rewards=last,
            dones=last.copy(),
            obs={**proprioception(recorder.observed), **pictures},
            robot_states=robot_states(recorder.observed),
            init_state=states[0],
            model_file=self._model_file,
            pictures=tuple(pictures),
            start=before[0],
            origin=origin,
            hidden=hidden_of(before, flat),
            truth=np.stack(recorder.truth),
            facts=tuple(map(str, self._required.facts)),
        )

    def _holds(self, data: mujoco.MjData) -> bool:
        return not unmet(self._required, self._player.grounder.observe(data))

    def _lacking(self, data: mujoco.MjData) -> str:
        """Why the present state is not a good end, or nothing."""
        if not self._holds(data):
            return "undone"
        return "" if self._released(data) else "not let go"

    def _look(self, data: mujoco.MjData) -> Mapping[str, NDArray[Any]]:
        return {**self._observer.read(data), **self._views.look(data)}

    def close(self) -> None:
        """Free the renderer."""
        self._views.close()


def _why(played: PlayedEpisode) -> str:
    """How the last skill ended, or that there was none to go on with."""
    last = played.tries[-1].outcome if played.tries else "held"
    return "no skill offers itself" if last == "held" else last
