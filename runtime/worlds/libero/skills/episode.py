"""Plays one episode with skills, and records it like an episode of the correction loop.

A player decides in its own simulation, in the exact loop. The record is of a second run of its actions, from the same
snapshot in LIBERO's own environment: each attempt is grounded there, and LIBERO's predicate decides.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.observation import Observation
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.schema import local_name
from runtime.loop.diagnosis import diagnose_goal, satisfied, unmet
from runtime.loop.faults import RunFault
from runtime.loop.records import (
    Application,
    Attempt,
    Diagnosis,
    Episode,
    Proposal,
    RouteDecision,
    Verification,
    state_digest,
)
from runtime.loop.routing import attempt_status, route_or_none
from runtime.worlds.environment import settling
from runtime.worlds.libero.loop.environment import PREMISE_STEPS
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.compiled import CompiledScene
from runtime.worlds.libero.simulator.native import versions
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.skills.order import GoalStep, diagnose_step
from runtime.worlds.libero.skills.play import PlayedEpisode, SkillAttempt
from runtime.worlds.libero.skills.replay import NativeReplay
from runtime.worlds.snapshot import Snapshot

__all__ = ["EpisodePlayer", "EpisodeRecord", "Plays"]

Array = NDArray[np.float64]

# How a mechanism's execution ended, by the outcome of a try; the terms of trace:ExecutionEnd.
_ENDS = {"held": "completed", "unmet": "completed", "horizon": "out_of_steps"}
_FAULTS = frozenset(("unreachable", "lost", "missed", "blocked"))


class Plays(Protocol):
    """Plays episodes of one goal; see :class:`~runtime.worlds.libero.skills.play.Player`."""

    def reactive(self, sim: Simulation, horizon: int) -> PlayedEpisode:
        """Play from the present state for at most ``horizon`` control steps, without looking ahead."""
        ...

    def lookahead(self, sim: Simulation, horizon: int) -> PlayedEpisode:
        """The same, with rehearsals of each decision in a fork."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeRecord:
    """A recorded episode with its ``actions`` (n, 7) and ``qpos`` (n + 1, nq).

    Attempt k took the actions from ``bounds[k]`` up to ``bounds[k + 1]``: none if no skill had a candidate.
    """

    episode: Episode
    actions: Array
    qpos: Array
    bounds: tuple[int, ...]


class _Watched(Simulation):
    """Stores the fault of a step, at which a play ends."""

    fault: RunFault | None = None

    def step(self, action: ArrayLike, before_last_substep: Callable[[], object] | None = None) -> None:
        try:
            super().step(action, before_last_substep)
        except RunFault as fault:
            self.fault = fault
            raise


@dataclass(frozen=True, slots=True, eq=False)
class EpisodePlayer:
    """A task's scene, which ``player`` plays in and ``replay`` judges; each episode starts by a state write.

    ``maker`` is the name, in the record, of the source of the candidates.
    """

    ref: TaskRef
    required: RequiredABox
    knowledge: Knowledge
    scene: CompiledScene
    player: Plays
    replay: NativeReplay
    maker: str = "geometry"

    def perform(
        self,
        state_index: int,
        horizon: int,
        *,
        state: ArrayLike | None = None,
        settle: int | None = None,
        look_ahead: bool = False,
        report: Callable[[Attempt], None] | None = None,
    ) -> EpisodeRecord:
        """Start from official initial state ``state_index`` (or, GIVEN, a flat ``state``), play, and record.

        ``settle`` is the number of control steps without motion before it, by default that of :func:`settling`.
        ``report`` is called with each attempt as soon as it is recorded.

        Raises:
            OntoError: ``SIM017`` if the task has no such initial state; ``SIM019`` if it diverges while it
                settles; ``RUN013`` if the native run of the actions is not the play's.
        """
        sim = _Watched(self.scene, exact=True)
        sim.reset_to(self._official(sim, state_index) if state is None else state)
        steps = settling(state, settle, PREMISE_STEPS)
        try:
            sim.settle(steps)
        except RunFault as fault:
            raise OntoError.of("SIM019", f"`{self.ref.name}` diverged while its state settled: {fault}") from fault
        start = sim.snapshot()
        played = (self.player.lookahead if look_ahead else self.player.reactive)(sim, horizon)
        take = _NativeRun(self, played, start, sim.fault, report)
        take.run()
        broken = bool(take.attempts and take.attempts[-1].fault)
        if not broken and not np.array_equal(self.replay.qpos, sim.data.qpos):
            raise _differs("it ends with another qpos")
        settings = {
            "play": "look-ahead" if look_ahead else "reactive",
            "horizon": horizon,
            "control_steps": self.replay.steps,
            "rehearsed_steps": played.rehearsed,
            "start_settle_steps": steps,
        }
        unmet_premise = ~satisfied(self.required.premise, take.premise)
        outcome, verification = take.end()
        episode = Episode(
            task=self.ref.name,
            suite=self.ref.suite,
            state_index=state_index,
            seed=self.scene.seed,
            required=self.required,
            initial=take.initial,
            premise=take.premise,
            premise_holds=not unmet_premise.any(),
            attempts=tuple(take.attempts),
            final=self.replay.observe(),
            outcome=outcome,
            verification=verification,
            provenance=(*versions().items(), *settings.items()),
            given="" if state is None else state_digest(state),
        )
        actions = played.actions[: self.replay.steps]
        return EpisodeRecord(episode, actions, np.array(take.qpos), tuple(take.bounds))

    def _official(self, sim: Simulation, state_index: int) -> Array:
        states = initial_states(self.ref) if self.ref.initial_states.is_file() else sim.flat_state[None]
        if not 0 <= state_index < len(states):
            raise OntoError.of(
                "SIM017", f"`{self.ref.name}` has no initial state {state_index}", f"it has {len(states)}, from 0"
            )
        return np.array(states[state_index])


@dataclass(slots=True)
class _NativeRun:
    """The native run of what was played."""

    stage: EpisodePlayer
    played: PlayedEpisode
    start: Snapshot
    fault: RunFault | None  # of the play
    report: Callable[[Attempt], None] | None
    attempts: list[Attempt] = field(default_factory=list)
    qpos: list[Array] = field(default_factory=list)
    bounds: list[int] = field(default_factory=lambda: [0])
    offered: Counter[tuple[bool, int, str]] = field(default_factory=Counter)
    initial: Observation = field(init=False)
    premise: Observation = field(init=False)
    opening: Verification = field(init=False)

    def run(self) -> None:
        """Replay the actions, and make an attempt of each try."""
        replay = self.stage.replay
        replay.begin(self.start)
        self.initial, self.premise, self.opening = replay.observe(), replay.observe_premise(), replay.verify()
        self.qpos.append(replay.qpos)
        for number, each in enumerate(self.played.tries, 1):
            broken = str(self.fault) if self.fault is not None and number == len(self.played.tries) else ""
            attempt = self._attempt(each, broken)
            self._keep(attempt)
            if attempt.fault:
                return
        idle = self._idle(self.played.left)
        if idle is not None:
            self._keep(idle)

    def _keep(self, attempt: Attempt) -> None:
        self.attempts.append(attempt)
        self.bounds.append(self.stage.replay.steps)
        if self.report is not None:
            self.report(attempt)

    def _idle(self, left: Sequence[GoalStep]) -> Attempt | None:
        """The attempt without an application: the first of the steps ``left`` whose route had no candidate."""
        observation, (_, verification) = self.stage.replay.observe(), self.end()
        for step in left:
            diagnoses, selected = self._diagnosed(str(step.fact), observation)
            if (decision := self._routed(selected)) is not None:
                return Attempt(len(self.attempts), observation, diagnoses, decision, verification=verification)
        return None

    def end(self) -> tuple[str, Verification | None]:
        """The outcome of the episode, and the last verdict."""
        last = self.attempts[-1] if self.attempts else None
        verification = last.verification if last else self.opening
        if last is not None and last.fault:
            return "run_fault", verification
        if verification is not None and verification.outcome:
            return "accepted" if last else "verified", verification
        open_ = unmet(self.stage.required, self.stage.replay.observe())
        return "unresolved" if open_ else "grounding_verifier_disagreement", verification

    def _attempt(self, each: SkillAttempt, broken: str) -> Attempt:
        replay, index = self.stage.replay, len(self.attempts)
        observation, before, first = replay.observe(), replay.qpos, replay.steps
        diagnoses, selected = self._diagnosed(each.fact, observation)
        decision = self._routed(selected)
        if decision is None or local_name(decision.route) != each.route:
            raise _differs(f"no rule sends `{selected.fact}` to `{each.route}` there")
        try:
            for action in self.played.actions[first : first + each.steps]:
                replay.step(action)
                self.qpos.append(replay.qpos)
        except RunFault as fault:
            broken = broken or str(fault)
        moved = float(np.linalg.norm(replay.qpos - before))
        end = "" if broken else _ENDS.get(each.outcome, each.outcome if each.outcome in _FAULTS else "gave_up")
        proposal, reason = self._proposal(each, decision), "" if broken else each.reason
        application = Application(proposal, "controller", moved, replay.steps - first, end, reason)
        verification = None if broken else replay.verify()
        return Attempt(index, observation, diagnoses, decision, application, verification, broken)

    def _diagnosed(self, fact: str, observation: Observation) -> tuple[tuple[Diagnosis, ...], Diagnosis]:
        """The unmet facts, and the diagnosis of ``fact``; preconditions may be unmet too."""
        required = self.stage.required
        found = diagnose_goal(required, observation, self.stage.knowledge.tables)
        unmet_conditions = self._conditions(observation)
        for diagnosis in found:
            if str(diagnosis.fact) == fact:
                index = diagnosis.index
                before = (each for each in unmet_conditions if index in required.preconditions[each.index].before)
                return (*found, *before), diagnosis
        for diagnosis in unmet_conditions:
            if str(diagnosis.fact) == fact:
                return (*found, diagnosis), diagnosis
        raise _differs(f"`{fact}`, which the play acted on, is not unmet there")

    def _conditions(self, observation: Observation) -> list[Diagnosis]:
        """The unmet preconditions."""
        required, knowledge = self.stage.required, self.stage.knowledge
        seen = self.stage.replay.observe_conditions()
        holds = satisfied([each.fact for each in required.preconditions], seen)
        return [
            diagnose_step(GoalStep(each.fact, index, precondition=True), required, observation, seen, knowledge)
            for index, each in enumerate(required.preconditions)
            if not holds[index]
        ]

    def _routed(self, selected: Diagnosis) -> RouteDecision | None:
        """The decision that the play made: a retry if it tried the same fact before, else a dispatch."""
        routed = (each.selected for each in self.attempts if each.selected is not None)
        before = [each.route for each in routed if str(each.diagnosis.fact) == str(selected.fact)]
        previous = before[-1] if before else None
        return route_or_none(selected, self.stage.knowledge, attempt_status(previous), previous, level="action")

    def _proposal(self, each: SkillAttempt, decision: RouteDecision) -> Proposal:
        name = self.stage.knowledge.schema.routes[decision.route].name
        key = (*decision.diagnosis.key, decision.route)
        self.offered[key] += 1
        return Proposal(name, self.stage.maker, self.offered[key] - 1, np.empty(0), (), each.note)


def _differs(how: str) -> OntoError:
    return OntoError.of(
        "RUN013",
        f"the native run of the played actions is another than the play: {how}",
        "compare the installed versions of mujoco, robosuite and numpy with those in constraints.txt",
    )
