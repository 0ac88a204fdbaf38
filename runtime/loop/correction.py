"""Algorithm 1 of the paper: ground, diagnose, route, propose, apply, verify, and retry or reroute within a budget."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from grounding.scenes import Scene
from onto_compiler.knowledge import Knowledge
from onto_compiler.required import RequiredABox
from runtime.loop.diagnosis import diagnose_goal, select
from runtime.loop.faults import RunFault
from runtime.loop.proposer import Proposer, Request
from runtime.loop.records import Application, Attempt, Diagnosis, Proposal, RouteDecision, Verification
from runtime.loop.routing import Routing, by_rule

__all__ = ["Correction", "CorrectionLoop", "Environment", "RunFault"]


class Environment(Protocol):
    """The loop's access to a simulated state: read it, write it, evaluate the native predicate."""

    @property
    def scene(self) -> Scene:
        """The index of the model."""
        ...

    @property
    def qpos(self) -> NDArray[np.float64]:
        """A copy of the generalised positions, shape (nq,)."""
        ...

    @property
    def qvel(self) -> NDArray[np.float64]:
        """A copy of the generalised velocities, shape (nv,)."""
        ...

    def observe(self) -> Observation:
        """Ground the required facts in the current state."""
        ...

    def observe_at(self, qpos: NDArray[np.float64]) -> Observation:
        """Ground the required facts on a scratch copy in which ``qpos`` was written."""
        ...

    def apply(self, proposal: Proposal) -> Application:
        """Apply ``proposal`` in the mode of its route; raise :class:`RunFault` where the result is not finite."""
        ...

    def verify(self) -> Verification:
        """Evaluate the native predicate."""
        ...

    def settle(self, verification: Verification) -> Verification:
        """Let the state settle and record whether the native predicate still holds.

        If it does, the verified state is restored. If not, the settled state is kept, or the state before the last
        proposal if it diverged.
        """
        ...


@dataclass(frozen=True, slots=True)
class Correction:
    """What :meth:`CorrectionLoop.run` returns: the attempts, and how and in which observed state the loop ended.

    ``reason`` says why the outcome is ``unresolved``: a route without a proposer, or a state that did not stay accepted
    while settling. ``lost`` is the verdict on a start that was accepted but not after settling; the loop then corrected
    the settled state.
    """

    initial: Observation
    attempts: tuple[Attempt, ...]
    final: Observation
    outcome: str
    verification: Verification | None
    reason: str = ""
    lost: Verification | None = None


@dataclass(frozen=True, slots=True)
class CorrectionLoop:
    """The loop's fixed parts: the compiled ontology, a proposer per route name, the budget of attempts, the routing."""

    knowledge: Knowledge
    proposers: Mapping[str, Proposer]
    budget: int
    routing: Routing = by_rule

    def run(
        self,
        required: RequiredABox,
        environment: Environment | None,
        rng: np.random.Generator,
        *,
        predicted: Observation | None = None,
        report: Callable[[Attempt], None] | None = None,
    ) -> Correction:
        """Correct the state of ``environment`` until the native predicate accepts it or the budget is spent.

        A state that is not accepted after settling counts as rejected; the loop continues from the settled state.

        With ``predicted`` the source starts as ``pred``: a satisfied prediction is retained and nothing is executed;
        an unsatisfied one is corrected in ``environment`` where one is given. Without it the source is ``sim``
        throughout. ``report`` is called with each attempt as soon as it is over.
        """
        if predicted is None and environment is None:
            raise ValueError("a simulator source needs an environment")
        return _Run(self, required, environment, rng).correct(predicted, report)


@dataclass(slots=True)
class _Run:
    """One run of the algorithm and its state between attempts."""

    loop: CorrectionLoop
    required: RequiredABox
    environment: Environment | None
    rng: np.random.Generator
    attempts: list[Attempt] = field(default_factory=list)
    offered: dict[tuple[int, str], int] = field(default_factory=dict)  # candidates so far, by fact and route
    rejected: dict[int, str] = field(default_factory=dict)  # the route of the last rejected attempt, by fact
    lost: Verification | None = None  # a start that was accepted and did not settle
    unserved: dict[str, None] = field(default_factory=dict)  # routes without a proposer

    def correct(self, predicted: Observation | None, report: Callable[[Attempt], None] | None) -> Correction:
        observation = initial = self._observe() if predicted is None else predicted
        while True:
            diagnoses = diagnose_goal(self.required, observation, self.loop.knowledge.tables)
            before = self.lost
            end = self._before_attempt(observation, diagnoses)
            if self.lost is not before:  # settling has moved the state
                observation = self._observe()
            elif end is None:
                attempt = self._attempt(observation, diagnoses)
                if attempt is None:
                    end = "unresolved"
                else:
                    self.attempts.append(attempt)
                    if report is not None:
                        report(attempt)
                    observation = self._observe()
                    end = _after_attempt(attempt)
            if end is not None:
                outcome, verification = (end, self._verdict()) if isinstance(end, str) else end
                reason = self._reason(verification) if outcome == "unresolved" else ""
                return Correction(initial, tuple(self.attempts), observation, outcome, verification, reason, self.lost)

    def _before_attempt(
        self, observation: Observation, diagnoses: tuple[Diagnosis, ...]
    ) -> str | tuple[str, Verification] | None:
        """Step 3: the outcome if no further attempt is needed or allowed, else None."""
        if observation.source == "pred" and not diagnoses:
            return "retained"
        environment = self.environment
        if environment is None:
            return "unresolved"
        if observation.source == "sim" and not (self.attempts and diagnoses):
            verification = environment.verify()
            if verification.outcome:
                return self._accepted(environment.settle(verification))
            if not diagnoses:
                return "grounding_verifier_disagreement", verification
        return "unresolved" if len(self.attempts) >= self.loop.budget else None

    def _accepted(self, verification: Verification) -> tuple[str, Verification] | None:
        """The outcome if the native predicate accepts the present state; None if it must settle first."""
        if _holds(verification):
            return "verified", verification
        if self.lost is not None or self.attempts:
            return "unresolved", verification
        self.lost = verification
        return None

    def _attempt(self, observation: Observation, diagnoses: tuple[Diagnosis, ...]) -> Attempt | None:
        """Steps 4 to 6 once; None when no route has a further candidate for the selected failure."""
        environment, found = self.environment, self._dispatch(select(diagnoses))
        if environment is None or found is None:
            return None
        decision, proposal = found
        index = len(self.attempts)
        try:
            application = environment.apply(proposal)
            verification = environment.verify()
            if verification.outcome:
                verification = environment.settle(verification)
        except RunFault as fault:
            return Attempt(index, observation, diagnoses, decision, fault=str(fault))
        if not _holds(verification):
            self.rejected[decision.diagnosis.index] = decision.route
        return Attempt(index, observation, diagnoses, decision, application, verification)

    def _dispatch(self, selected: Diagnosis) -> tuple[RouteDecision, Proposal] | None:
        """The first route with a candidate, and that candidate; None when all are exhausted."""
        for decision in self.loop.routing(selected, self.loop.knowledge, self.rejected.get(selected.index)):
            proposal = self._propose(decision)
            if proposal is not None:
                return decision, proposal
        return None

    def _propose(self, decision: RouteDecision) -> Proposal | None:
        name = self.loop.knowledge.schema.routes[decision.route].name
        proposer, environment = self.loop.proposers.get(name), self.environment
        if proposer is None:
            self.unserved[name] = None
        if proposer is None or environment is None:
            return None
        key = (decision.diagnosis.index, decision.route)
        candidate = self.offered.get(key, 0)
        self.offered[key] = candidate + 1
        return proposer.propose(
            Request(
                scene=environment.scene,
                qpos=environment.qpos,
                qvel=environment.qvel,
                required=self.required,
                diagnosis=decision.diagnosis,
                candidate=candidate,
                observe=environment.observe_at,
                rng=self.rng,
            )
        )

    def _observe(self) -> Observation:
        if self.environment is None:
            raise ValueError("a simulator source needs an environment")
        return self.environment.observe()

    def _verdict(self) -> Verification | None:
        return self.attempts[-1].verification if self.attempts else self.lost

    def _reason(self, last: Verification | None) -> str:
        """What is missing: proposers of the chosen routes, or a state that stays accepted while settling."""
        names = " or ".join(f"`{name}`" for name in self.unserved)
        parts = [f"no proposer is registered as {names}"] if names else []
        if last is not None and last.outcome:
            parts.append(f"the last state that was accepted did not survive {last.settle_steps} steps of settling")
        return "; ".join(parts)


def _after_attempt(attempt: Attempt) -> str | None:
    """Step 6: the outcome after ``attempt``, or None to continue."""
    if attempt.fault:
        return "run_fault"
    return "accepted" if attempt.verification is not None and _holds(attempt.verification) else None


def _holds(verification: Verification) -> bool:
    """Whether the native predicate accepts, also after settling if that was checked."""
    return verification.outcome and verification.settled is not False
