"""Finds the proposer of each route: an entry point of the group ``onto_evwm.proposers``.

It is named as the route, ``unwiped_route``, or ``unwiped_route.learned`` where several packages serve one route; its
name is then ``learned``, and otherwise the ``name`` of its class.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from runtime.loop.routed import serving

if TYPE_CHECKING:
    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Proposer

__all__ = ["GROUP", "load_proposers"]

GROUP = "onto_evwm.proposers"


def load_proposers(schema: Schema, chosen: Mapping[str, str] | None = None) -> dict[str, Proposer]:
    """Build the proposer of each route of ``schema``, by the route's notation; ``chosen`` has names by route.

    Raises:
        OntoError: RUN010 if an entry point cannot be loaded; RUN005, RUN006 or RUN008 as
            :func:`runtime.loop.routed.serving`.

    """
    found = serving(schema, GROUP, "proposer", "RUN010", chosen)
    return {route: served.value(schema) for route, served in found.items()}
