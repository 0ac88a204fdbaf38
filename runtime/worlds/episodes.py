"""Runs the correction loop on one task and initial state of any world; gives the recorded episode."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from onto_compiler.required import RequiredABox
from runtime.loop.correction import CorrectionLoop
from runtime.loop.diagnosis import satisfied
from runtime.loop.proposer import Proposer
from runtime.loop.records import GIVEN, Attempt, Episode, state_digest
from runtime.loop.routing import Routing
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
    placed: str = ""  # the source of the fixtures' poses: "seed 3" or the name of a model file; empty without one

    @classmethod
    def open(
        cls,
        world: World,
        ref: TaskRef,
        knowledge: Knowledge,
        proposers: Mapping[str, Proposer] | None = None,
        seed: int | None = None,
        budget: int | None = None,
        judge: str = "native",
    ) -> EpisodeRunner:
        """Build the scene of ``ref``; ``proposers`` default to the world's, ``budget`` to :data:`BUDGET`.

        ``seed`` (default 0) places the fixtures. ``judge`` is "native" or "grounding", as in :class:`TaskEnvironment`.

        Raises ``SIM`` and ``BDDL`` problems.
        """
        required = required_of(ref, knowledge)
        environment = world.open(ref, required, knowledge.schema, seed or 0)
        environment.judge = judge
        offered = world.proposers(knowledge.schema) if proposers is None else proposers
        loop = CorrectionLoop(knowledge, offered, BUDGET if budget is None else budget)
        placed = "" if seed is None else f"seed {seed}"
        return cls(world, ref, required, environment, knowledge, loop, placed)

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
        given = "" if state is None else state_digest(state)
        return self.correct(state_index, report, given=given, settled=steps)

    def correct(
        self,
        state_index: int,
        report: Callable[[Attempt], None] | None = None,
        *,
        given: str = "",
        settled: int | None = None,
    ) -> Episode:
        """Run the loop on the present state, which :meth:`start` left after ``settled`` control steps.

        ``given`` is the digest of a state of your own.

        Raises ``RUN004`` if the world's failures are corrected in plans.
        """
        if self.world.level != "state":
            title, level = self.world.title, self.world.level
            message = f"failures of {title} are corrected at the {level} level, and repair writes states"
            raise OntoError.of("RUN004", message, "`onto diagnose` names the routes; `onto plan` follows them")
        seed = self.environment.seed
        premise = self.environment.observe_premise()
        start: dict[str, str | int] = {"fixtures": self.placed or f"seed {seed}, assumed"}
        if settled is not None:
            start["start_settle_steps"] = settled
        if rows := self.uncertain(state_index):
            start["uncertain"] = json.dumps(rows)
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
                *start.items(),
                *((("start_lost_settling", correction.lost.settle_steps),) if correction.lost else ()),
                *((("reason", correction.reason),) if correction.reason else ()),
            ),
            given=given,
        )

    def start(self, state_index: int, state: ArrayLike | None = None, *, settle: int | None = None) -> int:
        """Write the initial state and let it settle; returns the number of control steps, as the environment does.

        Raises:
            OntoError: ``SIM017`` if the task has no such initial state; ``SIM019`` if it diverges.
        """
        return self.environment.start(state_index, state, settle=settle)

    def placing(self, model: str) -> EpisodeRunner:
        """The same scene with the fixtures' poses in the file ``model``; raises ``SIM023``."""
        self.environment.place(model)
        return replace(self, placed=model)

    def uncertain(self, state_index: int) -> tuple[dict[str, Any], ...]:
        """The required facts whose verdict in the present state depends on unknown fixture poses.

        Empty for an official state, which is judged in the scene of the seed.
        """
        return () if self.placed or state_index != GIVEN else self.environment.uncertain()

    def routing(self, routing: Routing) -> EpisodeRunner:
        """The same scene, rules and budget with another choice of routes."""
        return replace(self, loop=replace(self.loop, routing=routing))

    def close(self) -> None:
        """Free the scene."""
        self.environment.close()
