"""One candidate state, and the order in which candidates are offered."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from runtime.loop.records import Proposal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from grounding.observation import Observation
    from onto_compiler.required import Fact
    from runtime.loop.proposer import Request

__all__ = ["Candidate", "holds", "offer", "ranked"]

_SAME_DECIMALS = 6  # states that agree so far are one candidate


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A whole ``qpos`` (nq,) that nothing is known to speak against, apart from ``flaws``.

    A flaw is a reason to try others first: unbalanced, or reachable only through a wall.
    """

    qpos: NDArray[np.float64]
    note: str
    flaws: int = 0
    rank: float = 0.0  # among candidates with as many flaws, the smaller the sooner


def holds(observation: Observation, index: int, fact: Fact) -> bool:
    """Whether ``fact``, number ``index``, is satisfied: its polarity, and its threshold where there is a margin."""
    if not observation.observed[index] or bool(observation.truth[index]) != fact.polarity:
        return False
    margin = float(observation.margin[index])
    return not fact.threshold or np.isnan(margin) or margin >= fact.threshold


def ranked(request: Request, batches: Iterable[Sequence[Candidate]]) -> Iterator[Candidate]:
    """Candidates that the grounder finds to satisfy the diagnosed fact, best first.

    Those without a flaw that keep every other satisfied fact come out batch by batch, as they are found; the rest wait
    until the batches end. What does not satisfy the fact is dropped.
    """
    facts = request.required.facts
    before = request.observe(request.qpos)
    kept = [i for i, fact in enumerate(facts) if i != request.diagnosis.index and holds(before, i, fact)]
    waiting: list[tuple[int, int, float, int, Candidate]] = []
    count = itertools.count()
    known: set[bytes] = set()
    for batch in batches:
        ready: list[tuple[int, int, float, int, Candidate]] = []
        for candidate in batch:
            state = np.round(candidate.qpos, _SAME_DECIMALS).tobytes()
            if state in known:
                continue
            known.add(state)
            seen = request.observe(candidate.qpos)
            if not holds(seen, request.diagnosis.index, request.diagnosis.fact):
                continue
            lost = sum(not holds(seen, i, facts[i]) for i in kept)
            entry = (lost, candidate.flaws, candidate.rank, next(count), candidate)
            (waiting if lost or candidate.flaws else ready).append(entry)
        yield from (entry[-1] for entry in sorted(ready, key=lambda e: e[:-1]))
    yield from (entry[-1] for entry in sorted(waiting, key=lambda e: e[:-1]))


def offer(request: Request, route: str, proposer: str, candidates: Iterator[Candidate]) -> Proposal | None:
    """Candidate number ``request.candidate`` of ``candidates`` as a proposal, or None when there are not so many."""
    chosen = next(itertools.islice(candidates, request.candidate, None), None)
    if chosen is None:
        return None
    changed = tuple(int(a) for a in np.flatnonzero(chosen.qpos != request.qpos))
    return Proposal(route, proposer, request.candidate, chosen.qpos, changed, chosen.note)
