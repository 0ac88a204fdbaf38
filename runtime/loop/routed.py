"""Finds what serves each route: an entry point named as the route, in a group for the kind of thing it is."""

from __future__ import annotations

from importlib.metadata import entry_points
from typing import Any

from onto_compiler.problems import OntoError
from onto_compiler.schema import Schema, local_name

__all__ = ["load_routed"]


def load_routed(schema: Schema, group: str, what: str, code: str) -> dict[str, Any]:
    """What the entry points of ``group`` load, by the local name of the route, for the routes that ``schema`` declares.

    Raises:
        OntoError: ``code``, where an entry point cannot be loaded; ``what`` it is ("skill") stands in the sentence.
    """
    routes = {local_name(iri) for iri in schema.routes}
    found: dict[str, Any] = {}
    for entry in sorted(entry_points(group=group), key=lambda e: e.name):
        if entry.name not in routes:
            continue
        try:
            found[entry.name] = entry.load()
        except (ImportError, AttributeError) as error:
            message = f"the {what} of route `{entry.name}` cannot be loaded from `{entry.value}`: {error}"
            raise OntoError.of(code, message, f"reinstall the package that declares it in `{group}`") from error
    return found
