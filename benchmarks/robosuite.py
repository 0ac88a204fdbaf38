"""robosuite's own tasks as a second world: our truth against its ``_check_success``, and repair by writing the state.

For every task of the world, states are made without knowing the task: objects and joints that its facts name, and the
arm, are moved at random (random), let go for five control steps (settled), and brought to where robosuite's success
changes (threshold): on the segment between a state that succeeds and one that does not, halved 24 times, so that its
ends are less than a micrometre or microradian apart. There is no baseline: robosuite's check is the oracle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.house_imports import naming_tasks_of
from benchmarks.protocol import Protocol, Row, Trial
from onto_compiler.knowledge import load_knowledge
from onto_compiler.required import RequiredABox
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import diagnose_goal, surplus, unmet
from runtime.loop.records import Episode
from runtime.loop.routing import route
from runtime.worlds.episodes import EpisodeRunner
from runtime.worlds.robosuite.environment import RobosuiteEnvironment
from runtime.worlds.robosuite.world import SUITE, WORLD
from runtime.worlds.world import find_task

__all__ = ["ROBOSUITE"]

SEED = 0
Array = NDArray[np.float64]
_HALVINGS = 24
_NEAR_M, _FAR_M = 0.02, 0.3  # how far from what a fact names an object is thrown
_FREE, _QUATERNION = 7, slice(3, 7)
_GRIP = "gripper0_grip_site"


@dataclass(frozen=True, slots=True)
class Agreement:
    """How many states of each kind, and how many initial states are repaired."""

    randoms: int
    settled: int
    pairs: int  # of states, each of which gives two at the threshold
    repairs: int


COUNTS = {True: Agreement(400, 60, 100, 20), False: Agreement(60, 6, 10, 2)}


def trials(full: bool) -> list[Trial]:  # noqa: FBT001 - the protocol's signature
    """Of each task its states, and its repairs from initial states; once, the files that name its tasks."""
    found: list[Trial] = [{"key": "files", "kind": "files"}]
    for ref in WORLD.tasks(SUITE):
        found.append({"key": f"{ref.name}/states", "kind": "states", "task": ref.name, "full": full})
        found += [
            {"key": f"{ref.name}/{state}", "kind": "repair", "task": ref.name, "state": state}
            for state in range(COUNTS[full].repairs)
        ]
    return found


def run(trial: Trial) -> list[Row]:
    """One row: of a task's states, of one repair, or of the files."""
    if trial["kind"] == "files":
        return [{"mode": "none", "sees": "none", "files": naming_tasks_of(WORLD.name)}]
    runner = _runner(trial["task"])
    if trial["kind"] == "repair":
        return [_repair(runner, trial["state"])]
    return [_states(runner, COUNTS[trial["full"]])]


@lru_cache(maxsize=1)
def _runner(task: str) -> EpisodeRunner:
    """The scene of the task that this process works on; trials come task by task."""
    return EpisodeRunner.open(WORLD, find_task(SUITE, WORLD.tasks(SUITE), task), load_knowledge(), seed=SEED)


def _repair(runner: EpisodeRunner, state: int) -> Row:
    episode = runner.run(state)
    left = diagnose_goal(episode.required, episode.final, runner.knowledge.tables) if not episode.accepted else ()
    return {
        "mode": "state",
        "sees": "privileged-state",
        "outcome": episode.outcome,
        "accepted": episode.accepted,
        "settled": _settled(episode),
        "attempts": len(episode.attempts),
        "failures": [
            {
                "failure": local_name(each.failure),
                "fact": str(each.fact),
                "margin": each.margin,
                "route": local_name(route(each, runner.knowledge).route),
            }
            for each in left
        ],
    }


def _settled(episode: Episode) -> bool:
    return bool(episode.accepted and episode.verification is not None and episode.verification.settled)


def _states(runner: EpisodeRunner, counts: Agreement) -> Row:
    environment = runner.environment
    if not isinstance(environment, RobosuiteEnvironment):
        raise TypeError(f"{environment} is not robosuite's")
    prober = _Prober(environment, runner.required, np.random.default_rng(SEED))
    for index in range(10):
        environment.start(index)
        prober.compare("initial")
    environment.start(0)
    base = environment.task.snapshot()
    prober.starts = [environment.qpos]
    runner.correct(0)
    prober.starts.append(environment.qpos)  # repaired, where repair serves the task
    ends = [environment.qpos, *prober.thrown(base, counts.randoms)]
    for qpos in prober.thrown(base, counts.settled):
        environment.task.restore(base)
        environment.task.write_qpos(qpos)
        environment.task.settle(5)
        prober.compare("settled")
    prober.thresholds(base, ends, counts.pairs)
    return {"mode": "none", "sees": "privileged-state", **prober.row, "decided_alone": prober.decided}


@dataclass(slots=True)
class _Prober:
    """Makes states of one open task, and holds our grounding to robosuite's success in each."""

    environment: RobosuiteEnvironment
    required: RequiredABox
    rng: np.random.Generator
    row: dict[str, Any] = field(default_factory=dict)
    starts: list[Array] = field(default_factory=list)  # what random states are made from, each a qpos (nq,)
    alone: dict[str, list[Array]] = field(default_factory=dict)  # states in which a fact was the only one unmet
    _scratch: mujoco.MjData = field(init=False)

    def __post_init__(self) -> None:
        self._scratch = mujoco.MjData(self.environment.model)
        self.starts = self.starts or [self.environment.qpos]

    def compare(self, kind: str) -> bool:
        """Count the present state as one of ``kind``, and whether the two agree; gives robosuite's verdict."""
        native = self.environment.verify().outcome
        observation = self.environment.observe()
        left = unmet(self.required, observation)
        truth = not left
        if len(left) == 1:
            fact = str(self.required.facts[left[0]])
            self.alone.setdefault(fact, []).append(self.environment.qpos)
        margins = surplus(self.required.facts, observation)
        margin = max(min((margins[i] for i in way), default=np.inf) for way in self.required.ways)
        wrong = (margin > 0.0 and not native) or (margin < 0.0 and native)
        for name, amount in (
            ("states", 1),
            (kind, 1),
            ("true_states", native),
            ("differences", truth is not native),
            ("wrong_signs", wrong),
        ):
            self.row[name] = self.row.get(name, 0) + int(amount)
        return native

    def thrown(self, base: Any, count: int) -> Iterator[Array]:  # noqa: ANN401 - a snapshot of the world's own
        """``count`` random states, each compared and given as its ``qpos`` (nq,)."""
        for _ in range(count):
            self.environment.task.restore(base)
            self.environment.task.write_qpos(self._thrown())
            self.compare("random")
            yield self.environment.qpos

    @property
    def decided(self) -> dict[str, int]:
        """In how many of the states each fact was the only one unmet."""
        return {fact: len(states) for fact, states in sorted(self.alone.items())}

    def thresholds(self, base: Any, ends: Sequence[Array], count: int) -> None:  # noqa: ANN401 - as above
        """Compare the two states on either side of robosuite's threshold between ``count`` pairs of states.

        One of each pair is among ``ends`` and succeeds; in the other one fact alone is unmet, each fact in turn.
        """
        good = [qpos for qpos in ends if self._succeeds(base, qpos)]
        kinds = [list(states) for states in self.alone.values()]
        for number in range(count if good and kinds else 0):
            bad = kinds[number % len(kinds)]
            pair = good[self.rng.integers(len(good))], bad[self.rng.integers(len(bad))]
            low, high = 0.0, 1.0  # `low` succeeds, `high` does not
            for _ in range(_HALVINGS):
                middle = (low + high) / 2
                low, high = (middle, high) if self._succeeds(base, self._between(*pair, middle)) else (low, middle)
            for share in (low, high):
                self._succeeds(base, self._between(*pair, share))
                self.compare("threshold")

    def _succeeds(self, base: Any, qpos: Array) -> bool:  # noqa: ANN401 - as above
        self.environment.task.restore(base)
        self.environment.task.write_qpos(qpos)
        return self.environment.verify().outcome

    def _between(self, first: Array, second: Array, share: float) -> Array:
        """The state at ``share`` of the way, orientations being of unit length."""
        qpos = first + share * (second - first)
        model = self.environment.model
        for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
            pose = qpos[model.jnt_qposadr[joint] :][:_FREE]
            length = np.linalg.norm(pose[_QUATERNION])
            pose[_QUATERNION] = pose[_QUATERNION] / length if length > 1e-6 else (1.0, 0.0, 0.0, 0.0)
        return qpos

    def _thrown(self) -> Array:
        """A random state: what the goal's facts name is moved, and the arm is brought to some of it."""
        rng, scene = self.rng, self.environment.scene
        model, qpos = scene.model, self.starts[self.rng.integers(len(self.starts))].copy()
        names = list(dict.fromkeys(name for fact in self.required.facts for name in fact.native.arguments))
        anchors = list(self._places(qpos, (*names, _GRIP)))
        if rng.random() < 0.5:
            anchors = [anchors[rng.integers(len(anchors))]]  # one place for all, so that they meet
        moved = rng.random() < 0.6
        for name in names:
            free = scene.free_joint(name) if name in scene.entities else None
            if free is not None and moved:
                pose = qpos[scene.qpos_slice(free)]
                spread = np.exp(rng.uniform(np.log(_NEAR_M), np.log(_FAR_M)))
                pose[:3] = anchors[rng.integers(len(anchors))] + rng.normal(size=3) * spread
                if rng.random() < 0.5:
                    turn = rng.normal(size=4)
                    pose[_QUATERNION] = turn / np.linalg.norm(turn)
            for each in scene.naming.joints.get(name, ()):
                joint = model.joint(each).id
                low, high = model.jnt_range[joint]
                qpos[model.jnt_qposadr[joint]] = rng.uniform(low - 0.1, high + 0.1)
        if rng.random() < 0.6:
            places = list(self._places(qpos, names)) or [qpos[:3]]
            qpos = self._reaching(qpos, places[rng.integers(len(places))] + rng.normal(size=3) * _NEAR_M / 2)
        fingers = [j for j in range(model.njnt) if model.joint(j).name.startswith("gripper0")]
        opening = rng.random() if rng.random() < 0.5 else rng.random(len(fingers))
        low, high = model.jnt_range[fingers].T
        qpos[model.jnt_qposadr[fingers]] = opening * np.where(-low > high, low, high)
        return qpos

    def _reaching(self, qpos: Array, target: Array) -> Array:
        """``qpos`` with the arm's joints moved so that the grip is at ``target`` (3,), as near as it comes."""
        model, data = self.environment.model, self._scratch
        arm = [j for j in range(model.njnt) if model.joint(j).name.startswith("robot0")]
        address, dof = model.jnt_qposadr[arm], model.jnt_dofadr[arm]
        jacobian, site = np.zeros((3, model.nv)), model.site(_GRIP).id
        qpos = qpos.copy()
        for _ in range(30):
            data.qpos[:] = qpos
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_jacSite(model, data, jacobian, None, site)
            part = jacobian[:, dof]
            step = part.T @ np.linalg.solve(part @ part.T + 1e-3 * np.eye(3), target - data.site_xpos[site])
            qpos[address] = np.clip(qpos[address] + step, *model.jnt_range[arm].T)
        return qpos

    def _places(self, qpos: Array, names: Sequence[str]) -> Iterator[Array]:
        """Where the entities and sites of ``names`` are in ``qpos``."""
        scene, data = self.environment.scene, self._scratch
        data.qpos[:] = qpos
        mujoco.mj_kinematics(scene.model, data)
        for name in names:
            if name in scene.entities:
                yield data.xpos[scene.root_body(name)].copy()
            elif scene.is_site(name):
                yield data.site_xpos[scene.site(name)].copy()


def metrics(rows: Sequence[Row]) -> Mapping[str, float]:
    """States and disagreements in all and by task; the share of repaired initial states, and what stayed unmet."""
    whole = [row for row in rows if "crashed" not in row]
    states = [row for row in whole if row["kind"] == "states"]
    repairs = [row for row in rows if row["kind"] == "repair"]
    found: dict[str, float] = {
        "tasks": len({row["task"] for row in states}),
        "crashed": len(rows) - len(whole),
        "files_for_a_world": sum(len(row["files"]) for row in whole if row["kind"] == "files"),
    }
    for name in ("states", "random", "settled", "threshold", "true_states", "differences", "wrong_signs"):
        found[name] = sum(row.get(name, 0) for row in states)
    found["repairs"] = len(repairs)
    found["repaired_share"] = sum(bool(row.get("accepted")) for row in repairs) / max(len(repairs), 1)
    for name in dict.fromkeys(row["task"] for row in repairs):
        mine = [row for row in repairs if row["task"] == name]
        found[f"{name}.repaired_share"] = sum(bool(row.get("accepted")) for row in mine) / len(mine)
        found[f"{name}.settled_share"] = sum(bool(row.get("settled")) for row in mine) / len(mine)
    for row in repairs:
        for failure in row.get("failures", ()):
            name = f"unresolved.{failure['failure']}"
            found[name] = found.get(name, 0) + 1
    return found


ROBOSUITE = Protocol(
    name="robosuite",
    help="robosuite's own tasks as a second world: truth against its success check, and repair by writing the state",
    seeds=(SEED,),
    trials=trials,
    run=run,
    metrics=metrics,
)
