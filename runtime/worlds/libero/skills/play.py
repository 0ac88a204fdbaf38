"""Plays one episode with skills under dynamics: observe, choose an unmet fact, act, try the next candidate on failure.

*Reactive* play takes each decision once, in the running episode. *Look-ahead* play tries the candidates of a decision
in a fork of the simulation first, and executes the best of them: the simulator is its world model.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.sim import SimGrounder
from onto_compiler.conflicts import entails, exclude
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import satisfied, unmet
from runtime.loop.faults import RunFault
from runtime.loop.records import RouteDecision
from runtime.loop.routing import attempt_status, route_or_none
from runtime.worlds.libero.scene.targets import place_of, slot_of
from runtime.worlds.libero.simulator.actions import DUMMY_ACTION
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.skills.fault import SkillFault
from runtime.worlds.libero.skills.frames import Pose
from runtime.worlds.libero.skills.motion import OPEN, Action, grip, reach
from runtime.worlds.libero.skills.order import GoalStep, diagnose_step, ready
from runtime.worlds.libero.skills.protocol import SkillPlan, SkillRequest
from runtime.worlds.libero.skills.reach import Reach
from runtime.worlds.libero.skills.registry import load_skills
from runtime.worlds.libero.skills.world import SkillWorld, SurfacePoints

__all__ = ["PlayedEpisode", "Player", "SkillAttempt"]

Array = NDArray[np.float64]

CANDIDATES = 6  # that look-ahead tries for one decision
PAUSE = 3  # steps without motion after a skill, in which what was let go comes to rest
RECOVERY = 0.10  # metres that the hand rises after a failure
UNCHANGED = 1e-3  # metres and radians
_OVER = "horizon"


@dataclass(frozen=True, slots=True)
class SkillAttempt:
    """One executed skill: its fact, route, candidate, number of steps and outcome.

    ``outcome`` is ``held`` where the fact was true afterwards, ``unmet`` where it was not, the kind of the
    :class:`SkillFault`, or ``horizon`` if the episode was over. ``reason`` is the message of the fault.
    """

    fact: str
    route: str
    candidate: int
    note: str
    steps: int
    outcome: str
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class PlayedEpisode:
    """The actions of an episode (n, 7), the executed skills, and the goal's facts at the end.

    ``left`` are the remaining steps, the next one first, if it ended because no skill had a candidate for any.
    """

    actions: Array
    tries: tuple[SkillAttempt, ...]
    final: Observation
    holds: bool
    rehearsed: int  # control steps in forks
    left: tuple[GoalStep, ...] = ()


class _HorizonReached(Exception):  # noqa: N818 - the end of an episode, not an error
    pass


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """A grasp that was tried, and the poses of everything but the robot at that time."""

    pose: Pose
    scene: Array

    def again(self, scene: Array) -> bool:
        """Whether it would be tried in the same scene again."""
        return bool(np.allclose(self.scene, scene, rtol=0.0, atol=UNCHANGED))


@dataclass(slots=True)
class _Episode:
    """A running episode: the simulation, the actions so far, and by fact the grasps tried and the last route."""

    sim: Simulation
    world: SkillWorld
    reach: Reach
    horizon: int
    actions: list[Action] = field(default_factory=list)
    tries: list[SkillAttempt] = field(default_factory=list)
    tried: dict[str, list[_Tried]] = field(default_factory=dict)
    routed: dict[str, str] = field(default_factory=dict)
    rehearsed: int = 0

    def scene(self) -> Array:
        """The generalised positions of everything but the robot."""
        index, model, data = self.world.index, self.sim.model, self.sim.data
        joints = np.flatnonzero(~self.world.shapes.robot[model.jnt_bodyid])
        return np.concatenate([np.empty(0), *(data.qpos[index.qpos_slice(int(joint))] for joint in joints)])

    def drive(self, motion: Generator[Action, None, object]) -> None:
        """Carry out ``motion``; raises :class:`_HorizonReached`, and what the motion raises."""
        for action in motion:
            if len(self.actions) >= self.horizon:
                raise _HorizonReached
            self.sim.step(action)
            self.actions.append(np.array(action))


class Player:
    """Plays episodes of one task in its compiled scene."""

    def __init__(self, scene: CompiledScene, required: RequiredABox, knowledge: Knowledge) -> None:
        """Resolve the goal and its preconditions in the scene; raises ``SIM001`` ff. if they name what it lacks."""
        self.scene, self.required, self.knowledge = scene, required, knowledge
        schema = knowledge.schema
        self.grounder = SimGrounder(scene.index, required.facts, schema)
        self.conditions = SimGrounder(scene.index, [each.fact for each in required.preconditions], schema)
        self.skills = {name: make(schema) for name, make in load_skills(schema).items()}
        self.shapes = SurfacePoints(scene)
        self._scratch = mujoco.MjData(scene.model)

    def reactive(self, sim: Simulation, horizon: int) -> PlayedEpisode:
        """Play from the present state of ``sim`` for at most ``horizon`` control steps."""
        return self._play(self._begin(sim, horizon), candidates=1)

    def lookahead(self, sim: Simulation, horizon: int, candidates: int = CANDIDATES) -> PlayedEpisode:
        """The same, with up to ``candidates`` rehearsals of each decision in a fork of ``sim``."""
        return self._play(self._begin(sim, horizon), candidates=candidates)

    def _begin(self, sim: Simulation, horizon: int) -> _Episode:
        world = SkillWorld(sim, self.shapes)
        return _Episode(sim, world, Reach(world), horizon)

    def _play(self, episode: _Episode, candidates: int) -> PlayedEpisode:
        left: tuple[GoalStep, ...] = ()
        try:
            while len(episode.actions) < episode.horizon:
                if not self._act(episode, candidates):
                    left = self._steps(episode.sim)
                    break
        except (_HorizonReached, RunFault):
            pass
        final = self.grounder.observe(episode.sim.data)
        return PlayedEpisode(
            np.array(episode.actions).reshape(-1, len(DUMMY_ACTION)),
            tuple(episode.tries),
            final,
            not unmet(self.required, final),
            episode.rehearsed,
            left,
        )

    def _steps(self, sim: Simulation) -> tuple[GoalStep, ...]:
        """The remaining steps, the next one first."""
        observed, conditions = self.grounder.observe(sim.data), self.conditions.observe(sim.data)
        return ready(self.required, observed, conditions, self.knowledge)

    def _act(self, episode: _Episode, candidates: int) -> bool:
        """Execute one skill for the first step with a candidate; False if no step is left or none has a candidate."""
        for step in self._steps(episode.sim):
            if self._true(episode.sim, step):
                continue  # it will be undone on the way, and must be achieved again then
            decision = self._route(episode, step)
            skill = self.skills.get(local_name(decision.route)) if decision else None
            if decision is None or skill is None:
                continue
            tried, scene = episode.tried.setdefault(str(step.fact), []), episode.scene()
            for _ in range(2):
                poses = tuple(each.pose for each in tried)
                request = self._request(episode.world, episode.reach, step, poses)
                plan = self._choose(episode, step, skill.candidates(request), candidates)
                if plan is not None:
                    tried += [_Tried(pose, scene) for pose in plan.poses]
                    self._record(episode, step, decision, plan)
                    return True
                same = [each for each in tried if each.again(scene)]
                if len(same) == len(tried):
                    break
                tried[:] = same  # the scene has changed: a grasp that failed before may work now
        return False

    def _record(self, episode: _Episode, step: GoalStep, decision: RouteDecision, plan: SkillPlan) -> None:
        before, outcome, reason = len(episode.actions), _OVER, ""
        number = 1 + sum(each.fact == str(step.fact) for each in episode.tries)
        try:
            outcome, reason = self._carry_out(episode, plan, step)
        finally:
            steps = len(episode.actions) - before
            episode.routed[str(step.fact)] = decision.route
            route = local_name(decision.route)
            episode.tries.append(SkillAttempt(str(step.fact), route, number, plan.note, steps, outcome, reason))

    def _route(self, episode: _Episode, step: GoalStep) -> RouteDecision | None:
        """The declared route of the action level for a step: dispatched at first, retried after.

        A try of another fact in between changes nothing.
        """
        data = episode.sim.data
        diagnosis = diagnose_step(
            step, self.required, self.grounder.observe(data), self.conditions.observe(data), self.knowledge
        )
        before = episode.routed.get(str(step.fact))
        return route_or_none(diagnosis, self.knowledge, attempt_status(before), before, level="action")

    def _choose(
        self, episode: _Episode, step: GoalStep, found: Iterator[SkillPlan], candidates: int
    ) -> SkillPlan | None:
        return next(found, None) if candidates <= 1 else self._rehearse(episode, step, found, candidates)

    def _carry_out(self, episode: _Episode, plan: SkillPlan, step: GoalStep) -> tuple[str, str]:
        """The outcome, and the reason if it gave up."""
        world = episode.world
        try:
            episode.drive(plan.run(world, episode.reach))
            episode.drive(grip(world, OPEN, PAUSE))
        except SkillFault as fault:
            episode.drive(grip(world, OPEN, PAUSE))
            episode.drive(reach(world, world.eef.moved(np.array([0.0, 0.0, RECOVERY])), OPEN, steps=15))
            return fault.kind, str(fault)
        return "held" if self._true(episode.sim, step) else "unmet", ""

    def _true(self, sim: Simulation, step: GoalStep) -> bool:
        grounder = self.conditions if step.precondition else self.grounder
        return bool(self._satisfied(grounder, sim.data)[step.index])

    def _satisfied(self, grounder: SimGrounder, data: mujoco.MjData) -> NDArray[np.bool_]:
        """Which of the facts of a grounder hold in a state."""
        return satisfied(grounder.facts, grounder.observe(data))

    def _rehearse(
        self, episode: _Episode, step: GoalStep, found: Iterator[SkillPlan], candidates: int
    ) -> SkillPlan | None:
        """Try plans in a fork, each with the rest of the episode played reactively; the first that reaches the goal.

        If none does, the one with the fewest remaining steps.
        """
        fork = Simulation(self.scene, exact=episode.sim.exact)
        start = episode.sim.snapshot()
        best: tuple[int, SkillPlan] | None = None
        for plan in islice(found, candidates):
            fork.restore(start)
            trial = self._fork_of(episode, fork)
            trial.tried[str(step.fact)] += [_Tried(pose, trial.scene()) for pose in plan.poses]
            try:
                self._carry_out(trial, plan, step)
                while len(trial.actions) < trial.horizon and self._act(trial, 1):
                    pass
                fork.settle(PAUSE)
            except (_HorizonReached, RunFault):
                pass
            episode.rehearsed += len(trial.actions) + PAUSE
            left = len(self._steps(fork))
            if best is None or -left > best[0]:
                best = (-left, plan)
            if not left:
                break
        return best[1] if best else None

    def _fork_of(self, episode: _Episode, fork: Simulation) -> _Episode:
        trial = self._begin(fork, episode.horizon - len(episode.actions))
        trial.tries, trial.routed = list(episode.tries), dict(episode.routed)
        trial.tried = {fact: list(tried) for fact, tried in episode.tried.items()}
        return trial

    def _request(self, world: SkillWorld, reach_: Reach, step: GoalStep, tried: Sequence[Pose]) -> SkillRequest:
        sharing = slot_of(self.required, step.fact)[1]
        holds = self._holds(world, step)
        return SkillRequest(
            world, reach_, step.fact, self.knowledge.schema, holds, tried, sharing, self._ways(world, step)
        )

    def _ways(self, world: SkillWorld, step: GoalStep) -> tuple[tuple[Array, Array], ...]:
        """The paths of other objects to their goal positions, seen from above."""
        ways = []
        for fact in self.required.facts:
            place = place_of(self.scene.index, fact)
            if place is None or not fact.polarity or place.subject == step.fact.native.arguments[0]:
                continue
            goal = world.pose(str(place.parent)) if place.site is None else world.site_pose(place.site)
            ways.append((world.pose(place.subject).position[:2], goal.position[:2]))
        return tuple(ways)

    def _holds(self, world: SkillWorld, step: GoalStep) -> Callable[[Pose], bool]:
        """Whether the fact would be true with its first argument at a pose, everything else as it is.

        A pose that only satisfies a negated fact must not undo any other fact.
        """
        fact = step.fact
        name = fact.native.arguments[0]
        joint = self.scene.index.free_joint(name) if name in self.scene.index.entities else None
        alone = SimGrounder(self.scene.index, [fact], self.knowledge.schema)
        preserved = () if fact.polarity else self._preserved(world, fact)

        def holds(pose: Pose) -> bool:
            if joint is None:
                return False
            data, quat = self._scratch, np.zeros(4)
            mujoco.mju_mat2Quat(quat, np.ascontiguousarray(pose.rotation).ravel())
            data.qpos[:] = world.data.qpos
            data.qpos[self.scene.index.qpos_slice(joint)] = np.concatenate([pose.position, quat])
            data.qvel[:] = 0.0
            mujoco.mj_fwdPosition(self.scene.model, data)
            if fact.polarity != alone.truth(data)[0]:
                return False
            if fact.threshold and not self._satisfied(alone, data)[0]:
                return False
            return all((held <= self._satisfied(grounder, data)).all() for grounder, held in preserved)

        return holds

    def _preserved(self, world: SkillWorld, fact: Fact) -> tuple[tuple[SimGrounder, NDArray[np.bool_]], ...]:
        """The facts of the goal and its preconditions that hold and are not excluded by ``fact``."""
        schema = self.knowledge.schema
        preserved = []
        for grounder in (self.grounder, self.conditions):
            ended = [exclude(fact, each, schema) or entails(each, fact, schema) for each in grounder.facts]
            preserved.append((grounder, self._satisfied(grounder, world.data) & ~np.array(ended, dtype=np.bool_)))
        return tuple(preserved)
