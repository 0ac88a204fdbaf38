"""One episode played by skills under dynamics: look, choose what is unmet, act, and try the next way where it failed.

*Reactive* play takes each decision once, in the running episode. *Look-ahead* play tries the candidates of a decision
in a fork of the simulation first, and carries out the best of them: the simulator is its world model.
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
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema
from runtime.diagnosis import unmet
from runtime.faults import RunFault
from runtime.proposers.targets import slot_of
from runtime.simulator.compiled import CompiledScene
from runtime.simulator.simulation import DUMMY_ACTION, Simulation
from runtime.skills.fault import SkillFault
from runtime.skills.frames import Pose
from runtime.skills.motion import OPEN, Action, grip, reach
from runtime.skills.offers import Offer, offers
from runtime.skills.reach import Reach
from runtime.skills.world import Shapes, World

__all__ = ["Played", "Player", "Try"]

Array = NDArray[np.float64]

CANDIDATES = 6  # that look-ahead tries for one decision
PAUSE = 3  # steps without motion after a skill, in which what was let go comes to rest
RECOVERY = 0.10  # metres that the hand rises after a failure
_OVER = "horizon"


@dataclass(frozen=True, slots=True)
class Try:
    """One skill that was carried out: for which fact, which candidate, in how many steps, and how it ended.

    ``outcome`` is ``held`` where the fact was true afterwards, ``unmet`` where it was not, the kind of the
    :class:`SkillFault`, or ``horizon`` where the episode was over.
    """

    fact: str
    candidate: int
    note: str
    steps: int
    outcome: str


@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """The actions of an episode (n, 7), what was tried, and what the goal's facts were at the end."""

    actions: Array
    tries: tuple[Try, ...]
    final: Observation
    holds: bool
    rehearsed: int  # control steps in forks


class _HorizonReached(Exception):  # noqa: N818 - the end of an episode, not an error
    pass


@dataclass(slots=True)
class _Episode:
    """A running episode: the simulation, the actions so far and the grasps that were tried, by fact."""

    sim: Simulation
    world: World
    reach: Reach
    horizon: int
    actions: list[Action] = field(default_factory=list)
    tries: list[Try] = field(default_factory=list)
    tried: dict[int, list[Pose]] = field(default_factory=dict)
    rehearsed: int = 0

    def drive(self, motion: Generator[Action, None, object]) -> None:
        """Carry out ``motion``; raises :class:`_HorizonReached`, and what the motion raises."""
        for action in motion:
            if len(self.actions) >= self.horizon:
                raise _HorizonReached
            self.sim.step(action)
            self.actions.append(np.array(action))


class Player:
    """Plays episodes of one task in its compiled scene."""

    def __init__(self, scene: CompiledScene, required: RequiredABox, schema: Schema) -> None:
        """Resolve the goal in the scene; raises ``SIM001`` ff. where it names what the scene lacks."""
        self.scene, self.required, self.schema = scene, required, schema
        self.grounder = SimGrounder(scene.index, required.facts, schema)
        self.shapes = Shapes(scene)
        self._scratch = mujoco.MjData(scene.model)

    def reactive(self, sim: Simulation, horizon: int) -> Played:
        """Play from the present state of ``sim`` for at most ``horizon`` control steps."""
        return self._play(self._begin(sim, horizon), candidates=1)

    def lookahead(self, sim: Simulation, horizon: int, candidates: int = CANDIDATES) -> Played:
        """The same, with up to ``candidates`` rehearsals of each decision in a fork of ``sim``."""
        return self._play(self._begin(sim, horizon), candidates=candidates)

    def _begin(self, sim: Simulation, horizon: int) -> _Episode:
        world = World(sim, self.shapes)
        return _Episode(sim, world, Reach(world), horizon)

    def _play(self, episode: _Episode, candidates: int) -> Played:
        try:
            while (index := self._next(episode.sim)) is not None and len(episode.actions) < episode.horizon:
                if not self._act(episode, index, candidates):
                    break
        except (_HorizonReached, RunFault):
            pass
        final = self.grounder.observe(episode.sim.data)
        return Played(
            np.array(episode.actions).reshape(-1, len(DUMMY_ACTION)),
            tuple(episode.tries),
            final,
            not unmet(self.required, final),
            episode.rehearsed,
        )

    def _next(self, sim: Simulation) -> int | None:
        """The unmet fact that comes first; None where the goal holds."""
        open_ = unmet(self.required, self.grounder.observe(sim.data))
        return open_[0] if open_ else None

    def _act(self, episode: _Episode, index: int, candidates: int) -> bool:
        """Choose an offer for fact ``index`` and carry it out; False where there is none."""
        fact = self.required.facts[index]
        tried = episode.tried.setdefault(index, [])
        found = self._offers(episode.world, episode.reach, index, tried)
        offer = next(found, None) if candidates <= 1 else self._rehearse(episode, index, found, candidates)
        if offer is None and tried:
            tried.clear()  # the world has changed since: what failed before may do now
            offer = next(self._offers(episode.world, episode.reach, index, tried), None)
        if offer is None:
            return False
        tried += offer.poses
        before = len(episode.actions)
        outcome = _OVER
        try:
            outcome = self._carry_out(episode, offer, index)
        finally:
            steps = len(episode.actions) - before
            episode.tries.append(Try(str(fact), len(tried), offer.note, steps, outcome))
        return True

    def _carry_out(self, episode: _Episode, offer: Offer, index: int) -> str:
        world = episode.world
        try:
            episode.drive(offer.run(world, episode.reach))
            episode.drive(grip(world, OPEN, PAUSE))
        except SkillFault as fault:
            episode.drive(grip(world, OPEN, PAUSE))
            episode.drive(reach(world, world.eef.moved(np.array([0.0, 0.0, RECOVERY])), OPEN, steps=15))
            return fault.kind
        return "held" if index not in unmet(self.required, self.grounder.observe(episode.sim.data)) else "unmet"

    def _rehearse(self, episode: _Episode, index: int, found: Iterator[Offer], candidates: int) -> Offer | None:
        """Try offers in a fork; the first that leads to the fact and keeps what held, else what came nearest."""
        fork = Simulation(self.scene, exact=episode.sim.exact)
        start = episode.sim.snapshot()
        best: tuple[float, Offer] | None = None
        for offer in islice(found, candidates):
            fork.restore(start)
            trial = self._begin(fork, episode.horizon - len(episode.actions))
            try:
                outcome = self._carry_out(trial, offer, index)
            except (_HorizonReached, RunFault):
                outcome = _OVER
            fork.settle(PAUSE)
            episode.rehearsed += len(trial.actions) + PAUSE
            score = self._score(fork, outcome, len(trial.actions))
            if best is None or score > best[0]:
                best = (score, offer)
            if outcome == "held" and score > 0.0:
                break
        return best[1] if best else None

    def _score(self, fork: Simulation, outcome: str, steps: int) -> float:
        """How good a rehearsal ended: by facts that hold, then by whether the skill came through, then by time."""
        open_ = unmet(self.required, self.grounder.observe(fork.data))
        return len(self.required.facts) - len(open_) - (0.5 if outcome != "held" else 0.0) - 1e-4 * steps

    def _offers(self, world: World, reach_: Reach, index: int, tried: Sequence[Pose]) -> Iterator[Offer]:
        fact = self.required.facts[index]
        sharing = slot_of(self.required, fact)[1]
        return offers(world, reach_, self.schema, fact, self._holds(world, index), tried, sharing)

    def _holds(self, world: World, index: int) -> Callable[[Pose], bool]:
        """Whether the fact would be true with its first argument at a pose, everything else as it is."""
        fact: Fact = self.required.facts[index]
        name = fact.native.arguments[0]
        joint = self.scene.index.free_joint(name) if name in self.scene.index.entities else None

        def holds(pose: Pose) -> bool:
            if joint is None:
                return False
            data, quat = self._scratch, np.zeros(4)
            mujoco.mju_mat2Quat(quat, np.ascontiguousarray(pose.rotation).ravel())
            data.qpos[:] = world.data.qpos
            data.qpos[self.scene.index.qpos_slice(joint)] = np.concatenate([pose.position, quat])
            data.qvel[:] = 0.0
            mujoco.mj_fwdPosition(self.scene.model, data)
            return bool(self.grounder.truth(data)[index])

        return holds
