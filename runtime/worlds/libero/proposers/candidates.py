"""One candidate state, and the order in which candidates are offered."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from runtime.loop.diagnosis import satisfied
from runtime.loop.records import Proposal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from runtime.loop.proposer import Request

__all__ = ["StateCandidate", "offer", "ranked"]

_SAME_DECIMALS = 6  # states that agree so far are one candidate


@dataclass(frozen=True, slots=True, eq=False)
class StateCandidate:
    """A complete ``qpos`` (nq,) without known objections except ``flaws``.

    A flaw is a reason to try others first: unbalanced, or reachable only through a wall.
    """

    qpos: NDArray[np.float64]
    note: str
    flaws: int = 0
    rank: float = 0.0  # among candidates with as many flaws, the smaller the sooner


def ranked(request: Request, batches: Iterable[Sequence[StateCandidate]]) -> Iterator[StateCandidate]:
    """Candidates that the grounder finds to satisfy the diagnosed fact, best first.

    Those without a flaw that keep every other satisfied fact are yielded batch by batch; the rest follow after the last
    batch. Candidates that do not satisfy the fact are dropped.
    """
    facts = request.required.facts
    wanted = request.diagnosis.index
    to_keep = satisfied(facts, request.observe(request.qpos))
    to_keep[wanted] = False
    waiting: list[tuple[int, int, float, int, StateCandidate]] = []
    count = itertools.count()
    known: set[bytes] = set()
    for batch in batches:
        ready: list[tuple[int, int, float, int, StateCandidate]] = []
        for candidate in batch:
            state = np.round(candidate.qpos, _SAME_DECIMALS).tobytes()
            if state in known:
                continue
            known.add(state)
            holds = satisfied(facts, request.observe(candidate.qpos))
            if not holds[wanted]:
                continue
            lost = int(np.count_nonzero(to_keep & ~holds))
            entry = (lost, candidate.flaws, candidate.rank, next(count), candidate)
            (waiting if lost or candidate.flaws else ready).append(entry)
        yield from (entry[-1] for entry in sorted(ready, key=lambda e: e[:-1]))
    yield from (entry[-1] for entry in sorted(waiting, key=lambda e: e[:-1]))


def offer(request: Request, route: str, proposer: str, candidates: Iterator[StateCandidate]) -> Proposal | None:
    """Candidate number ``request.candidate`` of ``candidates`` as a proposal, or None when there are not so many."""
    chosen = next(itertools.islice(candidates, request.candidate, None), None)
    if chosen is None:
        return None
    changed = tuple(int(a) for a in np.flatnonzero(chosen.qpos != request.qpos))
    return Proposal(route, proposer, request.candidate, chosen.qpos, changed, chosen.note)
