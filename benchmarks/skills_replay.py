"""A skill's episode again in LIBERO's own environment: from the initial state on, the native verdict, and the reasons.

An episode succeeds where the native predicate holds when it is over and again after :data:`AFTER` control steps without
motion, where nothing of the gripper touches what the goal is about at either time, and the fingers stand open at last.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.observation import Observation
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import diagnose_goal, satisfied
from runtime.wording import short_name, unit_of
from runtime.worlds.libero.simulator.assets import TaskRef
from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["AFTER", "SETTLE", "ReplayJudge", "ReplayVerdict"]

Array = NDArray[np.float64]

SETTLE = 10  # control steps without motion before an episode: official initial states hang above the table
AFTER = 20  # control steps without motion after it
OPEN = 0.07  # metres between the open fingers, of 0.08 at most
_GRIPPER = "gripper0_"
_DIGITS = 9  # of a margin


@dataclass(frozen=True, slots=True)
class ReplayVerdict:
    """What became of an episode.

    ``outcome`` is ``success``; ``unmet``, where the goal was false at its end; ``held``, where the gripper had not let
    go; ``unsettled``, where the goal was false :data:`AFTER` steps later; or ``diverged``. ``success_step`` is the
    first control step after which the native predicate held. ``failures`` are the typed records of what was unmet when
    the outcome was decided. ``same`` says that the replay ended where the exact simulation did, to the last bit.
    """

    outcome: str
    accepted: bool  # natively, after the last action
    settled: bool  # and after AFTER more steps
    success_step: int | None
    failures: tuple[dict[str, Any], ...]
    premise_holds: bool
    initially_true: bool
    same: bool


class ReplayJudge:
    """Replays episodes of one task natively. The environment is built once; every replay starts by a state write."""

    def __init__(self, ref: TaskRef, required: RequiredABox, knowledge: Knowledge, seed: int = 0) -> None:
        """Build the native environment of ``ref``; raises as :class:`NativeTask` and :class:`SimGrounder`."""
        self._task = NativeTask.open(ref, seed)
        self._required, self._knowledge = required, knowledge
        scene = Scene(self._task.model)
        self._grounder = SimGrounder(scene, required.facts, knowledge.schema)
        self._premise = SimGrounder(scene, required.premise, knowledge.schema)
        self._fingers, self._gripper, self._goal = _parts(scene, required)

    def close(self) -> None:
        """Free the environment."""
        self._task.close()

    def run(self, state: ArrayLike, actions: Array, final: Array) -> ReplayVerdict:
        """Play ``actions`` (n, 7) from the flat initial ``state`` after settling; ``final`` (nq,) is where they led."""
        task = self._task
        task.reset_to(state)
        task.settle(SETTLE)
        premise = satisfied(self._required.premise, self._premise.observe(task.data))
        initially, first = task.success(), None
        for step, action in enumerate(actions, start=1):
            if task.step(action) and first is None:
                first = step
        same = bool(np.array_equal(task.data.qpos, final))
        ended, free, at_end = task.success(), not self._touching(), self._grounder.observe(task.data)
        task.settle(AFTER)
        stayed, released = task.success(), free and not self._touching() and self._aperture() > OPEN
        after = self._grounder.observe(task.data)
        outcome = "unmet" if not ended else "unsettled" if not stayed else "held" if not released else "success"
        if task.diverged:
            outcome = "diverged"
        failures = self._typed({"unmet": at_end, "unsettled": after}.get(outcome))
        premise_holds = bool(premise.all())
        return ReplayVerdict(outcome, ended, ended and stayed, first, failures, premise_holds, initially, same)

    def _typed(self, seen: Observation | None) -> tuple[dict[str, Any], ...]:
        """The diagnosis of each fact that is unmet in ``seen``, as JSON."""
        if seen is None:
            return ()
        schema = self._knowledge.schema
        return tuple(
            {
                "failure": short_name(each.failure, schema),
                "fact": str(each.fact),
                "margin": None if np.isnan(each.margin) else round(float(each.margin), _DIGITS),
                "unit": unit_of(each.fact, schema),
                "limit": each.limit,
                "status": local_name(each.status),
            }
            for each in diagnose_goal(self._required, seen, self._knowledge.tables)
        )

    def _touching(self) -> bool:
        contact = self._task.data.contact
        first, second = contact.geom1, contact.geom2
        gripper, goal = self._gripper, self._goal
        return bool(((gripper[first] & goal[second]) | (gripper[second] & goal[first])).any())

    def _aperture(self) -> float:
        first, second = self._task.data.qpos[self._fingers]
        return abs(float(first - second))


def _parts(scene: Scene, required: RequiredABox) -> tuple[NDArray[np.intp], NDArray[np.bool_], NDArray[np.bool_]]:
    """Addresses of the fingers (2,), and by geom whether it is the gripper's, and whether the goal is about it.

    A goal is about what its facts are about: their first arguments, of a region the body that carries it.
    """
    model = scene.model
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body) or "" for body in range(model.nbody)]
    gripper = np.array([name.startswith(_GRIPPER) for name in names])[model.geom_bodyid]
    about = np.zeros(model.nbody, dtype=np.bool_)
    for fact in required.facts:
        name = fact.native.arguments[0]
        if name in scene.entities:
            about[scene.bodies(name)] = True
        else:
            about[model.site_bodyid[scene.site(name)]] = True
    fingers = [j for j in range(model.njnt) if _joint(model, j).startswith(_GRIPPER)]
    return np.array(model.jnt_qposadr[fingers], dtype=np.intp), gripper, about[model.geom_bodyid]


def _joint(model: mujoco.MjModel, joint: int) -> str:
    return mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint) or ""
