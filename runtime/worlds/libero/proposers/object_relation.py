"""The route ``object_relation_predicate``: an object placed relative to a landmark, a support or a container.

Source (paper, table "Typed gates and state-correction families"): object-relation failures are corrected in
object-relative coordinates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from runtime.worlds.libero.proposers.candidates import StateCandidate, offer, ranked
from runtime.worlds.libero.proposers.poses import landing_batches, leaving_batches
from runtime.worlds.libero.scene.targets import place_of, slot_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Request
    from runtime.loop.records import Proposal

__all__ = ["HeuristicObjectRelation"]


class HeuristicObjectRelation:
    """Puts the first argument down on, in or beside the second, in the frame of what the native predicate tests."""

    name = "heuristic_object_relation"

    def __init__(self, schema: Schema) -> None:
        """``schema`` is not needed: the scene determines where to place."""
        self.schema = schema

    def propose(self, request: Request) -> Proposal | None:
        """Return candidate number ``request.candidate``, or None when there is nothing to place or no more are left."""
        return offer(request, "object_relation_predicate", self.name, self.candidates(request))

    def candidates(self, request: Request) -> Iterator[StateCandidate]:
        """All candidates, best first."""
        fact = request.diagnosis.fact
        place = place_of(request.scene, fact)
        if place is not None and fact.polarity:
            yield from ranked(request, landing_batches(request, place, slot_of(request.required, fact)))
        elif place is not None:
            yield from ranked(request, leaving_batches(request, place))
