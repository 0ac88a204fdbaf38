"""A native LIBERO task as the loop's environment: grounded by us, changed by writing its state, judged by LIBERO."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.scenes import Scene
from onto_compiler.bddl.parse import parse_file
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.records import Verification
from runtime.worlds.environment import StateEnvironment, settling
from runtime.worlds.fixtures import FixturePoses
from runtime.worlds.libero.demos.fixtures import fixtures_of
from runtime.worlds.libero.loop.uncertain import Placements, uncertain_row
from runtime.worlds.libero.simulator.assets import initial_states
from runtime.worlds.libero.simulator.native import NativeTask, versions
from runtime.worlds.libero.simulator.native_import import predicate_names
from runtime.worlds.world import TaskRef

__all__ = ["PREMISE_STEPS", "LiberoEnvironment", "NativeEnvironment"]

PREMISE_STEPS = 10  # official initial states hang above the table: the field settles them by ten steps without motion
_QUERY = "check_success()"
_ATOMS = "_eval_predicate() of each atom"  # of a goal with connectives or quantifiers, which LIBERO's check lacks


class NativeEnvironment(StateEnvironment):
    """The loop's :class:`~runtime.loop.correction.Environment` over a :class:`NativeTask`; proposals write ``qpos``."""

    def __init__(self, task: NativeTask, required: RequiredABox, schema: Schema) -> None:
        """Resolve the required facts in the task's scene; raises ``SIM001`` ff. if one names what it lacks."""
        super().__init__(task, Scene(task.model), required, schema)
        self._task = task
        self._required = required

    def textured(self) -> mujoco.MjModel:
        """The scene with its textures, compiled anew."""
        return self._task.textured()

    @property
    def judged(self) -> bool:
        """Whether LIBERO can judge the goal: whole, or else each atom that it is made of."""
        known = predicate_names()
        return self._task.judged or all(fact.native.predicate.lower() in known for fact in self._required.facts)

    def verify_natively(self) -> Verification:
        """LIBERO's verdict; raises ``SIM018`` if it can judge neither the goal nor its atoms."""
        return Verification(_QUERY if self._task.judged else _ATOMS, self._success())

    def _success(self) -> bool:
        """LIBERO's verdict on the goal, or, atom by atom, on any of its alternatives."""
        if self._task.judged or not self.judged:
            return self._task.success()
        facts = self._required.facts
        ways = ([facts[index] for index in way] for way in self._required.ways)
        return any(all(self._task.evaluate(fact.native) is fact.polarity for fact in way) for way in ways)


class LiberoEnvironment(NativeEnvironment):
    """The environment of one task of LIBERO, with its initial states: what :class:`World` opens."""

    def __init__(self, ref: TaskRef, required: RequiredABox, schema: Schema, seed: int) -> None:
        """Build the scene of ``ref``; raises ``SIM`` problems."""
        task = NativeTask.open(ref, seed)
        super().__init__(task, required, schema)
        self.seed = seed
        self._ref, self._schema = ref, schema
        self._placements = Placements(parse_file(ref.bddl), self.scene)
        self._fixtures: FixturePoses | None = None
        self._fresh = np.concatenate([[task.data.time], task.data.qpos, task.data.qvel])  # after the seeded reset

    @property
    def task(self) -> NativeTask:
        """LIBERO's own environment."""
        return self._task

    def start(self, index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Write the initial state and let it settle. A task without official states has one: its seeded reset."""
        steps = settling(state, settle, PREMISE_STEPS)
        self._task.reset_to(self._official(index) if state is None else state, self._fixtures)
        self._task.settle(steps)
        if self._task.diverged:
            raise OntoError.of("SIM019", f"the simulation of `{self._ref.name}` diverged while its state settled")
        return steps

    def place(self, model: str) -> None:
        """Place the fixtures as in an MJCF file or a demonstration; raises as :func:`fixtures_of`."""
        self._fixtures = fixtures_of(model, self._task.model)

    def uncertain(self) -> tuple[dict[str, Any], ...]:
        """The required facts whose margin is within the rectangles that fixtures are drawn from."""
        found = self._placements.uncertain(self._required.facts, self.observe(), self._task.data)
        return tuple(uncertain_row(each, self._schema) for each in found)

    def versions(self) -> dict[str, str]:
        """Versions of the packages that affect physical results."""
        return versions()

    def close(self) -> None:
        """Free the scene."""
        self._task.close()

    def _official(self, index: int) -> NDArray[np.float64]:
        states = initial_states(self._ref) if self._ref.initial_states.is_file() else self._fresh[None]
        if not 0 <= index < len(states):
            message = f"`{self._ref.name}` has no initial state {index}"
            raise OntoError.of("SIM017", message, f"it has {len(states)}, from 0")
        return np.array(states[index])
