"""Delta F and Pi_D: which required facts are unsatisfied, and what kind of failure each one is (paper, section 3).

Numbers become one of a few statuses here; the rules say what each status means.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from grounding.observation import Observation
from onto_compiler.problems import OntoError
from onto_compiler.required import Fact, RequiredABox
from onto_compiler.schema import local_name
from onto_compiler.tables import ABSENT, EXPLICITLY_FALSE, MARGIN_VIOLATED, SATISFIED, STATUSES, RuleTables
from runtime.loop.records import Diagnosis

__all__ = [
    "by_distance",
    "diagnose",
    "diagnose_goal",
    "evidence_status",
    "lack",
    "requirement",
    "satisfied",
    "select",
    "surplus",
    "unmet",
]

_CODE = {status: code for code, status in enumerate(STATUSES)}


def evidence_status(facts: Sequence[Fact], observation: Observation) -> NDArray[np.int8]:
    """Sat_T for each required fact, as an index into :data:`onto_compiler.tables.STATUSES`; shape (n,).

    A fact is absent without evidence; explicitly false when its truth differs from the required polarity; its margin is
    violated when a defined margin, signed by polarity, lies below the required threshold. A negative threshold is a
    tolerance (of an initial fact, see ``core:premiseTolerance``): the margin then decides, whatever the truth.
    """
    if len(facts) != len(observation):
        raise ValueError(f"{len(facts)} required facts and an observation of {len(observation)}")
    sign, threshold = requirement(facts)
    signed = sign * observation.margin
    status = np.full(len(facts), _CODE[SATISFIED], dtype=np.int8)
    # A comparison with NaN is false: where no margin is defined, none is violated.
    status[signed < threshold] = _CODE[MARGIN_VIOLATED]
    status[observation.truth != (sign > 0)] = _CODE[EXPLICITLY_FALSE]
    status[(threshold < 0) & (signed >= threshold)] = _CODE[SATISFIED]
    status[~observation.observed] = _CODE[ABSENT]
    return status


def requirement(facts: Sequence[Fact]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The sign (n,) of each fact's polarity, and the smallest signed margin (n,) that satisfies it."""
    sign = np.array([1.0 if fact.polarity else -1.0 for fact in facts], dtype=np.float64)
    return sign, np.array([fact.threshold for fact in facts], dtype=np.float64)


def satisfied(facts: Sequence[Fact], observation: Observation) -> NDArray[np.bool_]:
    """Whether each required fact holds: polarity, threshold, tolerance and evidence count; shape (n,)."""
    holds: NDArray[np.bool_] = evidence_status(facts, observation) == _CODE[SATISFIED]
    return holds


def surplus(facts: Sequence[Fact], observation: Observation) -> NDArray[np.float64]:
    """By how much each margin, signed by polarity, exceeds what its fact requires; NaN without a margin; shape (n,)."""
    sign, threshold = requirement(facts)
    return sign * observation.margin - threshold


def lack(facts: Sequence[Fact], observation: Observation) -> NDArray[np.float64]:
    """How much margin each fact lacks: 0 where it is satisfied, NaN if it is not and has no margin; shape (n,)."""
    missing = np.maximum(-surplus(facts, observation), 0.0)
    return np.where(satisfied(facts, observation), 0.0, missing)


def by_distance(required: RequiredABox, observation: Observation) -> tuple[tuple[int, ...], ...]:
    """The alternatives of the goal as indices of facts, the nearest first; without any, one with every fact.

    Ordered by the number of unmet facts, then of those without a margin, then by the sum of the margins' deficits (each
    in its own unit), then by position.
    """
    if not required.alternatives:
        return required.ways
    open_ = ~satisfied(required.facts, observation)
    missing = lack(required.facts, observation)

    def distance(way: tuple[int, ...]) -> tuple[int, int, float]:
        chosen = list(way)
        lacking = missing[chosen]
        return int(open_[chosen].sum()), int(np.isnan(lacking).sum()), float(np.nansum(lacking))

    return tuple(sorted(required.alternatives, key=distance))


def unmet(required: RequiredABox, observation: Observation) -> tuple[int, ...]:
    """The indices of the unsatisfied facts of the nearest alternative."""
    holds = satisfied(required.facts, observation)
    return tuple(i for i in by_distance(required, observation)[0] if not holds[i])


def diagnose_goal(
    required: RequiredABox, observation: Observation, tables: RuleTables, rank: int = 0
) -> tuple[Diagnosis, ...]:
    """One record for each unsatisfied fact of the alternative at ``rank`` (0: the nearest).

    The goal holds if there are none for rank 0.

    Raises:
        OntoError: as :func:`diagnose`.
    """
    if not required.alternatives:
        return diagnose(required.facts, observation, tables)
    return diagnose(required.facts, observation, tables, by_distance(required, observation)[rank])


def diagnose(
    facts: Sequence[Fact], observation: Observation, tables: RuleTables, only: Collection[int] | None = None
) -> tuple[Diagnosis, ...]:
    """One record for each unsatisfied fact, in the order of the required ABox; ``only`` limits it to these indices.

    Raises:
        OntoError: RUN003 if no diagnosis rule speaks of an unsatisfied fact.
    """
    found = []
    for index, code in enumerate(evidence_status(facts, observation)):
        status = STATUSES[code]
        if status == SATISFIED or (only is not None and index not in only):
            continue
        fact = facts[index]
        entry = tables.diagnosis.get((fact.predicate, fact.polarity, status))
        if entry is None:
            raise OntoError.of(
                "RUN003",
                f"no diagnosis rule speaks of `{fact}` with status `{local_name(status)}`",
                f"add a rule for the kind of predicate that `{local_name(fact.predicate)}` is",
            )
        found.append(
            Diagnosis(
                fact=fact,
                index=index,
                failure=entry.failure,
                status=status,
                truth=bool(observation.truth[index]),
                margin=float(observation.margin[index]),
                limit=observation.limit[index],
                source=observation.source,
                rule=entry.rule,
                priority=entry.priority,
            )
        )
    return tuple(found)


def select(diagnoses: Sequence[Diagnosis]) -> Diagnosis:
    """d-dagger: the diagnosis of the smallest priority, the first of them in the order of the required ABox."""
    return min(diagnoses, key=lambda diagnosis: (diagnosis.priority, diagnosis.index))
