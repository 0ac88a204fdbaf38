"""Finds the proposer of each route: an entry point named as the route, in the group ``onto_evwm.proposers``.

Another package adds or replaces a route's proposer by declaring an entry point of the same group.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from runtime.loop.routed import load_routed

if TYPE_CHECKING:
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer

__all__ = ["GROUP", "load_proposers"]

GROUP = "onto_evwm.proposers"


def load_proposers(schema: Schema) -> dict[str, Proposer]:
    """Build every registered proposer whose route ``schema`` declares, by the route's local name.

    Raises :class:`OntoError` with ``RUN010`` when an entry point cannot be loaded.
    """
    return {name: make(schema) for name, make in load_routed(schema, GROUP, "proposer", "RUN010").items()}
