"""Look up a grounding function by the name that a binding gives it (``core:groundedBy``).

Any installed package can register one: an entry point in group ``onto_evwm.groundings`` that loads a :data:`Factory`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib.metadata import EntryPoint, entry_points

import mujoco

from grounding.observation import Evidence
from grounding.scenes import Scene
from onto_compiler.problems import OntoError, Problem, near
from onto_compiler.required import Fact
from onto_compiler.schema import Schema

__all__ = ["GROUP", "Factory", "factory", "ground", "registered"]

GROUP = "onto_evwm.groundings"

Factory = Callable[[Scene, Fact, Schema], Callable[[mujoco.MjData], Evidence]]


@cache
def registered() -> dict[str, EntryPoint]:
    """The registered grounding functions by name, none of them imported yet."""
    return {point.name: point for point in sorted(entry_points(group=GROUP), key=lambda point: point.name)}


@cache
def factory(name: str) -> Factory | None:
    """The grounding function registered as ``name``, or None."""
    point = registered().get(name)
    return point.load() if point else None


def ground(scene: Scene, fact: Fact, schema: Schema) -> Callable[[mujoco.MjData], Evidence]:
    """Resolve ``fact`` on ``scene``; raises ``SIM005`` when nothing is registered under ``fact.grounded_by``.

    What the grounding function itself raises (an unknown name, an unsuited fact) passes through, placed at the fact.
    """
    make = factory(fact.grounded_by)
    if make is None:
        message = f"`{fact}` is grounded by `{fact.grounded_by}`, and no such function is registered"
        raise _placed(fact, OntoError.of("SIM005", message, near(fact.grounded_by, registered())))
    try:
        return make(scene, fact, schema)
    except OntoError as error:
        raise _placed(fact, error) from error


def _placed(fact: Fact, error: OntoError) -> OntoError:
    """Give the problems that have no place the fact's own."""
    span = fact.span
    if span is None:
        return error
    return OntoError(
        *(
            p if p.file else Problem(span.file, span.line, span.column, p.code, p.severity, p.message, p.hint)
            for p in error.problems
        )
    )
