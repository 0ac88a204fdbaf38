"""Finds the skill of each route: an entry point named as the route, in the group ``onto_evwm.skills``.

Another package adds or replaces a route's skill by declaring an entry point of the same group.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from onto_compiler.schema import Schema
from runtime.loop.routed import load_routed

if TYPE_CHECKING:
    from runtime.worlds.libero.skills.protocol import Skill

__all__ = ["GROUP", "Factory", "load_skills"]

GROUP = "onto_evwm.skills"

Factory: TypeAlias = "Callable[[Schema], Skill]"


def load_skills(schema: Schema) -> dict[str, Factory]:
    """The factory of each declared route's skill, by the route's local name; call it with the schema.

    Raises:
        OntoError: RUN011 if an entry point cannot be loaded.
    """
    return load_routed(schema, GROUP, "skill", "RUN011")
