"""One task and initial state in, one recorded episode out, in whichever world has the task."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from runtime.loop.correction import CorrectionLoop
from runtime.loop.diagnosis import satisfied
from runtime.loop.proposer import Proposer
from runtime.loop.records import Attempt, Episode, state_digest
from runtime.worlds.environment import TaskEnvironment
from runtime.worlds.required import required_of
from runtime.worlds.world import TaskRef, World

__all__ = ["BUDGET", "EpisodeRunner"]

BUDGET = 8  # attempts; see benchmarks/state_repair.py for what fewer would cost


@dataclass(frozen=True, slots=True)
class EpisodeRunner:
    """Runs episodes of one task; the scene is built once and every episode starts by a state write."""

    world: World
    ref: TaskRef
    required: RequiredABox
    environment: TaskEnvironment
    knowledge: Knowledge
    loop: CorrectionLoop

    @classmethod
    def open(
        cls,
        world: World,
        ref: TaskRef,
        knowledge: Knowledge,
        proposers: Mapping[str, Proposer] | None = None,
        seed: int = 0,
        budget: int | None = None,
        judge: str = "native",
    ) -> EpisodeRunner:
        """Build the scene of ``ref``; without ``proposers`` the world's own, without ``budget`` :data:`BUDGET`.

        ``judge`` is "native" or "grounding", as of :class:`TaskEnvironment`.

        Raises ``SIM`` and ``BDDL`` problems.
        """
        required = required_of(ref, knowledge)
        environment = world.open(ref, required, knowledge.schema, seed)
        environment.judge = judge
        offered = world.proposers(knowledge.schema) if proposers is None else proposers
        loop = CorrectionLoop(knowledge, offered, BUDGET if budget is None else budget)
        return cls(world, ref, required, environment, knowledge, loop)

    def run(
        self, state_index: int, state: ArrayLike | None = None, report: Callable[[Attempt], None] | None = None
    ) -> Episode:
        """Start from the official initial state ``state_index`` (or a flat ``state``, then GIVEN), settle, and correct.

        Raises:
            OntoError: as :meth:`start`.
        """
        self.start(state_index, state)
        return self.correct(state_index, report, given="" if state is None else state_digest(state))

    def correct(self, state_index: int, report: Callable[[Attempt], None] | None = None, *, given: str = "") -> Episode:
        """Run the loop on the present state, which :meth:`start` left; ``given`` is the digest of one of your own.

        Raises ``RUN004`` where the world's failures are corrected in plans.
        """
        if self.world.level != "state":
            title, level = self.world.title, self.world.level
            message = f"failures of {title} are corrected at the {level} level, and repair writes states"
            raise OntoError.of("RUN004", message, "`onto diagnose` names the routes; `onto plan` follows them")
        seed = self.environment.seed
        premise = self.environment.observe_premise()
        unmet = ~satisfied(self.required.premise, premise)
        correction = self.loop.run(
            self.required, self.environment, np.random.default_rng([seed, max(state_index, 0)]), report=report
        )
        return Episode(
            task=self.ref.name,
            suite=self.ref.suite,
            state_index=state_index,
            seed=seed,
            required=self.required,
            initial=correction.initial,
            premise=premise,
            premise_holds=not unmet.any(),
            attempts=correction.attempts,
            final=correction.final,
            outcome=correction.outcome,
            verification=correction.verification,
            provenance=(
                *self.environment.versions().items(),
                *((("reason", correction.reason),) if correction.reason else ()),
            ),
            given=given,
        )

    def start(self, state_index: int, state: ArrayLike | None = None) -> None:
        """Write the initial state and let it settle.

        Raises:
            OntoError: ``SIM017``, where the task has no such initial state; ``SIM019``, where it diverges.
        """
        self.environment.start(state_index, state)

    def knowing(self, knowledge: Knowledge) -> EpisodeRunner:
        """The same scene and budget under other rules."""
        return replace(self, knowledge=knowledge, loop=replace(self.loop, knowledge=knowledge))

    def close(self) -> None:
        """Free the scene."""
        self.environment.close()
