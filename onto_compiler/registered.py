"""The entry points that installed packages register for the terms of an ontology, found without importing them.

Entry points stand in the metadata of a package, so that they are there whether or not what they name can be imported.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import EntryPoint, EntryPoints, entry_points

__all__ = ["GROUNDINGS", "SERVING", "package", "points", "points_of", "route_of"]

GROUNDINGS = "onto_evwm.groundings"
SERVING = {  # by the notation of a route's level: the group, and what its members are called
    "action": ("onto_evwm.skills", "skill"),
    "plan": ("onto_evwm.mechanisms", "mechanism"),
    "state": ("onto_evwm.proposers", "proposer"),
}


def points(group: str) -> tuple[EntryPoint, ...]:
    """The entry points of ``group``, each of a package once, by name and then by package."""
    found = {(point.name, package(point), point.value): point for point in entry_points(group=group)}
    return tuple(found[key] for key in sorted(found))


def points_of(groups: Iterable[str]) -> Mapping[str, EntryPoints]:
    """The entry points of each group, as often as packages name them; the metadata of all packages is read once."""
    found = entry_points()
    return {group: found.select(group=group) for group in groups}


def route_of(point: EntryPoint) -> str:
    """The route that an entry point serves: its name, up to a dot where several serve the same route."""
    return point.name.partition(".")[0]


def package(point: EntryPoint) -> str:
    """The package that registers an entry point, as pip knows it."""
    return point.dist.name if point.dist is not None else point.module.partition(".")[0]
