"""Finds the proposer of each route: an entry point named as the route, in the group ``onto_evwm.proposers``.

Another package adds or replaces a route's proposer by declaring an entry point of the same group.
"""

from __future__ import annotations

from importlib.metadata import entry_points
from typing import TYPE_CHECKING

from onto_compiler.problems import OntoError
from onto_compiler.schema import local_name

if TYPE_CHECKING:
    from onto_compiler.schema import Schema
    from runtime.proposers.protocol import Proposer

__all__ = ["GROUP", "load_proposers"]

GROUP = "onto_evwm.proposers"


def load_proposers(schema: Schema) -> dict[str, Proposer]:
    """Build every registered proposer whose route ``schema`` declares, by the route's local name.

    Raises :class:`OntoError` with ``RUN010`` when an entry point cannot be loaded.
    """
    routes = {local_name(iri) for iri in schema.routes}
    found: dict[str, Proposer] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name):
        if entry.name not in routes:
            continue
        try:
            factory = entry.load()
        except (ImportError, AttributeError) as error:
            message = f"the proposer of route `{entry.name}` cannot be loaded from `{entry.value}`: {error}"
            raise OntoError.of("RUN010", message, f"reinstall the package that declares it in `{GROUP}`") from error
        found[entry.name] = factory(schema)
    return found
