"""Finds the implementation of each route: an entry point named ``ROUTE``, or ``ROUTE.NAME`` if there are several.

The order in which packages are found decides nothing: one of several is chosen by its name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from typing import Any

from onto_compiler.problems import OntoError, near
from onto_compiler.registered import package, points, route_of
from onto_compiler.schema import Schema

__all__ = ["Served", "load_routed", "serving"]


@dataclass(frozen=True, slots=True)
class Served:
    """The implementation of a route: the loaded class or function, and its name."""

    route: str
    name: str
    value: Any
    point: EntryPoint


def load_routed(
    schema: Schema, group: str, what: str, code: str, chosen: Mapping[str, str] | None = None
) -> dict[str, Any]:
    """As :func:`serving`, and only what was loaded."""
    return {route: served.value for route, served in serving(schema, group, what, code, chosen).items()}


def serving(
    schema: Schema, group: str, what: str, code: str, chosen: Mapping[str, str] | None = None
) -> dict[str, Served]:
    """What serves the routes that ``schema`` declares, by the route's notation; ``chosen`` has names by route.

    Raises:
        OntoError: ``code``, where an entry point cannot be loaded; ``what`` it is ("skill") stands in the sentence.
            RUN005 if several serve a route and none is chosen; RUN006 if two have the same name; RUN008 if a
            choice names an unknown route or implementation.

    """
    chosen = chosen or {}
    routes = {route.name for route in schema.routes.values()}
    found: dict[str, list[Served]] = {}
    for point in points(group):
        route = route_of(point)
        if route in routes:
            found.setdefault(route, []).append(_load(point, route, what, code, group))
    for route in chosen:
        if route not in found:
            hint = near(route, found) or f"routes with a {what} are {', '.join(sorted(found))}"
            raise OntoError.of("RUN008", f"no {what} is registered for the route `{route}`", hint)
    return {route: _one(served, what, chosen.get(route)) for route, served in found.items()}


def _load(point: EntryPoint, route: str, what: str, code: str, group: str) -> Served:
    try:
        value = point.load()
    except (ImportError, AttributeError) as error:
        message = f"the {what} of route `{route}` cannot be loaded from `{point.value}`: {error}"
        raise OntoError.of(code, message, f"reinstall the package that declares it in `{group}`") from error
    own = getattr(value, "name", None)
    name = point.name.partition(".")[2] or (own if isinstance(own, str) else route)
    return Served(route, name, value, point)


def _one(served: Sequence[Served], what: str, wanted: str | None) -> Served:
    """The chosen one, or the only one."""
    route = served[0].route
    for number, one in enumerate(served):
        twin = next((other for other in served[:number] if other.name == one.name), None)
        if twin is not None:
            packages = f"`{package(twin.point)}` and `{package(one.point)}`"
            message = f"two {what}s of the route `{route}` are called `{one.name}`: those of {packages}"
            hint = f"uninstall one of the packages, or register one as `{route}.NAME` with a name of its own"
            raise OntoError.of("RUN006", message, hint)
    if wanted is not None:
        match = next((one for one in served if one.name == wanted), None)
        if match is None:
            names = [one.name for one in served]
            message = f"no {what} of the route `{route}` is called `{wanted}`"
            raise OntoError.of("RUN008", message, near(wanted, names) or f"there is {', '.join(names)}")
        return match
    if len(served) > 1:
        both = " and ".join(f"`{one.name}` (package `{package(one.point)}`)" for one in served)
        choice = f"--proposer {route}={served[0].name}" if what == "proposer" else "one package at a time"
        raise OntoError.of("RUN005", f"the route `{route}` is served by {both}", f"choose one: {choice}")
    return served[0]
