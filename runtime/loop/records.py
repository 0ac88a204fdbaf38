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
"""The index of an initial state that is none of the official ones."""
GROUNDED = "each required fact as it is grounded"
"""The query of a verification in which no native predicate was asked."""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One unsatisfied required fact, kept whole: d_f = (f, c_f, m_f)."""

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
    precondition: bool = False  # whether the goal asks for the fact only because another needs it first

    @property
    def key(self) -> tuple[bool, int]:
        """Which fact of its required ABox it speaks of."""
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
    requested: str = ""  # the level at which the loop may act; empty if a trace does not say


@dataclass(frozen=True, slots=True)
class Proposal:
    """q = P_r(s, A*_g, d). For a state-level route: the whole ``qpos`` to write, and the addresses that it changes.

    For an action-level route both are empty, and ``note`` says what the mechanism was going to do.
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

    A controller takes control steps of 1/20 s, and its mechanism comes to an ``end``: "completed", "out_of_steps", or
    what it gave up for ("unreachable", "lost", "missed", "blocked", "gave_up"), with the ``reason`` in its own words.
    Whether the fact then holds is for the verification to say.
    """

    proposal: Proposal
    mode: str
    displacement: float  # L2 norm of the change of qpos
    steps: int | None = None
    end: str = ""
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Prediction:
    """What a world model predicts of a proposal that was not executed, and what came of the proposal.

    ``adopted``: whether it took the place of the best plan so far; ``evaluations``: how many candidates it cost.
    """

    observation: Observation
    adopted: bool
    evaluations: int


@dataclass(frozen=True, slots=True)
class Verification:
    """The judge's answer. ``settled`` is None until somebody asked whether it still holds after settling.

    The judge is the native predicate, unless a person asked for grounding to judge: ``query`` is then :data:`GROUNDED`.
    """

    query: str
    outcome: bool
    settled: bool | None = None
    settle_steps: int = 0

    @property
    def judge(self) -> str:
        """Who gave the answer: "native" or "grounding"."""
        return "grounding" if self.query == GROUNDED else "native"


@dataclass(frozen=True, slots=True)
class Attempt:
    """One turn of the loop; ``fault`` names a RunFault (a NaN, a crash), which is not an execution failure.

    With neither an application nor a fault, the selected route had no candidate; with nothing ``selected``, what was
    diagnosed was only observed, as where somebody else's policy acts. An attempt at the level of plans
    says which ``plan`` of the episode it was to better, and what was predicted of its proposal.
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
    """A plan that was executed: what was predicted of its end, and what the simulator showed of it.

    ``diagnoses`` are the prediction's: without any the plan was retained, which is no success. ``predicted`` is None
    where nothing was; ``planner`` is who made the plan, from ``evaluations`` candidates; it took ``steps`` control
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

    Suite, task, initial state (its number, or the digest of what was ``given``), seed, ``trial`` and ``tags`` tell the
    episodes of a run apart: the trial counts what was recorded again under the same names, the tags are the caller's.
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
    given: str = ""  # digest of an initial state that is none of the official ones, see :func:`state_digest`

    @property
    def accepted(self) -> bool:
        """Whether the judge accepted a state that this episode applied, or the one it started from."""
        return self.outcome in {"accepted", "verified"}

    @property
    def judge(self) -> str:
        """Who judged the episode, as :attr:`Verification.judge`; "native" where nobody was asked."""
        return "native" if self.verification is None else self.verification.judge

    @property
    def turns(self) -> tuple[Attempt | ExecutedPlan, ...]:
        """Attempts and plans as they came: what was tried to better a plan stands before it."""
        found: list[Attempt | ExecutedPlan] = []
        plans = list(self.plans)
        for attempt in self.attempts:
            while plans and attempt.plan is not None and plans[0].index < attempt.plan:
                found.append(plans.pop(0))
            found.append(attempt)
        return (*found, *plans)


def state_digest(state: ArrayLike) -> str:
    """What tells one given initial state from another: twelve hexadecimal digits of the SHA-256 of its doubles."""
    return sha256(np.ascontiguousarray(state, dtype="<f8").tobytes()).hexdigest()[:12]


def state_name(index: int, word: str = "state") -> str:
    """What an initial state is called: by its number, where it is an official one."""
    return "a given state" if index == GIVEN else f"{word} {index}"
