"""Audits one task: sets, settles and measures its initial states, and reports premise failures."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError, clipped
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import Schema
from runtime.loop.diagnosis import diagnose
from runtime.loop.faults import RunFault
from runtime.wording import short_name
from runtime.worlds.libero.audit.kinds import Kind
from runtime.worlds.libero.audit.measures import MEASURES, Reading, StateEvidence
from runtime.worlds.libero.audit.records import Failure, Fault, StateAudit, TaskAudit
from runtime.worlds.libero.audit.scene_state import SceneReader
from runtime.worlds.libero.loop.environment import PREMISE_STEPS
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.required import required_of

__all__ = ["TaskAuditor", "audit_task", "plain"]

DIGITS = 6  # of a reading: micrometres and microradians
LONGEST = 240  # characters of a fault
_INSTALLED = re.compile(r"""[^\s`'"]*[/\\](?:site|dist)-packages[/\\]""")


@dataclass(frozen=True, slots=True, eq=False)
class TaskAuditor:
    """Audits states of one task; the scene is built once. ``faults`` name the facts that could not be grounded."""

    required: RequiredABox
    simulation: Simulation
    observer: SceneReader
    premise: SimGrounder
    goal: SimGrounder
    knowledge: Knowledge
    kinds: tuple[Kind, ...]
    states: NDArray[np.float64]  # (n, 1 + nq + nv)
    faults: tuple[Fault, ...]

    @classmethod
    def open(cls, ref: TaskRef, knowledge: Knowledge, kinds: Sequence[Kind], seed: int = 0) -> TaskAuditor:
        """Build the scene of ``ref``; raises ``SIM`` and ``BDDL`` problems of the scene and the goal."""
        required = required_of(ref, knowledge)
        simulation = Simulation(compile_scene(ref.bddl, seed), exact=True)
        index = simulation.scene.index
        goal = SimGrounder(index, required.facts, knowledge.schema)
        premise, faults = _groundable(index, required.premise, knowledge.schema)
        official = ref.initial_states.is_file()
        states = initial_states(ref) if official else simulation.flat_state[None]
        if official and states.shape[1] != simulation.state_size:
            simulation.reset_to(states[0])  # raises SIM004
        return cls(
            required=replace(required, premise=premise),
            simulation=simulation,
            observer=SceneReader(index),
            premise=SimGrounder(index, premise, knowledge.schema),
            goal=goal,
            knowledge=knowledge,
            kinds=tuple(kinds),
            states=states,
            faults=faults,
        )

    def audit(self, state: int) -> StateAudit:
        """Set initial state ``state``, settle it as usual in evaluations, and report what contradicts the task."""
        simulation = self.simulation
        try:
            simulation.reset_to(self.states[state])
            before = self.observer.read(simulation.data)
            simulation.settle(PREMISE_STEPS)
        except RunFault as fault:
            return StateAudit(state, faults=(Fault("SIM019", f"{fault} while it settled"),))
        except OntoError as error:
            return StateAudit(state, faults=_faults(error))
        stage = StateEvidence(
            before=before,
            after=self.observer.read(simulation.data),
            required=self.required,
            premise=self.premise.observe(simulation.data),
            goal=self.goal.observe(simulation.data),
            schema=self.knowledge.schema,
        )
        readings = {name: tuple(MEASURES[name](stage)) for name in sorted({kind.measure for kind in self.kinds})}
        return StateAudit(state, self._judge(stage, readings), _rounded(readings))

    def _judge(self, stage: StateEvidence, readings: Mapping[str, Sequence[Reading]]) -> tuple[Failure, ...]:
        schema = self.knowledge.schema
        named = {
            diagnosis.index: short_name(diagnosis.failure, schema)
            for diagnosis in diagnose(stage.required.premise, stage.premise, self.knowledge.tables)
        }
        found = []
        for kind in self.kinds:
            for reading in readings[kind.measure]:
                margin = reading.value if kind.most is None else kind.most - reading.value
                if not (reading.holds if kind.most is None else margin >= 0):
                    failure = "" if reading.fact is None else named.get(reading.fact, "")
                    unit = reading.unit or kind.unit
                    found.append(Failure(kind.name, reading.subject, _number(margin), unit, failure, reading.limit))
        return tuple(found)


def audit_task(
    ref: TaskRef,
    knowledge: Knowledge,
    kinds: Sequence[Kind],
    states: int | None = None,
    seed: int = 0,
    known: Sequence[StateAudit] = (),
) -> TaskAudit:
    """Audit the first ``states`` initial states of ``ref`` (None: all), those ``known`` excepted.

    A task that cannot be built, or whose facts cannot be grounded, is a finding, not an error.
    """
    official = ref.initial_states.is_file()
    try:
        auditor = TaskAuditor.open(ref, knowledge, kinds, seed)
    except OntoError as error:
        return TaskAudit(ref.suite, ref.index, ref.name, official, 0, (), _faults(error))
    wanted = range(len(auditor.states) if states is None else min(states, len(auditor.states)))
    audited = {one.state: one for one in known}
    for state in wanted:
        if state not in audited:
            audited[state] = auditor.audit(state)
    found = tuple(audited[state] for state in wanted)
    return TaskAudit(ref.suite, ref.index, ref.name, official, len(auditor.states), found, auditor.faults)


def _groundable(index: Scene, facts: Sequence[Fact], schema: Schema) -> tuple[tuple[Fact, ...], tuple[Fault, ...]]:
    """The ``facts`` that can be grounded in the scene, and the faults of the others."""
    groundable: list[Fact] = []
    faults: list[Fault] = []
    for fact in facts:
        try:
            SimGrounder(index, [fact], schema)
        except OntoError as error:
            faults += _faults(error)
        else:
            groundable.append(fact)
    return tuple(groundable), tuple(faults)


def _faults(error: OntoError) -> tuple[Fault, ...]:
    return tuple(Fault(problem.code, plain(problem.message), plain(problem.hint)) for problem in error.problems)


def plain(message: str) -> str:
    """``message`` on one line of bounded length, without installation paths, since records are compared."""
    return clipped(_INSTALLED.sub("", " ".join(message.split())), LONGEST)


def _rounded(readings: Mapping[str, Sequence[Reading]]) -> dict[str, dict[str, float | None]]:
    """The readings as they are recorded: rounded, and without sizes of zero."""
    return {
        measure: {one.subject: number for one in some if (number := _number(one.value)) != 0 or one.holds is not None}
        for measure, some in readings.items()
    }


def _number(value: float) -> float | None:
    return round(value, DIGITS) + 0.0 if isfinite(value) else None  # + 0.0 takes the sign from -0.0
