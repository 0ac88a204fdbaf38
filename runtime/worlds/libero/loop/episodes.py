"""One task and initial state in, one recorded episode out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from onto_compiler.bddl.conditions import with_preconditions
from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse, parse_file
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from onto_compiler.tables import SATISFIED, STATUSES
from runtime.loop.correction import CorrectionLoop
from runtime.loop.diagnosis import evidence_status
from runtime.loop.proposer import Proposer
from runtime.loop.records import GIVEN, Attempt, Episode
from runtime.worlds.libero.loop.environment import NativeEnvironment
from runtime.worlds.libero.loop.uncertain import Placements, Uncertain
from runtime.worlds.libero.simulator.assets import TaskRef, initial_states
from runtime.worlds.libero.simulator.fixtures import FixturePoses
from runtime.worlds.libero.simulator.native import NativeTask, versions

__all__ = ["BUDGET", "PREMISE_STEPS", "EpisodeRunner", "required_of", "settling"]

BUDGET = 8  # attempts; see benchmarks/state_repair.py for what fewer would cost
PREMISE_STEPS = 10  # official initial states hang above the table: the field settles them by ten steps without motion


def settling(state: ArrayLike | None, asked: int | None = None) -> int:
    """Control steps without motion before a start is judged: those ``asked`` for, if any.

    An official initial state (None) otherwise takes :data:`PREMISE_STEPS`, and one that was given is judged as it is.
    """
    if asked is not None:
        return asked
    return PREMISE_STEPS if state is None else 0


def required_of(ref: TaskRef, knowledge: Knowledge, *, ordered: bool = False) -> RequiredABox:
    """Compile a task's file to its required ABox, with the preconditions of its facts where it is to be ``ordered``.

    A suite's file is named ``SUITE/TASK.bddl`` in the record, so that the same run makes the same trace everywhere.
    """
    spec = parse(ref.bddl.read_text(encoding="utf-8"), f"{ref.suite}/{ref.bddl.name}") if ref.suite else None
    spec = spec or parse_file(ref.bddl)
    required = required_abox(spec, knowledge.schema, ref.name)
    return with_preconditions(required, spec, knowledge.schema) if ordered else required


@dataclass(frozen=True, slots=True)
class EpisodeRunner:
    """Runs episodes of one task; the scene is built once and every episode starts by a state write."""

    ref: TaskRef
    task: NativeTask
    required: RequiredABox
    environment: NativeEnvironment
    knowledge: Knowledge
    loop: CorrectionLoop
    fresh: NDArray[np.float64]  # the flat state that the seeded reset left
    placements: Placements
    placed: str  # who says where the fixtures stand: "seed 3", the name of a model file; empty where nobody does
    fixtures: FixturePoses | None = None  # as a model file has them

    @classmethod
    def open(
        cls,
        ref: TaskRef,
        knowledge: Knowledge,
        proposers: Mapping[str, Proposer],
        seed: int | None = None,
        budget: int | None = None,
    ) -> EpisodeRunner:
        """Build the scene of ``ref``, with the fixtures where ``seed`` places them, which is 0 where nobody says.

        Without ``budget`` :data:`BUDGET` holds. Raises ``SIM`` and ``BDDL`` problems.
        """
        required = required_of(ref, knowledge)
        task = NativeTask.open(ref, seed or 0)
        placed = "" if seed is None else f"seed {seed}"
        environment = NativeEnvironment(task, required, knowledge.schema)
        data = task.data
        fresh = np.concatenate([[data.time], data.qpos, data.qvel])
        loop = CorrectionLoop(knowledge, proposers, BUDGET if budget is None else budget)
        placements = Placements(parse_file(ref.bddl), environment.scene)
        return cls(ref, task, required, environment, knowledge, loop, fresh, placements, placed)

    def run(
        self,
        state_index: int,
        state: ArrayLike | None = None,
        report: Callable[[Attempt], None] | None = None,
        *,
        settle: int | None = None,
    ) -> Episode:
        """Start from the official initial state ``state_index`` (or a flat ``state``, then GIVEN), and correct.

        Raises:
            OntoError: as :meth:`start`.
        """
        steps = self.start(state_index, state, settle=settle)
        return self.correct(state_index, report, settled=steps)

    def correct(
        self, state_index: int, report: Callable[[Attempt], None] | None = None, *, settled: int = PREMISE_STEPS
    ) -> Episode:
        """Run the loop on the present state, which :meth:`start` left after ``settled`` control steps."""
        premise = self.environment.observe_premise()
        start: dict[str, Any] = {
            "start_settle_steps": settled,
            "fixtures": self.placed or f"seed {self.task.seed}, assumed",
            "uncertain": [str(each.fact) for each in self.uncertain(state_index)],
        }
        unmet = evidence_status(self.required.premise, premise) != STATUSES.index(SATISFIED)
        correction = self.loop.run(
            self.required, self.environment, np.random.default_rng([self.task.seed, max(state_index, 0)]), report=report
        )
        if correction.lost is not None:
            start["start_lost_settling"] = correction.lost.settle_steps
        if correction.reason:
            start["reason"] = correction.reason
        return Episode(
            task=self.ref.name,
            suite=self.ref.suite,
            state_index=state_index,
            seed=self.task.seed,
            required=self.required,
            initial=correction.initial,
            premise=premise,
            premise_holds=not unmet.any(),
            attempts=correction.attempts,
            final=correction.final,
            outcome=correction.outcome,
            verification=correction.verification,
            provenance=(*versions().items(), *start.items()),
        )

    def start(self, state_index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Write the initial state and let it settle; gives the number of control steps, see :func:`settling`.

        A task without official states has one: its seeded reset.

        Raises:
            OntoError: ``SIM017``, where the task has no such initial state; ``SIM019``, where it diverges.
        """
        steps = settling(state, settle)
        self.task.reset_to(self._official(state_index) if state is None else state, self.fixtures)
        self.task.settle(steps)
        if self.task.diverged:
            raise OntoError.of("SIM019", f"the simulation of `{self.ref.name}` diverged while its state settled")
        return steps

    def uncertain(self, state_index: int) -> tuple[Uncertain, ...]:
        """The required facts whose verdict in the present state hangs on where fixtures stand, which nobody says.

        Without any for an official state, which is meant to be judged in the scene of the seed.
        """
        if self.placed or state_index != GIVEN:
            return ()
        return self.placements.uncertain(self.required.facts, self.environment.observe(), self.task.data)

    def placing(self, fixtures: FixturePoses, file: str) -> EpisodeRunner:
        """The same scene with the fixtures as ``file`` has them."""
        return replace(self, fixtures=fixtures, placed=file)

    def knowing(self, knowledge: Knowledge) -> EpisodeRunner:
        """The same scene and budget under other rules."""
        return replace(self, knowledge=knowledge, loop=replace(self.loop, knowledge=knowledge))

    def close(self) -> None:
        """Free the scene."""
        self.task.close()

    def _official(self, state_index: int) -> NDArray[np.float64]:
        states = initial_states(self.ref) if self.ref.initial_states.is_file() else self.fresh[None]
        if not 0 <= state_index < len(states):
            raise OntoError.of(
                "SIM017", f"`{self.ref.name}` has no initial state {state_index}", f"it has {len(states)}, from 0"
            )
        return np.array(states[state_index])
