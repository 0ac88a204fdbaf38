"""What a correction loop records, in the order of the paper's Algorithm 1; :mod:`runtime.trace` has the RDF forms."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grounding.observation import Observation
from onto_compiler.required import Fact, RequiredABox

__all__ = [
    "GIVEN",
    "GROUNDED",
    "Application",
    "Attempt",
    "Diagnosis",
    "Episode",
    "ExecutedPlan",
    "Prediction",
    "Proposal",
    "RouteDecision",
    "Verification",
    "state_digest",
    "state_name",
]

GIVEN = -1
"""The index of an initial state that is not an official one."""
GROUNDED = "each required fact as it is grounded"
"""The query of a verification without a native predicate."""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One unsatisfied required fact: d_f = (f, c_f, m_f)."""

    fact: Fact
    index: int  # of the fact in the required ABox, or among its preconditions
    failure: str  # failure class IRI
    status: str  # evidence status IRI: absent, explicitly false or margin violated
    truth: bool  # as observed
    margin: float  # NaN if none is defined
    limit: str  # the term of the margin that decides it
    source: str  # "sim" | "pred"
    rule: str  # IRI of the rule that fired
    priority: int
    precondition: bool = False  # whether the fact is a precondition of another, and not part of the goal

    @property
    def key(self) -> tuple[bool, int]:
        """The index of its fact in the required ABox."""
        return self.precondition, self.index


@dataclass(frozen=True, slots=True)
class RouteDecision:
    """Pi_R: the route that a rule assigned to a diagnosis, and why."""

    route: str  # IRI
    diagnosis: Diagnosis
    level: str  # "plan" | "state" | "action"
    decision: str  # IRI: dispatch, retry or reroute
    rule: str
    attempt_status: str = ""  # IRI: first, repeat or exhausted
    previous: str | None = None  # IRI of the route that was rejected or exhausted before
    requested: str = ""  # the level at which the loop may act; empty if unknown


@dataclass(frozen=True, slots=True)
class Proposal:
    """q = P_r(s, A*_g, d). For a state-level route: the whole ``qpos`` to write, and the addresses that it changes.

    For an action-level route both are empty, and ``note`` describes the planned motion.
    """

    route: str
    proposer: str
    candidate: int
    qpos: NDArray[np.float64]
    changed: tuple[int, ...]  # qpos addresses, ascending
    note: str = ""


@dataclass(frozen=True, slots=True)
class Application:
    """What was done with a proposal: ``mode`` is "none" (a plan only retained), "state" or "controller".

    A controller takes control steps of 1/20 s. Its ``end`` is "completed", "out_of_steps", or why it gave up
    ("unreachable", "lost", "missed", "blocked", "gave_up"), with the ``reason`` as a sentence. Whether the fact then
    holds is decided by the verification.
    """

    proposal: Proposal
    mode: str
    displacement: float  # L2 norm of the change of qpos
    steps: int | None = None
    end: str = ""
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Prediction:
    """What a world model predicts for a proposal that was not executed.

    ``adopted``: whether it replaced the best plan so far; ``evaluations``: how many candidates were evaluated.
    """

    observation: Observation
    adopted: bool
    evaluations: int


@dataclass(frozen=True, slots=True)
class Verification:
    """The judge's verdict. ``settled`` is None until the state was checked again after settling.

    The judge is the native predicate, or, on request, grounding; ``query`` is then :data:`GROUNDED`.
    """

    query: str
    outcome: bool
    settled: bool | None = None
    settle_steps: int = 0

    @property
    def judge(self) -> str:
        """The judge: "native" or "grounding"."""
        return "grounding" if self.query == GROUNDED else "native"


@dataclass(frozen=True, slots=True)
class Attempt:
    """One turn of the loop; ``fault`` names a RunFault (a NaN, a crash), which is not an execution failure.

    With neither an application nor a fault, the selected route had no candidate. With nothing ``selected``, failures
    were only observed, for example while another policy acts. An attempt at the plan level names the ``plan`` of the
    episode that it tries to improve, and has the prediction for its proposal.
    """

    index: int
    observation: Observation
    diagnoses: tuple[Diagnosis, ...]
    selected: RouteDecision | None = None
    application: Application | None = None
    verification: Verification | None = None
    fault: str = ""
    plan: int | None = None
    prediction: Prediction | None = None


@dataclass(frozen=True, slots=True)
class ExecutedPlan:
    """A plan that was executed: its predicted final state, and the simulated one.

    ``diagnoses`` are those of the prediction; a plan without any is retained, which is not yet a success. ``predicted``
    is None without a prediction; ``planner`` made the plan from ``evaluations`` candidates; it took ``steps`` control
    steps of 1/20 s.
    """

    index: int
    planner: str
    evaluations: int
    steps: int
    predicted: Observation | None
    diagnoses: tuple[Diagnosis, ...]
    simulated: Observation
    verification: Verification
    mode: str = "controller"


@dataclass(frozen=True, slots=True)
class Episode:
    """A whole run of Algorithm 1 on one task and initial state, an official one or :data:`GIVEN`.

    Suite, task, initial state (its number, or the digest of a ``given`` state), seed, ``trial`` and ``tags`` identify
    an episode in its run: the trial counts repeated recordings of the same episode, the tags are the caller's.
    ``outcome`` is one of ``retained``, ``verified``, ``accepted``, ``unresolved`` (the budget is spent),
    ``grounding_verifier_disagreement``, ``run_fault``.
    """

    task: str
    suite: str
    state_index: int
    seed: int
    required: RequiredABox
    initial: Observation
    premise: Observation
    premise_holds: bool
    attempts: tuple[Attempt, ...]
    final: Observation
    outcome: str
    verification: Verification | None = None
    provenance: tuple[tuple[str, Any], ...] = ()  # versions and seconds, as (name, value): text, numbers, truth values
    plans: tuple[ExecutedPlan, ...] = ()  # of a run that plans before it acts
    trial: int = 0
    tags: tuple[tuple[str, str], ...] = ()  # as (key, value), by key
    given: str = ""  # digest of an initial state that is not an official one, see :func:`state_digest`

    @property
    def accepted(self) -> bool:
        """Whether the judge accepted a state that this episode applied, or the one it started from."""
        return self.outcome in {"accepted", "verified"}

    @property
    def judge(self) -> str:
        """The episode's judge, as :attr:`Verification.judge`; "native" if there was no verification."""
        return "native" if self.verification is None else self.verification.judge

    @property
    def turns(self) -> tuple[Attempt | ExecutedPlan, ...]:
        """Attempts and plans in order: the attempts to improve a plan come before it."""
        found: list[Attempt | ExecutedPlan] = []
        plans = list(self.plans)
        for attempt in self.attempts:
            while plans and attempt.plan is not None and plans[0].index < attempt.plan:
                found.append(plans.pop(0))
            found.append(attempt)
        return (*found, *plans)


def state_digest(state: ArrayLike) -> str:
    """The identity of a given initial state: the first twelve hexadecimal digits of the SHA-256 of its doubles."""
    return sha256(np.ascontiguousarray(state, dtype="<f8").tobytes()).hexdigest()[:12]


def state_name(index: int, word: str = "state") -> str:
    """The name of an initial state: its number, if it is an official one."""
    return "a given state" if index == GIVEN else f"{word} {index}"
